//! sweep.yaml becomes cases, shards and a committed dataset.

pub mod calibration;
pub mod comparison;
pub mod dataset;
pub mod design;
pub mod digits;
mod distribution;
pub mod domain_gap;
pub mod effects;
pub mod engines;
mod error;
pub mod fault_words;
pub mod feature_file;
pub mod in_order;
pub mod labels;
mod normal;
pub mod plan;
pub mod program;
pub mod ranges;
pub mod reader;
pub mod recorded_table;
pub mod run;
pub mod run_analysis;
pub mod run_table;
mod runner;
pub mod split;
pub mod sweep_file;
mod timing;

pub use calibration::{Calibration, Sweep};
pub use dataset::{Existing, Options, Progress, Recording, Runner, finalize, generate, run_shards};
pub use error::Error;
pub use plan::{Case, Census, Diagram, DiagramEstimate, Estimate, Plan};
pub use runner::simulate_cases;
pub use timing::Timing;
