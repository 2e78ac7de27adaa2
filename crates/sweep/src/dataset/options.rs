//! How a sweep is run.

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::{Error, Plan};

/// What to do with a folder that has something in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Leave it alone and stop.
    #[default]
    Refuse,
    /// Continue it, if it was begun with the same plan.
    Resume,
    /// Replace it, if it is a dataset of this program.
    Overwrite,
}

/// The command that simulates case `case` of the dataset at `root` and throws the result away;
/// nothing if there is no such program. It must end when its standard input does, because its parent then
/// has.
pub type Trial<'a> = dyn Fn(&Path, u64) -> Option<Command> + Sync + 'a;

/// How a sweep is run.
pub struct Options<'a> {
    /// What to do with an output folder that has something in it.
    pub existing: Existing,
    /// Threads that simulate; at least one.
    pub threads: usize,
    /// Once true, no new work starts and [`Error::Cancelled`] is returned.
    pub cancel: &'a AtomicBool,
    /// Whether finished shards with failed cases are made again, for any reason of failure.
    pub retry_failed: bool,
    /// Tries a case in a process of its own, where several processes ended without a result; without
    /// it, such a case is not found.
    pub trial: Option<&'a Trial<'a>>,
}

impl Options<'_> {
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// An error once the run is cancelled; `done` shards of `plan` are then finished.
    pub(super) fn check_cancelled(&self, plan: &Plan, done: u64) -> Result<(), Error> {
        let shards = plan.shards();
        match self.is_cancelled() {
            true => Err(Error::Cancelled { done, shards }),
            false => Ok(()),
        }
    }
}
