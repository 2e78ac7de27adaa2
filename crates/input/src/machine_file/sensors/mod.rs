//! Sensors and their measuring chains.
//!
//! A sensor is a file and a line in [`simulate::sensors`], and nothing here: its section follows from
//! its declaration.

mod chain;
mod resolve;
mod section;
mod written;

pub(super) use resolve::resolve;
pub(crate) use section::SensorSection;
pub use written::sensor_section;
