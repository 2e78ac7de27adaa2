//! A channel as a bundle states it.

use crate::quantity::Number;
use serde::Deserialize;
use std::path::PathBuf;

/// A channel of a run.
#[derive(Clone, Debug, Deserialize)]
pub struct Channel {
    /// What it is, in words.
    #[serde(default)]
    pub name: String,
    /// Its column in the file.
    pub column: String,
    /// Its unit, e.g. `m/s2`.
    pub unit: String,
    /// Its file, where the run has several.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// What is added to its numbers, in its unit: the ambient pressure of a gauge.
    #[serde(default)]
    pub offset: Option<Number>,
    /// The crank angle at which the pulse of a tacho comes, rad.
    #[serde(default)]
    pub crank_angle_rad: Option<Number>,
}
