//! Fits a machine's parameters to recordings of it.
//!
//! ```text
//! recordings ──observation──> lines of the orders, with their noise ─┐
//!                                                                    ├─likelihood─> residuals
//! machine(θ) ──prediction───> the same lines, with derivatives ──────┘        │
//!                                                                             v
//!                                  optimiser ──> θ ──identifiability──> intervals
//! ```
//!
//! From files to files: [`prepare`] reads settings and a [`bundle`] into a [`Task`] and refuses invalid
//! input. [`Prepared::finish`] searches, and writes [`Results`] as `calibration.json` beside the calibrated
//! `machine.yaml`. [`bundle_replay`] simulates a bundle in place of its recordings.
//!
//! The complex amplitudes of the shaft's orders are compared: the crank-angle synchronous
//! mean. A chaotic motion has one too, and its scatter counts as noise on either side.
//! Weights come from that noise alone.
//!
//! Coordinates `x` are one number per parameter of a [`Problem`], in its order; 0 is the nominal value.
//! Residuals follow each other run by run and channel by channel, in standard deviations of the noise. A Jacobian
//! has a row per residual and a column per parameter.

pub mod alignment;
mod bounded;
mod branch;
pub mod bundle;
pub mod bundle_replay;
pub mod calibration;
mod chamber;
pub mod check;
pub mod checkpoint;
pub mod cloud_descent;
pub mod comparison;
mod contradiction;
pub mod converter;
pub mod correction;
pub mod crank_motion;
pub mod data_sheet;
mod earlier;
pub mod energies;
mod envelopes;
pub mod error;
mod few_revolutions;
pub mod fit;
pub mod forecast;
mod halves;
pub mod identifiability;
pub mod indicator;
pub mod likelihood;
pub mod meter;
pub mod normal;
pub mod observation;
pub mod optimiser;
pub mod parameter;
pub mod pictures;
pub mod prediction;
pub mod pressure_gap;
mod pressure_range;
pub mod prior;
pub mod problem;
mod promise;
pub mod recorded_sensor;
pub mod region;
pub mod relation;
pub mod relation_spread;
pub mod replay;
pub mod results;
pub mod run_condition;
mod search;
pub mod secant;
mod sectors;
pub mod sensor_section;
pub mod sensors;
mod settings_check;
pub mod shut_valve;
pub mod sizes;
pub mod stages;
mod statistical_linearization;
mod statistics;
mod superposition;
pub mod task;
pub mod throw_alone;
pub mod transfer;
pub mod wear;
pub mod zero;

pub use bounded::Bounded;
pub use calibration::{Calibrated, Prepared, prepare};
pub use comparison::{Comparison, compare, compare_models, simulated_means};
pub use correction::{Corrected, Correction, Depth, correct};
pub use crank_motion::CrankMotion;
pub use earlier::Existing;
pub use error::Error;
pub use fit::{Fit, FitSettings, calibrate};
pub use halves::nearer_half;
pub use observation::{Channel, Observation, Run};
pub use parameter::Parameter;
pub use problem::Problem;
pub use relation::{ClearJoint, Relation};
pub use replay::{Replay, replay};
pub use results::Results;
pub use search::LOOSE;
pub use settings_check::check_settings;
pub use shut_valve::{ShutValve, Valve};
pub use stages::{Stage, Watcher};
pub use task::{Settings, Task, task};
pub use transfer::{Transfer, transfer};
