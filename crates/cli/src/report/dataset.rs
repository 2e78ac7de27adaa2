//! The folder of a dataset: what it says about itself, and its tables.

use super::labels::{self, Label};
use super::sensors::Sensors;
use crate::Failure;
use ::report::text;
use recordings::Manifest;
use recordings::formats::parquet::ParquetFile;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use sweep::Plan;
use sweep::dataset::damage;

/// The channel of the crank angle.
pub(super) const CRANK_ANGLE: &str = "crank_angle_rad";

/// A whole dataset.
pub(super) struct Dataset {
    pub(super) folder: PathBuf,
    pub(super) manifest: Manifest,
    pub(super) plan: Plan,
    /// The numbers that both tables say about a case.
    pub(super) labels: Vec<Label>,
    /// The accelerometers that its faults are judged by.
    pub(super) sensors: Sensors,
    /// Tables that were compared with their checksums.
    compared: Mutex<BTreeSet<String>>,
}

impl Dataset {
    /// # Errors
    /// A folder without a manifest, or one whose manifest or sweep cannot be read.
    pub(super) fn open(folder: &Path) -> Result<Self, Failure> {
        let manifest = folder.join("manifest.json");
        if !manifest.is_file() {
            return Err(Failure::input(no_manifest(folder)));
        }
        let manifest = Manifest::read(&manifest).map_err(Failure::input)?;
        let plan = Plan::read(&folder.join("sweep.yaml")).map_err(Failure::input)?;
        Ok(Self {
            folder: folder.to_owned(),
            manifest,
            labels: labels::of(&plan),
            sensors: Sensors::of(&plan),
            plan,
            compared: Mutex::default(),
        })
    }

    /// The files of a subset, `signals` or `features`, from the dataset's folder.
    pub(super) fn files(&self, subset: &str) -> Vec<String> {
        let prefix = format!("{subset}/");
        let listed = self.manifest.files.iter().map(|file| &file.path);
        listed
            .filter(|path| path.starts_with(&prefix) && path.ends_with(".parquet"))
            .cloned()
            .collect()
    }

    /// Opens a table that the manifest lists.
    ///
    /// # Errors
    /// A file that is not there, or is not the one that was written.
    pub(super) fn table(&self, path: &str) -> Result<ParquetFile, Failure> {
        let place = self.folder.join(path);
        let listed = self.manifest.files.iter().find(|file| file.path == path);
        let mut compared = self.compared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(entry) = listed
            && compared.insert(path.to_owned())
            && let Some(damage) = damage(&self.folder, entry).map_err(Failure::work)?
        {
            return Err(Failure::input(format!(
                "{} {damage}: `crosshead verify` names all such files",
                place.display(),
            )));
        }
        ParquetFile::open(&place).map_err(Failure::input)
    }

    /// The message of `error`, which table `path` gave.
    pub(super) fn unreadable(&self, path: &str, error: recordings::Error) -> Failure {
        let place = self.folder.join(path);
        Failure::input(match error {
            recordings::Error::NoColumn { name, .. } => format!(
                "{}: no column `{name}`, which every dataset of this sweep has",
                place.display()
            ),
            recordings::Error::ColumnKind { .. } => format!("{}: {error}", place.display()),
            other => other.to_string(),
        })
    }

    /// Whether the recordings stand in tables that can be read.
    pub(super) fn has_signals(&self) -> bool {
        !self.sensors.is_empty() && !self.files("signals").is_empty()
    }

    /// Whether a sensor reads the crank angle.
    pub(super) fn has_crank_angle(&self) -> bool {
        let channels = self.plan.channels();
        channels.iter().any(|(name, _)| name == CRANK_ANGLE)
    }

    /// Why the page shows no recording; empty where it does.
    pub(super) fn why_no_recordings(&self) -> String {
        if self.has_signals() {
            return String::new();
        }
        let in_mcap = self
            .manifest
            .files
            .iter()
            .any(|file| file.path.starts_with("mcap/"));
        match (self.sensors.is_empty(), in_mcap) {
            (true, _) => "No sensor of this dataset measures an acceleration.",
            (_, true) => {
                "The recordings of this dataset are MCAP files, one per case, for Foxglove and the like; this page is made \
                 from the features alone."
            }
            _ => "No case has a recording.",
        }
        .to_owned()
    }

    /// Names of the machine's joints.
    pub(super) fn joints(&self) -> Vec<String> {
        let joints = self.plan.joints.iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    /// Names of the splits that have rows, in the order of use.
    pub(super) fn splits(&self) -> Vec<String> {
        let names = ["train", "validation", "test"].into_iter();
        names
            .filter(|name| self.manifest.counts.rows.contains_key(*name))
            .map(str::to_owned)
            .collect()
    }

    pub(super) fn revolutions_per_window(&self) -> u32 {
        let windows = self.plan.windows.map(|windows| windows.revolutions.get());
        windows.unwrap_or(self.plan.settings.revolutions)
    }

    /// What the dataset is, in a sentence or two.
    pub(super) fn about(&self) -> String {
        let (machine, counts) = (&self.plan.base.name, &self.manifest.counts);
        let failed = match counts.failed {
            0 => String::new(),
            n => format!(" ({n} failed)"),
        };
        let effects = match self.plan.effects.is_empty() {
            true => "",
            false => " and the effects that vary",
        };
        let mut about = format!(
            "Simulated recordings of the {machine}, labelled with the clearance of its joints{effects}: {}{failed}, {} of the crank \
             each.",
            text::counted(counts.cases as usize, "case"),
            text::counted(self.plan.settings.revolutions as usize, "revolution"),
        );
        if self.has_signals() {
            about += &format!(" {}", self.sensors.in_words());
            if !self.has_crank_angle() {
                about += " No sensor reads the crank angle: it is counted from the start of each window.";
            }
        } else {
            about += &format!(" {}", self.why_no_recordings());
        }
        about
    }
}

/// What is wrong with a folder that has no manifest.
fn no_manifest(folder: &Path) -> String {
    let shown = folder.display();
    if !folder.is_dir() {
        format!("{shown}: no such folder")
    } else if folder.join("_sweep").is_dir() {
        format!(
            "{shown}: the dataset is not finished (no manifest.json): gen-dataset SWEEP.yaml --out {shown} --resume finishes it"
        )
    } else {
        format!("{shown}: no dataset (no manifest.json)")
    }
}
