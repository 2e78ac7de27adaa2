//! What can go wrong between a dataset and the engine that makes its shards.

use super::slurm::ROUNDS;
use crate::ranges::ranges;
use std::io;
use std::path::PathBuf;

/// What can go wrong between a dataset and the engine that makes its shards.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No engine says which shard to make.
    #[error("no shard is named: expected --index K, or one of {0} with a number")]
    NoIndex(String),
    /// A bucket holds neither scripts nor logs.
    #[error(
        "{}: scripts and logs of the jobs need a folder that all machines see: give --scripts DIR",
        .0.display()
    )]
    NoScripts(PathBuf),
    /// A job that was submitted is not over.
    #[error("job {0} of this dataset is still there: `crosshead sweep cancel` takes it back")]
    UnderWay(String),
    /// There is no record of jobs.
    #[error("nothing was submitted from here ({}: {reason})", path.display())]
    NotSubmitted {
        /// The record.
        path: PathBuf,
        /// Why it cannot be read.
        reason: String,
    },
    /// A path that a script of the shell cannot carry.
    #[error("{}: a path in a job's script must be text in UTF-8", .0.display())]
    Path(PathBuf),
    /// Shards that are missing after all rounds.
    #[error("submitted {ROUNDS} times, and no more; still missing: {}", ranges(.0))]
    Missing(Vec<u64>),
    /// The folder of the scripts cannot be made.
    #[error("{}: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why not.
        error: io::Error,
    },
    /// A script or a record cannot be written.
    #[error(transparent)]
    Write(#[from] recordings::Error),
    /// The system does not say where this program or the working directory is.
    #[error(transparent)]
    System(#[from] io::Error),
    /// A program of the engine cannot be run.
    #[error("cannot run {program}: {error}")]
    Run {
        /// The program.
        program: &'static str,
        /// Why not.
        error: io::Error,
    },
    /// A program of the engine refuses, or answers something else than expected.
    #[error("{program}: {message}")]
    Refused {
        /// The program.
        program: &'static str,
        /// What it says.
        message: String,
    },
}

impl Error {
    /// Whether the input or the arguments are wrong; else the work failed.
    pub fn is_input(&self) -> bool {
        matches!(
            self,
            Self::NoIndex(_)
                | Self::NoScripts(_)
                | Self::UnderWay(_)
                | Self::NotSubmitted { .. }
                | Self::Path(_)
        )
    }
}
