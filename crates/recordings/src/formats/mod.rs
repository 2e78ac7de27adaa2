//! One file per format.

pub mod csv;
pub(crate) mod mat;
pub mod mcap;
pub mod parquet;
pub(crate) mod wav;
