//! LAZ chunks: raw LAS records out of compressed bytes, and back.
