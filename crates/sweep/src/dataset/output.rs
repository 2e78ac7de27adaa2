//! The folder that a dataset is written to.
//!
//! Beside what readers see (`signals/`, `features/`, `mcap/`, `bifurcations/`, `README.md`,
//! `sweep.yaml`, `manifest.json`) it has `_sweep/`: `plan.json` says which sweep this is, `commits/K.json` that
//! shard K is finished, `attempts/` who is at work on which shard, `logs/` what each process did and
//! when, `tmp/` holds files that are being written, and `lock` is locked by the process at work: by one alone that makes the whole dataset,
//! or by any number that make a shard each. The operating system unlocks it when a process ends,
//! however it ends.
//!
//! A sweep that calibrates its machine first keeps what it found in `calibration/`; its resolved
//! sweep names that folder, and whoever runs it gets a copy.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use input::yaml::Document;
use recordings::Manifest;
use serde::{Deserialize, Serialize};

use super::commit::text;
use super::kept;
use super::log::{self, Log};
use super::store::Store;
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

/// The place of a dataset that has been begun, locked unless it is only looked at.
#[derive(Debug)]
pub struct Output {
    pub(super) store: Store,
    pub(super) root: PathBuf,
    pub(super) log: Log,
    lock: Option<Lock>,
}

/// A locked file.
#[derive(Debug)]
struct Lock {
    file: File,
    /// Whether nobody else holds it.
    alone: bool,
}

/// Content of `_sweep/plan.json`.
#[derive(Serialize, Deserialize)]
struct PlanRecord {
    plan_id: String,
    name: String,
    cases: u64,
    shards: u64,
    #[serde(default)]
    diagrams: u64,
}

const PLAN: &str = "_sweep/plan.json";
const SWEEP: &str = "sweep.yaml";
/// What each process leaves alone in `_sweep/tmp` unless it is alone: younger files may be under way.
const DAY: Duration = Duration::from_secs(24 * 60 * 60);

/// What a dataset has at its top, apart from `_sweep`.
const FOLDERS: [&str; 4] = ["signals", "features", "mcap", "bifurcations"];
const FILES: [&str; 3] = ["README.md", "sweep.yaml", "manifest.json"];
const WORK: [&str; 4] = [
    "_sweep/commits",
    "_sweep/attempts",
    log::FOLDER,
    "_sweep/tmp",
];
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
        let store = Store::at(root)?;
        if store.folder().is_none() {
            return Self::in_bucket(store, root, existing);
        }
        let (empty, ours) = look(root)?;
        match existing {
            _ if empty => {}
            _ if !ours => return Err(Error::NotOurs(root.to_owned())),
            Existing::Refuse => return Err(Error::Exists(root.to_owned())),
            Existing::Resume | Existing::Overwrite => {}
        }
        for folder in WORK {
            make(&root.join(folder))?;
        }
        let output = Output {
            store,
            log: Log::default(),
            lock: Some(lock(root)?),
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

    /// The same in object storage. Nothing is locked there: whose plan is written first has it.
    fn in_bucket(store: Store, root: &Path, existing: Existing) -> Result<Self, Error> {
        let begun = store.length(PLAN)?.is_some();
        let empty = begun || store.names("")?.is_empty();
        let root = root.to_owned();
        match existing {
            _ if !empty => return Err(Error::NotOurs(root)),
            Existing::Overwrite => return Err(Error::NoOverwrite(root)),
            Existing::Refuse if begun => return Err(Error::Exists(root)),
            Existing::Refuse | Existing::Resume => {}
        }
        Ok(Self {
            output: Output {
                store,
                root,
                log: Log::default(),
                lock: None,
            },
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
        if self.output.store.folder().is_none() {
            return Err(Error::NoCalibration(self.output.root.clone()));
        }
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
        self.output.path(PLAN).exists()
    }

    /// Makes the folder ready for the dataset of `plan`.
    ///
    /// # Errors
    /// Where it holds the dataset of another plan, or cannot be written to.
    pub fn open(self, plan: &Plan) -> Result<Output, Error> {
        let own = self.output.path(CALIBRATION);
        let named = plan.calibrated.as_ref();
        let is_own = named.is_some_and(|from| {
            let from = fs::canonicalize(from).ok();
            from.is_some() && from == fs::canonicalize(&own).ok()
        });
        let has_it = self.calibrated || is_own;
        // Before anything is written or removed.
        let copied = match named.filter(|_| !has_it) {
            Some(from) => kept::read(from)?,
            None => Vec::new(),
        };
        if self.output.store.folder().is_none() {
            self.output.record(plan)?;
            self.output.keep_calibration(copied)?;
            return Ok(self.output);
        }
        let begun = self.begun();
        let output = self.output;
        if self.existing == Existing::Overwrite {
            output.clear(has_it)?;
        } else if !begun && !has_it {
            output.clear_calibration()?;
        }
        output.record(plan)?;
        output.keep_calibration(copied)?;
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

    /// The planned dataset at `root`, and its plan, for one of any number of processes that make it
    /// together.
    ///
    /// # Errors
    /// Where nothing has been planned there, or by another version of the program, or a process
    /// makes the whole dataset.
    pub fn join(root: &Path) -> Result<(Self, Plan), Error> {
        let (mut output, plan) = Self::look(root)?;
        if output.store.folder().is_some() {
            output.lock = lock_shared(root)?;
        }
        Ok((output, plan))
    }

    /// As [`Output::join`], to read only.
    ///
    /// # Errors
    /// Where nothing has been planned there, or by another version of the program.
    pub fn look(root: &Path) -> Result<(Self, Plan), Error> {
        let output = Self {
            store: Store::at(root)?,
            root: root.to_owned(),
            log: Log::default(),
            lock: None,
        };
        let not_planned = || Error::NotPlanned(root.to_owned());
        let record = output.store.read(PLAN)?.ok_or_else(not_planned)?;
        let sweep = output.store.read(SWEEP)?.ok_or_else(not_planned)?;
        let sweep = Document::parse(&sweep, &output.path(SWEEP).display().to_string())?;
        let plan = Plan::new(&sweep, root)?;
        output.check(&record, &plan)?;
        Ok((output, plan))
    }

    /// Where file `path` of the dataset stands.
    pub fn path(&self, path: &str) -> PathBuf {
        self.store.path(path)
    }

    /// Removes what crashes left a day ago or earlier.
    ///
    /// # Errors
    /// Where it cannot be removed.
    pub(super) fn tidy(&self) -> Result<(), Error> {
        let Some(folder) = self.store.folder() else {
            return Ok(());
        };
        let Ok(entries) = fs::read_dir(folder.join("_sweep/tmp")) else {
            return Ok(());
        };
        for entry in entries.flatten() {
            let modified = entry.metadata().and_then(|found| found.modified()).ok();
            let age = modified.and_then(|time| time.elapsed().ok());
            if age.is_some_and(|age| age > DAY) {
                remove(&entry.path(), |path| fs::remove_file(path))?;
            }
        }
        Ok(())
    }

    /// Removes a dataset, and nothing else; its calibration stays where that is asked for.
    fn clear(&self, keep_calibration: bool) -> Result<(), Error> {
        // The manifest goes first: without it the folder is not a complete dataset.
        for file in FILES.into_iter().rev().chain([PLAN]).chain(PAGES) {
            remove(&self.path(file), |path| fs::remove_file(path))?;
        }
        for folder in FOLDERS.into_iter().chain(WORK) {
            remove(&self.path(folder), |path| fs::remove_dir_all(path))?;
        }
        self.clear_figures()?;
        if !keep_calibration {
            self.clear_calibration()?;
        }
        WORK.iter().try_for_each(|folder| make(&self.path(folder)))
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
            diagrams: plan.diagrams.len() as u64,
        };
        if let Some(before) = self.store.create_only(PLAN, &text(&record)?)? {
            self.check(&before, plan)?;
        }
        let sweep = input::yaml::to_string(plan.sweep())?;
        self.store.write(SWEEP, sweep.as_bytes())?;
        Ok(())
    }

    /// Checks that `record` is that of `plan`.
    fn check(&self, record: &str, plan: &Plan) -> Result<(), Error> {
        let record: PlanRecord = serde_json::from_str(record).map_err(|e| Error::Damaged {
            path: self.path(PLAN),
            reason: e.to_string(),
        })?;
        if record.plan_id == plan.id {
            return Ok(());
        }
        Err(Error::OtherPlan {
            path: self.root.clone(),
            found: record.plan_id,
            expected: plan.id.clone(),
        })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if self.alone {
            // An empty lock file: the folder of a finished dataset is the same whoever wrote it.
            let _ = self.file.set_len(0);
        }
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
    let ours = root.join(PLAN).is_file() || Manifest::read(&root.join("manifest.json")).is_ok();
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
fn lock(root: &Path) -> Result<Lock, Error> {
    let (mut file, unwritable) = lock_file(root)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(in_use(root, file)),
        Err(TryLockError::Error(source)) => return Err(unwritable(source)),
    }
    let mut sign = || {
        file.set_len(0)?;
        file.seek(SeekFrom::Start(0))?;
        write!(file, "process {}", std::process::id())
    };
    sign().map_err(unwritable)?;
    Ok(Lock { file, alone: true })
}

/// Locks `_sweep/lock` together with others; nothing where the file system knows no locks, because
/// the records of a dataset do not need them.
fn lock_shared(root: &Path) -> Result<Option<Lock>, Error> {
    let (file, unwritable) = lock_file(root)?;
    match file.try_lock_shared() {
        Ok(()) => Ok(Some(Lock { file, alone: false })),
        Err(TryLockError::WouldBlock) => Err(in_use(root, file)),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(None),
        Err(TryLockError::Error(source)) => Err(unwritable(source)),
    }
}

fn lock_file(root: &Path) -> Result<(File, impl Fn(io::Error) -> Error), Error> {
    let path = root.join("_sweep/lock");
    let mut options = OpenOptions::new();
    let options = options.read(true).write(true).create(true).truncate(false);
    let file = options.open(&path);
    let unwritable = move |source| Error::Unwritable {
        path: path.clone(),
        source,
    };
    Ok((file.map_err(&unwritable)?, unwritable))
}

fn in_use(root: &Path, mut lock: File) -> Error {
    let mut by = String::new();
    let _ = lock.read_to_string(&mut by);
    Error::InUse {
        path: root.to_owned(),
        by: if by.is_empty() {
            "one that makes a shard".into()
        } else {
            by
        },
    }
}
