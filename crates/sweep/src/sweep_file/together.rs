//! Unknowns that are drawn together.

use super::Axes;
use super::values::{Lognormal, Normal};
use input::quantity::Number;
use schemars::JsonSchema;
use serde::Deserialize;

/// Unknowns that vary together: one normal distribution of several values or their logarithms, as
/// a calibration leaves them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Together {
    /// Each unknown with its own spread, by path in the machine file.
    pub parameters: Axes<Gaussian>,
    /// Correlation of each pair, in the order of `parameters`: a symmetric matrix, a list of rows,
    /// with ones on its diagonal. It is that of the logarithms where a spread is lognormal.
    pub correlations: Vec<Vec<Number>>,
}

/// The spread of one of several unknowns that vary together.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gaussian {
    /// Gauss's.
    Normal(Normal),
    /// The logarithm is normal.
    Lognormal(Lognormal),
}
