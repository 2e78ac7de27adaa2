//! A valve that a recorded pressure does not open: what the machine does, and no contradiction.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A valve of a chamber.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Valve {
    /// It lets gas in.
    Suction,
    /// It lets gas out.
    Discharge,
}

/// A valve that a chamber's recorded pressure does not open. The cylinder is unloaded, motored or blocked in, or it leaks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShutValve {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub channel: String,
    /// The valve.
    pub valve: Valve,
    /// The pressure nearest to its line that the chamber reaches, Pa.
    pub reached_pa: f64,
    /// The pressure that is stated for the line, Pa.
    pub stated_pa: f64,
}

impl Valve {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Suction => "suction",
            Self::Discharge => "discharge",
        }
    }
}

impl fmt::Display for ShutValve {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let verb = match self.valve {
            Valve::Suction => "falls",
            Valve::Discharge => "rises",
        };
        write!(
            f,
            "{}, {}: the {} valve does not open. The pressure {verb} only to {:.4} MPa, and that of the line is stated as {:.4} MPa. \
             The cylinder is unloaded, motored or blocked in, or it leaks.",
            self.run,
            self.channel,
            self.valve.name(),
            self.reached_pa / 1e6,
            self.stated_pa / 1e6,
        )
    }
}
