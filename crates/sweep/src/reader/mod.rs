//! A finished dataset is read back: what it says about itself, and the rows of its tables.

mod channel_features;
mod diagram;
mod error;
mod files;
mod labels;
mod like;
mod motions;
mod sample;
mod sensors;
mod signal_row;
mod subset;
mod windows;

pub use channel_features::{Band, ChannelFeatures};
pub use diagram::{Diagram, Direction, Point, Quantity};
pub use error::Error;
pub use labels::{Label, Meaning, Side, Text};
pub use like::{Like, Unlike};
pub use motions::Motions;
pub use sample::{LabelledSample, matrix, numeric_features};
pub use sensors::Sensors;
pub use signal_row::SignalRow;
pub use subset::Subset;
pub use windows::{Case, Windows};

use crate::Plan;
use crate::dataset::CRANK_ANGLE;
use files::Files;
use recordings::{Column, Manifest, Table};
use std::path::Path;

/// A finished dataset, its table of features read.
pub struct Dataset {
    /// Its sweep.
    pub plan: Plan,
    /// The accelerometers that its faults are judged by.
    pub sensors: Sensors,
    /// The rows of the table of features.
    pub windows: Windows,
    /// The windows of each case, in the order of the sweep.
    pub cases: Vec<Case>,
    files: Files,
}

impl Dataset {
    /// Reads the manifest, the sweep and the table of features in `folder`.
    ///
    /// # Errors
    /// A folder without a manifest, or a file that cannot be read or is not the one that was written.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let files = Files::in_folder(folder)?;
        let plan = Plan::read(&folder.join("sweep.yaml"))?;
        let sensors = Sensors::new(&plan);
        let windows = Windows::read(&files, &plan, &sensors)?;
        Ok(Self {
            cases: windows.cases(),
            plan,
            sensors,
            windows,
            files,
        })
    }

    /// What it says about itself.
    pub fn manifest(&self) -> &Manifest {
        &self.files.manifest
    }

    /// The columns of the first file of a subset; none of a subset without files.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn columns(&self, subset: Subset) -> Result<Vec<Column>, Error> {
        let Some(path) = self.files.paths(subset).into_iter().next() else {
            return Ok(Vec::new());
        };
        Ok(self.files.open(&path)?.schema().columns().to_vec())
    }

    /// Whether the recordings stand in tables and have an accelerometer to show.
    pub fn has_signals(&self) -> bool {
        !self.sensors.is_empty() && !self.files.paths(Subset::Signals).is_empty()
    }

    /// Whether the recordings are MCAP files.
    pub fn is_in_mcap(&self) -> bool {
        let mut files = self.manifest().files.iter();
        files.any(|file| file.path.starts_with("mcap/"))
    }

    /// Whether a sensor reads the crank angle.
    pub fn has_crank_angle(&self) -> bool {
        let channels = self.plan.channels();
        channels.iter().any(|(name, _)| name == CRANK_ANGLE)
    }

    /// Names of the machine's joints.
    pub fn joints(&self) -> Vec<String> {
        let joints = self.plan.joints.iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    /// Names of the splits that have rows, in the order of use.
    pub fn splits(&self) -> Vec<String> {
        let names = ["train", "validation", "test"].into_iter();
        names
            .filter(|name| self.manifest().counts.rows.contains_key(*name))
            .map(str::to_owned)
            .collect()
    }

    /// Revolutions of the crank in one window.
    pub fn revolutions_per_window(&self) -> u32 {
        let windows = self.plan.windows.map(|windows| windows.revolutions.get());
        windows.unwrap_or(self.plan.settings.revolutions)
    }
}

/// The values of a column of numbers; NaN where one is missing.
fn numbers(table: &Table, name: &str) -> Result<impl Iterator<Item = f64>, recordings::Error> {
    let values = table.values::<f64>(name)?.iter();
    Ok(values.map(|value| value.unwrap_or(f64::NAN)))
}

/// The values of a column of texts; empty where one is missing.
fn texts(table: &Table, name: &str) -> Result<impl Iterator<Item = String>, recordings::Error> {
    let values = table.values::<String>(name)?.iter();
    Ok(values.map(|value| value.clone().unwrap_or_default()))
}
