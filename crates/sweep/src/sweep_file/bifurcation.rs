//! Bifurcation diagrams that a sweep asks for.

use super::{Amount, Axes, Spacing};
use input::choice::Count;
use input::quantity::{Angle, Quantity};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// A bifurcation diagram: one number of the machine changes step by step, and the state is carried
/// over from value to value. What the sweep varies at random keeps its value of the machine file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bifurcation {
    /// Name of the diagram and of its file: letters, digits, `-` and `_`.
    pub name: String,
    /// What changes: the path of a number in the machine file (`joints.big_end.clearance`, `speed`,
    /// `cylinder.discharge`), or `clearance` for that of all `joints`.
    pub path: String,
    /// Lowest value.
    pub from: Amount,
    /// Highest value.
    pub to: Amount,
    /// Number of values, both ends included.
    pub steps: Count<2, 1_000_000>,
    /// Equal differences or equal ratios between the values.
    #[serde(default)]
    pub spacing: Spacing,
    /// Revolutions at each value before the recording; default 40.
    #[serde(default)]
    pub transient: Option<Count<1, 1_000_000>>,
    /// Revolutions that are recorded at each value.
    pub revolutions: Count<1, 1_000_000>,
    /// Direction in which the values are visited.
    #[serde(default)]
    pub directions: Directions,
    /// Crank angle of the section; default 0 deg.
    #[serde(default)]
    pub at: Option<Quantity<Angle>>,
    /// The joints with clearance, as in the axes of `cases`; `path` or `set` gives their clearance.
    /// By default the joints to which the machine file, `path` and `set` give a clearance.
    #[serde(default)]
    pub joints: Option<Vec<String>>,
    /// Other values of the machine: `clearance`, `load`, or paths.
    #[serde(default)]
    pub set: Axes<Value>,
    /// Values that are visited without a break; default 24. Longer pieces follow wider hystereses
    /// and are less parallel.
    #[serde(default)]
    pub chunk: Option<Count<1, 1_000_000>>,
}

/// Direction in which the values of a diagram are visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// Upward.
    Up,
    /// Downward.
    Down,
    /// Both, independently.
    #[default]
    Both,
}
