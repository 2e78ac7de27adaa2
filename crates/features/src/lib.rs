//! Signals summed up as one row of named numbers.
//!
//! [`definitions`] says which columns a recording's channels give, [`features`] their values for
//! a window of it, in the same order. Both read one table, so that a name, its unit, its
//! documentation and its value cannot part. A feature that has no value says why ([`Reason`]);
//! none is ever NaN or infinite.
//!
//! | channel | features |
//! |---|---|
//! | all but the crank angle | statistics of the samples |
//! | vibrations (m/s^2, m/s), pressures (Pa) | orders 1 to 20 of the shaft |
//! | pressures | indicated power and mean pressure, where the chamber is known |
//! | vibrations | frequency bands, overall acceleration, velocity and displacement |
//! | accelerations | velocity-acceleration portrait, spectral shape, envelope, synchronous residual, crank-angle sectors, cepstrum |
//!
//! A new feature is a function where its signal processing lives, and a line in the table.

mod channel_features;
mod cut_off;
mod definition;
mod envelope;
mod missing;
mod motion;
mod reason;
pub mod recorded;
mod row;
mod spectral;
mod statistics;
mod table;
mod window;

pub use channel_features::{definitions, features, stem};
pub use definition::{Definition, Group};
pub use missing::missing;
pub use motion::{Motion, motion, motion_definitions};
pub use reason::{Reason, Remedy};
pub use row::{Cell, Content, FEWEST_SAMPLES, column, columns, row, row_with_reasons};
pub use spectral::{OVERALL_HZ, overall_vibration};
pub use window::{CrankAngles, Window};
