//! sweep.yaml becomes cases, shards and a committed dataset.

pub mod design;
pub mod distribution;
mod normal;
