//! The tests of sweep, in one program.

mod bifurcation;
mod calibration;
mod damage;
mod dataset;
mod errors;
mod exponent;
mod labels;
mod over_angle;
mod plan;
mod schema;
mod signal_batches;
#[path = "../toy/mod.rs"]
mod toy;
#[path = "../../../../tests/readers/venv.rs"]
mod venv;
mod words;
