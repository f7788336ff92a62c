//! Decoders of compressed formats behind a C interface; `decoders.h` describes it.
//!
//! Every function catches panics: a broken file is an error message, never the end of the process. So is too little
//! memory (`memory.rs`).

mod e57;
mod error;
mod laz;
mod memory;
