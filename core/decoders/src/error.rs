//! Errors are passed to C as a message in a buffer that the caller owns.

use std::os::raw::c_char;
use std::panic::{catch_unwind, AssertUnwindSafe};

use crate::memory::Aside;

/// Runs `work`, which allocates at most `memory` bytes; an error or a panic becomes text in `message`, and `failed` is
/// returned. Without that much memory `work` is not run, and the message is empty.
///
/// # Safety
/// `message` points to `capacity` writable bytes, or `capacity` is 0.
pub unsafe fn guard<T>(
    message: *mut c_char, capacity: usize, failed: T, memory: usize, work: impl FnOnce() -> Result<T, String>,
) -> T {
    let Some(_aside) = Aside::set(memory) else {
        if capacity > 0 {
            *message = 0;
        }
        return failed;
    };
    let text = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(value)) => return value,
        Ok(Err(text)) => text,
        Err(panic) => match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
            (Some(text), _) => text.to_string(),
            (_, Some(text)) => text.clone(),
            _ => "the decoder gave up".to_string(),
        },
    };
    if capacity > 0 {
        let bytes = text.as_bytes();
        let count = bytes.len().min(capacity - 1);
        std::ptr::copy_nonoverlapping(bytes.as_ptr(), message.cast::<u8>(), count);
        *message.add(count) = 0;
    }
    failed
}
