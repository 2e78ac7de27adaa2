//! Chaos from a sampled signal, as anyone with a sensor must find it.
//!
//! Everything is a pure function of the samples: the same signal gives the same numbers. A signal is a slice of
//! evenly spaced samples in order of time, in any unit. Times, lags and steps are in samples.

pub mod autocorrelation;
mod bits;
mod blocks;
pub mod classical;
pub mod correlation_dimension;
mod cycles;
pub mod delay;
pub mod dimension;
pub mod divergence;
pub mod entropy;
pub mod error;
mod errors_in_variables;
pub mod exponent;
pub mod forced;
mod global_map;
mod innovation;
pub mod local_map;
pub mod neighbours;
pub mod recurrence;
pub mod regime;
pub mod scaling_region;
pub mod surrogates;
pub mod test_systems;
pub mod wolf;
pub mod zero_one;

pub use error::Error;
