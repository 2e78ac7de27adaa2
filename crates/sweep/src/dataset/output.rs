//! The folder that a dataset is written to.
//!
//! Beside what readers see (`signals/`, `features/`, `mcap/`, `bifurcations/`, `README.md`,
//! `sweep.yaml`, `manifest.json`) it has `_sweep/`: `plan.json` says which sweep this is, `commits/K.json` that
//! shard K is finished, `tmp/` holds files that are being written, and `lock` is locked by the
//! process at work. The operating system unlocks it when that process ends, however it ends.
//! A sweep that calibrates its machine first keeps what it found in `calibration/`; its resolved
//! sweep names that folder, and whoever runs it gets a copy.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use recordings::{FileRecord, Manifest, WholeFile};
use serde::{Deserialize, Serialize};

use super::commit::create_only;
use crate::{Error, Plan};

/// What to do with a folder that has something in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Leave it alone and stop.
    #[default]
    Refuse,
    /// Go on with it, if it was begun with the same plan.
    Resume,
    /// Replace it, if it is a dataset of this program.
    Overwrite,
}

/// An output folder that this process has locked, before it is known which plan it is for.
#[derive(Debug)]
pub struct Claim {
    output: Output,
    existing: Existing,
    /// Whether the dataset begins with the calibration in the folder.
    calibrated: bool,
}

/// A locked output folder.
#[derive(Debug)]
pub struct Output {
    root: PathBuf,
    lock: File,
}

/// Content of `_sweep/plan.json`.
#[derive(Serialize, Deserialize)]
struct PlanRecord {
    plan_id: String,
    name: String,
    cases: u64,
    shards: u64,
}

/// What a dataset has at its top, apart from `_sweep`.
const FOLDERS: [&str; 4] = ["signals", "features", "mcap", "bifurcations"];
const FILES: [&str; 3] = ["README.md", "sweep.yaml", "manifest.json"];
/// The folder of the calibration that a dataset begins with.
pub const CALIBRATION: &str = "calibration";
/// What `crosshead report` makes of a dataset; figures are the SVG files with these beginnings.
const PAGES: [&str; 3] = ["report.html", "chaos.html", "features.html"];
const FIGURES: [&str; 2] = ["dataset-", "chaos-"];

impl Claim {
    /// Locks the folder `root`.
    ///
    /// # Errors
    /// Where the folder has something in it that `existing` does not allow for, another process
    /// writes to it, or it cannot be written to. It is then as it was.
    pub fn new(root: &Path, existing: Existing) -> Result<Self, Error> {
        let (empty, ours) = look(root)?;
        match existing {
            _ if empty => {}
            _ if !ours => return Err(Error::NotOurs(root.to_owned())),
            Existing::Refuse => return Err(Error::Exists(root.to_owned())),
            Existing::Resume | Existing::Overwrite => {}
        }
        for folder in ["_sweep/commits", "_sweep/tmp"] {
            make(&root.join(folder))?;
        }
        let output = Output {
            lock: lock(root)?,
            root: root.to_owned(),
        };
        // What an interrupted process left: nobody else writes here now.
        remove(&output.path("_sweep/tmp"), |path| fs::remove_dir_all(path))?;
        make(&output.path("_sweep/tmp"))?;
        Ok(Self {
            output,
            existing,
            calibrated: false,
        })
    }

    /// The folder of the calibration that the dataset begins with; `is_kept` tells that it is there
    /// already. Where it is not, a dataset that is to be replaced goes first.
    ///
    /// # Errors
    /// Where a dataset was begun with another calibration, or the folder cannot be written to.
    pub fn calibration(&mut self, is_kept: bool) -> Result<PathBuf, Error> {
        self.calibrated = true;
        if !is_kept {
            match self.existing {
                Existing::Overwrite => self.output.clear(self.calibrated)?,
                _ if self.begun() => {
                    return Err(Error::OtherCalibration(self.output.root.clone()));
                }
                _ => {}
            }
        }
        Ok(self.output.path(CALIBRATION))
    }

    /// Whether a dataset has been begun here.
    fn begun(&self) -> bool {
        self.output.path("_sweep/plan.json").exists()
    }

    /// Makes the folder ready for the dataset of `plan`.
    ///
    /// # Errors
    /// Where it holds the dataset of another plan, or cannot be written to.
    pub fn open(self, plan: &Plan) -> Result<Output, Error> {
        let begun = self.begun();
        let output = self.output;
        let own = output.path(CALIBRATION);
        let is_own = |from: &PathBuf| fs::canonicalize(from).ok() == fs::canonicalize(&own).ok();
        let has_it = self.calibrated || plan.calibrated.as_ref().is_some_and(is_own);
        if self.existing == Existing::Overwrite {
            output.clear(has_it)?;
        } else if !begun && !has_it {
            output.clear_calibration()?;
        }
        output.record(plan)?;
        if let Some(from) = plan.calibrated.as_ref().filter(|_| !has_it) {
            output.copy_calibration(from)?;
        }
        let folders: &[&str] = match plan.format {
            crate::sweep_file::Format::Parquet => &["signals", "features"],
            crate::sweep_file::Format::Mcap => &["mcap", "features"],
        };
        let diagrams = Some("bifurcations").filter(|_| !plan.diagrams.is_empty());
        for folder in folders.iter().copied().chain(diagrams) {
            make(&output.path(folder))?;
        }
        Ok(output)
    }
}

impl Output {
    /// Makes the folder ready for the dataset of `plan`, and locks it.
    ///
    /// # Errors
    /// Where the folder has something in it that `existing` does not allow for, another process
    /// writes to it, or it cannot be written to. It is then as it was.
    pub fn open(root: &Path, plan: &Plan, existing: Existing) -> Result<Self, Error> {
        Claim::new(root, existing)?.open(plan)
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where file `path` of the dataset stands.
    pub fn path(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }

    /// Starts a file that will stand at `path` when it is finished.
    pub(super) fn create(&self, path: &str) -> Result<WholeFile, Error> {
        let name = path.replace('/', "-");
        let temporary = format!("_sweep/tmp/{name}.{}.part", std::process::id());
        Ok(WholeFile::create(&self.path(&temporary), &self.path(path))?)
    }

    /// Writes a file at once.
    pub(super) fn write(&self, path: &str, content: &[u8]) -> Result<FileRecord, Error> {
        let mut file = self.create(path)?;
        file.write_all(content).map_err(recordings::Error::Write)?;
        Ok(file.commit()?)
    }

    /// Removes a dataset, and nothing else; its calibration stays where that is asked for.
    fn clear(&self, keep_calibration: bool) -> Result<(), Error> {
        // The manifest goes first: without it the folder is not a complete dataset.
        for file in FILES
            .into_iter()
            .rev()
            .chain(["_sweep/plan.json"])
            .chain(PAGES)
        {
            remove(&self.path(file), |path| fs::remove_file(path))?;
        }
        for folder in FOLDERS.into_iter().chain(["_sweep/commits"]) {
            remove(&self.path(folder), |path| fs::remove_dir_all(path))?;
        }
        self.clear_figures()?;
        if !keep_calibration {
            self.clear_calibration()?;
        }
        make(&self.path("_sweep/commits"))
    }

    fn clear_calibration(&self) -> Result<(), Error> {
        remove(&self.path(CALIBRATION), |path| fs::remove_dir_all(path))
    }

    /// Removes the figures of a report; whatever else is in their folder stays.
    fn clear_figures(&self) -> Result<(), Error> {
        let folder = self.path("figures");
        let Ok(entries) = fs::read_dir(&folder) else {
            return Ok(());
        };
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".svg") && FIGURES.iter().any(|start| name.starts_with(start)) {
                remove(&entry.path(), |path| fs::remove_file(path))?;
            }
        }
        // A folder that still has something in it is not removed.
        let _ = fs::remove_dir(&folder);
        Ok(())
    }

    /// Writes which plan the folder is for, or checks it.
    fn record(&self, plan: &Plan) -> Result<(), Error> {
        let record = PlanRecord {
            plan_id: plan.id.clone(),
            name: plan.name.clone(),
            cases: plan.cases(),
            shards: plan.shards(),
        };
        let path = self.path("_sweep/plan.json");
        let Some(before) = create_only(self, "_sweep/plan.json", &record)? else {
            return Ok(());
        };
        let before: PlanRecord = serde_json::from_str(&before).map_err(|e| Error::Damaged {
            path,
            reason: e.to_string(),
        })?;
        if before.plan_id == plan.id {
            return Ok(());
        }
        Err(Error::OtherPlan {
            path: self.root.clone(),
            found: before.plan_id,
            expected: plan.id.clone(),
        })
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        // An empty lock file: the folder of a finished dataset is the same whoever wrote it.
        let _ = self.lock.set_len(0);
    }
}

/// Whether a folder is empty or missing, and whether it is a dataset of ours.
fn look(root: &Path) -> Result<(bool, bool), Error> {
    let unwritable = |source| Error::Unwritable {
        path: root.to_owned(),
        source,
    };
    let empty = match fs::read_dir(root) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => true,
        Err(error) => return Err(unwritable(error)),
    };
    let ours = root.join("_sweep/plan.json").is_file()
        || Manifest::read(&root.join("manifest.json")).is_ok();
    // A crash before the plan is written leaves only work files, and perhaps a calibration.
    let begun = !empty && only_work_files(root).map_err(unwritable)?;
    Ok((empty || begun, ours))
}

fn only_work_files(root: &Path) -> io::Result<bool> {
    for entry in fs::read_dir(root)? {
        let name = entry?.file_name();
        if name != "_sweep" && name != CALIBRATION {
            return Ok(false);
        }
    }
    let work = root.join("_sweep");
    Ok(work.exists() && !work.join("plan.json").exists())
}

fn make(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|source| Error::Unwritable {
        path: folder.to_owned(),
        source,
    })
}

fn remove(path: &Path, how: impl Fn(&Path) -> io::Result<()>) -> Result<(), Error> {
    match how(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Error::Unwritable {
            path: path.to_owned(),
            source: error,
        }),
        _ => Ok(()),
    }
}

/// Locks `_sweep/lock`, and writes this process's number into it for whoever comes second.
fn lock(root: &Path) -> Result<File, Error> {
    let path = root.join("_sweep/lock");
    let unwritable = |source| Error::Unwritable {
        path: path.clone(),
        source,
    };
    let mut options = OpenOptions::new();
    let options = options.read(true).write(true).create(true).truncate(false);
    let mut file = options.open(&path).map_err(unwritable)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let mut by = String::new();
            let _ = file.read_to_string(&mut by);
            return Err(Error::InUse {
                path: root.to_owned(),
                by: if by.is_empty() { "unknown".into() } else { by },
            });
        }
        Err(TryLockError::Error(source)) => return Err(unwritable(source)),
    }
    let mut sign = || {
        file.set_len(0)?;
        file.seek(SeekFrom::Start(0))?;
        write!(file, "process {}", std::process::id())
    };
    sign().map_err(unwritable)?;
    Ok(file)
}
