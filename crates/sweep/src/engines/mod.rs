//! What makes the shards of a dataset on many machines.

mod error;
pub mod slurm;
pub mod task;

pub use error::Error;
