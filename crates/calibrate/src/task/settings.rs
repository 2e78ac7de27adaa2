//! The settings of a calibration, and where they stand.

use input::calibration::Calibration;
use serde_json::Value;
use std::path::Path;

/// What is calibrated, and how.
pub struct Settings<'a> {
    /// The settings as a file has them.
    pub calibration: &'a Calibration,
    /// The folder from which their paths start.
    pub base: &'a Path,
    /// The tree of the machine file, in the place of the file that the settings name.
    pub machine: Option<&'a Value>,
    /// Whether its bundles may name recordings outside of their folders.
    pub allow_outside: bool,
    /// Whether the clearances are what is asked for: those that the runs state are passed over, and the machine has
    /// those of its file.
    pub clearances_unknown: bool,
    /// Gives a mistake in the settings the place where they stand.
    pub locate: &'a dyn Fn(input::Error) -> input::Error,
}

impl Settings<'_> {
    /// Whether there is a machine file beside the bundle's machine section.
    pub(super) fn has_machine_file(&self) -> bool {
        self.machine.is_some() || self.calibration.machine.is_some()
    }
}
