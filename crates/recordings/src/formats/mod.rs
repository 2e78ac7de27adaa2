//! One file per format.

pub mod csv;
pub mod mcap;
pub mod parquet;
