//! sweep.yaml becomes cases, shards and a committed dataset.

pub mod design;
pub mod distribution;
pub mod in_order;
pub mod labels;
mod normal;
pub mod plan;
pub mod split;
pub mod sweep_file;

pub use plan::{Case, Estimate, Plan};
