//! The place of a dataset that has been begun.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use files::Locked;
use input::yaml::Document;
use serde::{Deserialize, Serialize};

use super::layout::{PLAN, SWEEP};
use super::lock::{Lock, lock_commits, lock_shared};
use super::log::Log;
use super::store::Store;
use crate::{Error, Plan};

/// The place of a dataset that has been begun, locked unless it is only looked at.
#[derive(Debug)]
pub struct Output {
    pub(super) store: Store,
    pub(super) root: PathBuf,
    pub(super) log: Log,
    pub(super) lock: Mutex<Option<Lock>>,
    pub(super) warnings: Mutex<Vec<String>>,
}

/// Content of `_sweep/plan.json`.
#[derive(Serialize, Deserialize)]
pub(super) struct PlanRecord {
    pub(super) plan_id: String,
    pub(super) name: String,
    pub(super) cases: u64,
    pub(super) shards: u64,
    #[serde(default)]
    pub(super) diagrams: u64,
}

impl Output {
    /// The planned dataset at `root`, and its plan, for one of any number of processes that make it
    /// together.
    ///
    /// # Errors
    /// As [`Output::open_read_only`], and [`Error::InUse`] if a process makes the whole dataset.
    pub fn join(root: &Path) -> Result<(Self, Plan), Error> {
        let (mut output, plan) = Self::open_read_only(root)?;
        if output.store.folder().is_some() {
            output.lock = Mutex::new(lock_shared(root)?);
        }
        Ok((output, plan))
    }

    /// As [`Output::join`], to read only.
    ///
    /// # Errors
    /// [`Error::NotPlanned`] without a plan, [`Error::DamagedPlan`] if its record cannot be parsed,
    /// [`Error::OtherPlan`] if it belongs to another sweep or version, [`Error::Input`] if `sweep.yaml` has a
    /// mistake.
    pub fn open_read_only(root: &Path) -> Result<(Self, Plan), Error> {
        let output = Self {
            store: Store::at(root)?,
            root: root.to_owned(),
            log: Log::default(),
            lock: Mutex::default(),
            warnings: Mutex::default(),
        };
        let not_planned = || Error::NotPlanned(root.to_owned());
        let record = output.store.bytes(PLAN)?.ok_or_else(not_planned)?;
        let plan = output.plan_of_sweep()?;
        output.check(&record, &plan)?;
        Ok((output, plan))
    }

    /// Keeps a warning for whoever asks, once.
    pub(super) fn warn(&self, text: String) {
        let mut warnings = self.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        if !warnings.contains(&text) {
            warnings.push(text);
        }
    }

    /// What is wrong with what was there before: damaged records and files, which count as not made.
    pub fn take_warnings(&self) -> Vec<String> {
        let mut warnings = self.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut warnings)
    }

    /// Where file `path` of the dataset stands.
    pub fn path(&self, path: &str) -> PathBuf {
        self.store.path(path)
    }

    /// Does `work` with a log called `name`, in which its error is the last line.
    pub(super) fn logged<T>(
        &self,
        name: &str,
        work: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.log.begin(name);
        let result = work();
        if let Err(error) = &result {
            self.say(format_args!("ended: {error}"));
        }
        self.log.end(&self.store);
        result
    }

    /// Appends a line to the log.
    pub(super) fn say(&self, what: impl Display) {
        self.log.say(&self.store, what);
    }

    /// Whether no other process writes to this dataset.
    pub(super) fn is_alone(&self) -> bool {
        let lock = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        lock.as_ref().is_some_and(|lock| lock.alone)
    }

    /// Waits until no other process commits a shard, or until none does so `alone`. No lock is needed
    /// if one process makes the whole dataset, or if there are no locks.
    pub(super) fn committing(&self, alone: bool) -> Result<Option<Locked>, Error> {
        match self.store.folder().filter(|_| !self.is_alone()) {
            Some(root) => lock_commits(root, alone),
            None => Ok(None),
        }
    }

    /// The plan of the `sweep.yaml` that stands there.
    pub(super) fn plan_of_sweep(&self) -> Result<Plan, Error> {
        let not_planned = || Error::NotPlanned(self.root.clone());
        let sweep = self.store.read(SWEEP)?.ok_or_else(not_planned)?;
        let sweep = Document::parse(&sweep, &self.path(SWEEP).display().to_string())?;
        Ok(Plan::new(&sweep, &self.root)?)
    }

    /// Checks that `record` is that of `plan`.
    pub(super) fn check(&self, record: &[u8], plan: &Plan) -> Result<(), Error> {
        let record: PlanRecord =
            serde_json::from_slice(record).map_err(|e| Error::DamagedPlan {
                path: self.path(PLAN),
                reason: e.to_string(),
                root: self.root.clone(),
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
