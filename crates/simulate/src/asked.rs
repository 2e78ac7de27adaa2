//! What is to be recorded of a machine.

use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::warm_start::WarmStart;
use mechanism::Machine;

/// What is to be recorded.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// What looks at it.
    pub sensors: &'a [Sensor],
    /// For how long, how finely, how accurately.
    pub settings: &'a Settings,
    /// Where it begins; at rest without one, or with one of a machine of another build.
    pub warm_start: Option<&'a WarmStart>,
}

impl<'a> Asked<'a> {
    /// A record of a machine that begins at rest.
    pub fn from_rest(machine: &'a Machine, sensors: &'a [Sensor], settings: &'a Settings) -> Self {
        Self {
            machine,
            sensors,
            settings,
            warm_start: None,
        }
    }
}
