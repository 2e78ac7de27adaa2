//! What a dataset shows, computed from its tables ([`sweep::reader::Dataset`]) and drawn by nobody yet.
//!
//! - [`counts`]: cases and windows by fault, what varies, what failed;
//! - [`recording`]: the recording of one window: response over the crank angle, spectra, spread of its levels;
//! - [`examples`]: a typical case of each fault;
//! - [`grid`], [`claims`], [`claim_ranges`]: levels by joints and clearance, and the clearance study's claims held against them;
//! - [`random`], [`operation`]: features over clearance, speed and load;
//! - [`features`], [`ranking`], [`baseline`]: what features say of the fault;
//! - [`chaos`]: exponents, regimes, bifurcations, and the motions of some cases;
//! - [`levels`]: the levels of a grid as a table;
//! - [`level`], [`statistics`]: a level with its spread; quantiles and ranks;
//! - [`classes`], [`words`]: what faults, columns and sensors are called.

pub mod baseline;
pub mod chaos;
pub mod claim_ranges;
pub mod claims;
pub mod classes;
pub mod counts;
mod error;
pub mod examples;
pub mod features;
pub mod grid;
pub mod level;
pub mod levels;
mod operating_points;
pub mod operation;
pub mod random;
pub mod ranking;
pub mod recording;
pub mod scatter;
pub mod statistics;
pub mod words;

pub use error::Error;
pub use level::Level;
