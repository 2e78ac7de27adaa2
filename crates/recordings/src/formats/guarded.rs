//! Panics of the libraries that decode.

use crate::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of `read`, with an error in place of a panic of the library that decodes.
pub(super) fn guarded<T>(
    read: impl FnOnce() -> Result<T, Error>,
    contradiction: impl FnOnce() -> Error,
) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(contradiction()))
}
