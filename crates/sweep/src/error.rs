//! What can go wrong with a sweep.

use std::io;
use std::path::PathBuf;

use crate::dataset::Fault;
use crate::ranges::ranges;

/// What can go wrong with a sweep. A failed case is not an error: it is listed in the manifest, and
/// the other cases are run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A mistake in a sweep or machine file.
    #[error(transparent)]
    Input(#[from] input::Error),
    /// Settings, recordings or a machine with which a sweep cannot calibrate.
    #[error(transparent)]
    Calibrate(#[from] calibrate::Error),
    /// A sweep that is too large to be run.
    #[error(
        "the sweep has {cases} cases, and one dataset can have at most {most}: give fewer values \
         or a smaller count, or write several sweeps, each with its own seed"
    )]
    TooManyCases {
        /// Cases of the sweep.
        cases: u64,
        /// The most that are run.
        most: u64,
    },
    /// The output folder has something in it.
    #[error(
        "`{}` is not empty: --resume continues it, --overwrite replaces it", .0.display()
    )]
    Exists(PathBuf),
    /// The output folder holds something that this program did not write.
    #[error(
        "`{}` is not empty and not a dataset of this program, so it is left alone: choose another \
         folder", .0.display()
    )]
    NotOurs(PathBuf),
    /// The place of a dataset has no plan.
    #[error(
        "`{}` holds no planned sweep: `crosshead sweep plan SWEEP.yaml --out {}` begins one",
        .0.display(), .0.display()
    )]
    NotPlanned(PathBuf),
    /// A dataset that has no manifest yet.
    #[error(
        "`{}` is not complete: `crosshead sweep finalize` makes it so, or says what is missing",
        .0.display()
    )]
    NotFinalized(PathBuf),
    /// The log of a Delta table that is not that of the dataset.
    #[error(
        "`{}` is the log of another Delta table: remove its folder, or leave the table as it is",
        .0.display()
    )]
    OtherDeltaTable(PathBuf),
    /// A case or a diagram that is simulated to measure the time fails.
    #[error("{what}: {reason}")]
    Sample {
        /// The case or the diagram.
        what: String,
        /// Why.
        reason: String,
    },
    /// A number beyond the shards of the sweep.
    #[error("there is no shard {index}: this sweep has shards 0 to {}", shards - 1)]
    NoShard {
        /// The number asked for.
        index: u64,
        /// Shards of the sweep, diagrams included.
        shards: u64,
    },
    /// Shards of a size that is not allowed.
    #[error(
        "{cases} cases in {shards} shards are {size} a shard, and {most} are the most: give more shards"
    )]
    LargeShards {
        /// Cases of the sweep.
        cases: u64,
        /// Shards asked for.
        shards: u64,
        /// Cases of each.
        size: u64,
        /// The most that are allowed.
        most: u64,
    },
    /// The output folder holds the dataset of another sweep.
    #[error(
        "`{}` holds a dataset of another sweep or version (plan {}, not {}): gen-dataset \
         --overwrite replaces it, or choose another folder", path.display(), short(found), short(expected)
    )]
    OtherPlan {
        /// The folder.
        path: PathBuf,
        /// Identifier of the plan that it was begun with.
        found: String,
        /// Identifier of this sweep's plan.
        expected: String,
    },
    /// The output folder holds a dataset that was begun with another calibration.
    #[error(
        "`{}` holds a dataset of another calibration (recordings, machine, settings or version \
         have changed): --overwrite replaces it, or choose another folder", .0.display()
    )]
    OtherCalibration(PathBuf),
    /// Datasets are not removed from object storage.
    #[error(
        "`{}` is in object storage, where nothing is replaced: remove it by the storage's own means, \
         or choose another prefix", .0.display()
    )]
    NoOverwrite(PathBuf),
    /// Calibrations are made in folders.
    #[error(
        "`{}` is in object storage, where no machine is calibrated: plan the sweep in a folder, and \
         then that folder's sweep.yaml in object storage", .0.display()
    )]
    NoCalibration(PathBuf),
    /// A folder that a sweep names as its calibration and that holds no calibration.
    #[error("`{}` is not the folder of a calibration: {reason}", path.display())]
    NotACalibration {
        /// The folder.
        path: PathBuf,
        /// What is missing, or cannot be read.
        reason: String,
    },
    /// The calibration of a dataset is damaged.
    #[error("{0}; --overwrite calibrates again")]
    DamagedCalibration(String),
    /// A calibration without intervals, from which a sweep is to draw.
    #[error(
        "calibrate.uncertainty: sampled draws from the intervals of the calibration, and {} states \
         none: its model is not adequate (model_is_adequate is false). Correct what the machine file \
         has wrong, or use uncertainty: ignored", .0.display()
    )]
    NoIntervals(PathBuf),
    /// A URL that has a password in it.
    #[error(
        "a URL of object storage cannot have a user or a password: give AWS_ACCESS_KEY_ID and \
         AWS_SECRET_ACCESS_KEY in the environment"
    )]
    Password,
    /// The program was built without object storage.
    #[error("`{}`: this program was built without object storage: build it with `--features s3`", .0.display())]
    NoObjectStorage(PathBuf),
    /// Another process writes to the output folder.
    #[error("`{}` is being written by another process ({by})", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
        /// What the other one says about itself.
        by: String,
    },
    /// The output folder cannot be made or written to.
    #[error("cannot write to `{}`: {source}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A file of the dataset could not be read or written.
    #[error(transparent)]
    File(#[from] recordings::Error),
    /// The record of the plan is damaged.
    #[error(
        "`{}` is damaged ({reason}): the same sweep, by `gen-dataset SWEEP.yaml --out {} --resume` or \
         `crosshead sweep plan`, writes it again; finished shards stay", path.display(), root.display()
    )]
    DamagedPlan {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// The dataset.
        root: PathBuf,
    },
    /// What says which calibration was copied to a bucket is damaged.
    #[error("`{}` is damaged ({reason}): remove it and plan the same sweep again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Two attempts at one shard or diagram gave different bytes.
    #[error(
        "{part} came out differently than before ({} and {}): the program or the machine \
         that it runs on is not the same",
        short(first),
        short(second)
    )]
    NotDeterministic {
        /// The shard or the diagram.
        part: String,
        /// Checksum of the earlier record.
        first: String,
        /// Checksum of the new one.
        second: String,
    },
    /// A dataset cannot be completed yet.
    #[error("{} of {shards} shards are missing: {}", missing.len(), ranges(missing))]
    Incomplete {
        /// Shards of the sweep, bifurcation diagrams included.
        shards: u64,
        /// Those that are missing; at least one.
        missing: Vec<u64>,
    },
    /// Files of a dataset are not those that were written.
    #[error(
        "{} files of `{}` are not as they were written; --resume, or `sweep shard` of its shard, makes \
         a file of data again, and `sweep finalize` writes the others again:{}",
        faults.len(), path.display(), lines(faults)
    )]
    Faults {
        /// The dataset.
        path: PathBuf,
        /// All of them; at least one.
        faults: Vec<Fault>,
    },
    /// A folder or bucket without the manifest of a dataset.
    #[error("`{}` holds no finished dataset: it has no manifest.json", .0.display())]
    NoManifest(PathBuf),
    /// The user stopped it after the cases.
    #[error(
        "stopped; all cases and {done} of {diagrams} bifurcation diagrams are finished, and \
         --resume continues from there"
    )]
    DiagramsCancelled {
        /// Finished diagrams.
        done: usize,
        /// Diagrams of the sweep.
        diagrams: usize,
    },
    /// The user stopped it.
    #[error("stopped; {done} of {shards} shards are finished, and --resume continues from there")]
    Cancelled {
        /// Finished shards.
        done: u64,
        /// Shards of the sweep.
        shards: u64,
    },
    /// The operating system gave no threads.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

impl Error {
    /// Whether the input or the arguments are at fault and nothing was written (exit status 2).
    pub fn is_input(&self) -> bool {
        matches!(
            self,
            Error::Input(_)
                | Error::Calibrate(_)
                | Error::TooManyCases { .. }
                | Error::Exists(_)
                | Error::NotOurs(_)
                | Error::OtherPlan { .. }
                | Error::NotPlanned(_)
                | Error::NotFinalized(_)
                | Error::NoManifest(_)
                | Error::OtherDeltaTable(_)
                | Error::NoOverwrite(_)
                | Error::NoCalibration(_)
                | Error::NotACalibration { .. }
                | Error::Password
                | Error::NoObjectStorage(_)
                | Error::NoShard { .. }
                | Error::LargeShards { .. }
                | Error::OtherCalibration(_)
                | Error::InUse { .. }
                | Error::Unwritable { .. }
        )
    }
}

/// A line for each.
fn lines(faults: &[Fault]) -> String {
    faults.iter().map(|fault| format!("\n  {fault}")).collect()
}

/// The start of a checksum, as people compare it.
fn short(checksum: &str) -> &str {
    checksum.get(..12).unwrap_or(checksum)
}
