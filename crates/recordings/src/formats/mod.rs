//! One file per format.

pub mod csv;
pub(crate) mod mat;
pub mod mcap;
pub mod parquet;
pub mod table_file;
pub(crate) mod wav;

use crate::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of `read`, with an error in place of a panic of the library that decodes.
fn guarded<T>(
    read: impl FnOnce() -> Result<T, Error>,
    contradiction: impl FnOnce() -> Error,
) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(contradiction()))
}
