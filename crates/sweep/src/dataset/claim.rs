//! An output folder is made ready for a dataset.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use recordings::Manifest;

use super::kept;
use super::layout::{CALIBRATION, MANIFEST, PLAN, SWEEP, WORK};
use super::lock::lock;
use super::log::Log;
use super::options::Existing;
use super::output::{Output, PlanRecord};
use super::record::text;
use super::store::{Store, make, remove};
use crate::sweep_file::Format;
use crate::{Error, Plan};

/// An output folder that this process has locked, before it is known which plan it is for.
#[derive(Debug)]
pub struct Claim {
    output: Output,
    existing: Existing,
    /// Whether the dataset begins with the calibration in the folder.
    calibrated: bool,
}

impl Claim {
    /// Locks the folder `root`.
    ///
    /// # Errors
    /// - [`Error::Exists`], [`Error::NotOurs`] or [`Error::NoOverwrite`] if its content does not agree with
    ///   `existing`;
    /// - [`Error::InUse`] if another process writes to it;
    /// - [`Error::Unwritable`] if it cannot be written to, and other errors of the storage.
    pub fn new(root: &Path, existing: Existing) -> Result<Self, Error> {
        let store = Store::at(root)?;
        if store.folder().is_none() {
            return Self::in_bucket(store, root, existing);
        }
        let (empty, ours) = inspect(root)?;
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
            lock: Mutex::new(Some(lock(root)?)),
            root: root.to_owned(),
            warnings: Mutex::default(),
        };
        // Files of an interrupted process: no other process writes here now.
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
                lock: Mutex::default(),
                warnings: Mutex::default(),
            },
            existing,
            calibrated: false,
        })
    }

    /// The folder of the calibration that the dataset begins with; `is_kept` says whether
    /// it is there already. If not, a dataset that is to be replaced is removed first.
    ///
    /// # Errors
    /// [`Error::NoCalibration`] in a bucket, [`Error::OtherCalibration`] if a dataset was begun with another
    /// calibration, [`Error::Unwritable`] or [`Error::File`] if the old dataset cannot be removed.
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

    /// Whether a dataset has been begun here, or a finished one was copied here.
    fn begun(&self) -> bool {
        self.output.path(PLAN).exists() || self.output.is_published()
    }

    /// Makes the folder ready for the dataset of `plan`.
    ///
    /// # Errors
    /// [`Error::OtherPlan`] if it holds the dataset of another plan, [`Error::NotACalibration`] if the plan
    /// names an invalid calibration, and errors of files that cannot be read or written.
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
        let published = output.is_published();
        if published {
            output.check_published(plan)?;
        }
        output.record(plan)?;
        if published {
            output.adopt(plan)?;
        }
        output.keep_calibration(copied)?;
        let folders: &[&str] = match plan.format {
            Format::Parquet => &["signals", "features"],
            Format::Mcap => &["mcap", "features"],
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
    /// As [`Claim::new`] and [`Claim::open`].
    pub fn open(root: &Path, plan: &Plan, existing: Existing) -> Result<Self, Error> {
        Claim::new(root, existing)?.open(plan)
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
        let record = text(&record)?;
        if let Some(before) = self.store.create_only(PLAN, &record)? {
            match self.check(&before, plan) {
                // `sweep.yaml` gives the plan.
                Err(Error::DamagedPlan { .. })
                    if self.plan_of_sweep().is_ok_and(|own| own.id == plan.id) =>
                {
                    let path = self.path(PLAN);
                    self.warn(format!(
                        "`{}` is damaged: it is written again",
                        path.display()
                    ));
                    self.store.write(PLAN, record.as_bytes())?;
                }
                checked => checked?,
            }
        }
        let sweep = input::yaml::to_string(plan.sweep())?;
        self.store.write(SWEEP, sweep.as_bytes())?;
        Ok(())
    }

    /// Whether it is a finished dataset that came without `_sweep`.
    fn is_published(&self) -> bool {
        !self.path(PLAN).exists() && self.path(MANIFEST).exists()
    }

    /// Checks that a finished dataset that came without `_sweep` is that of `plan`; it stays as it was
    /// where it is not.
    fn check_published(&self, plan: &Plan) -> Result<(), Error> {
        let found = self.plan_of_sweep().map(|own| own.id);
        if found.as_ref().is_ok_and(|found| *found == plan.id) {
            return Ok(());
        }
        remove(&self.path("_sweep"), |path| fs::remove_dir_all(path))?;
        Err(Error::OtherPlan {
            path: self.root.clone(),
            found: found.unwrap_or_else(|_| "unknown".into()),
            expected: plan.id.clone(),
        })
    }
}

/// Whether a folder is empty or missing, and whether it is a dataset of ours.
fn inspect(root: &Path) -> Result<(bool, bool), Error> {
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
