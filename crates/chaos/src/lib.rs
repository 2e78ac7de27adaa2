//! Chaos from a sampled signal, as anyone with a sensor must find it.
//!
//! Everything is a pure function of the samples: the same signal gives the same numbers.

pub mod autocorrelation;
pub mod delay;
pub mod dimension;
pub mod error;
pub mod jacobian;
pub mod local_map;
pub mod neighbours;
pub mod surrogates;
pub mod test_systems;

pub use error::Error;
