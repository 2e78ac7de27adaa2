//! sweep.yaml becomes cases, shards and a committed dataset.

pub mod design;
pub mod distribution;
pub mod in_order;
mod normal;
pub mod split;
