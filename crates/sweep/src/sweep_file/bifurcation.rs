//! Bifurcation diagrams that a sweep asks for.

use super::{Amount, Axes, Spacing};
use input::choice::Count;
use input::quantity::{Angle, Quantity};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// A bifurcation diagram: one number of the machine changes step by step, and the motion goes on
/// from value to value. What the sweep varies at random stays as the machine file has it.
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
    /// Revolutions at each value before the recording; 40 where it is left out.
    #[serde(default)]
    pub transient: Option<Count<1, 1_000_000>>,
    /// Revolutions that are recorded at each value.
    pub revolutions: Count<1, 1_000_000>,
    /// Which way the values are gone through.
    #[serde(default)]
    pub directions: Directions,
    /// Crank angle of the section; 0 deg where it is left out.
    #[serde(default)]
    pub at: Option<Quantity<Angle>>,
    /// Which joints are clear, as in the axes of `cases`: their clearance is told by `path` or
    /// `set`. Where it is left out, those that the machine file, `path` and `set` make clear.
    #[serde(default)]
    pub joints: Option<Vec<String>>,
    /// Other values of the machine: `clearance`, `load`, or paths.
    #[serde(default)]
    pub set: Axes<Value>,
    /// Values that are gone through without a break; 24 where it is left out. Longer pieces follow
    /// wider hystereses and leave less to do side by side.
    #[serde(default)]
    pub chunk: Option<Count<1, 1_000_000>>,
}

/// Which way the values of a diagram are gone through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// Upward.
    Up,
    /// Downward.
    Down,
    /// Both, each by itself.
    #[default]
    Both,
}
