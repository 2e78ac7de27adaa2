//! Errors of a bench.

use std::io;
use std::path::{Path, PathBuf};

/// Why a bench stops.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A machine that cannot be used.
    #[error(transparent)]
    Input(#[from] input::Error),
    /// A machine without contact parameters.
    #[error(transparent)]
    Contact(calibrate::Error),
    /// A file of cases that cannot be read, or a line of it that is no case.
    #[error("{0}")]
    Cases(String),
    /// A machine to which a true value cannot be given.
    #[error(transparent)]
    Truth(#[from] calibrate::Error),
    /// The user has stopped it.
    #[error("stopped: {done} of {count} cases are done; --resume continues from there")]
    Stopped {
        /// Cases that were made before.
        done: usize,
        /// Cases that were to be made.
        count: usize,
    },
    /// A file of recordings or results that cannot be written.
    #[error(transparent)]
    Write(#[from] recordings::Error),
    /// Results that are no JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A file or folder that cannot be written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl Error {
    /// A file or folder that cannot be written.
    pub(crate) fn file(path: &Path, source: io::Error) -> Self {
        Self::File {
            path: path.to_owned(),
            source,
        }
    }

    /// Whether the input is wrong, and not the work.
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Input(_) | Self::Contact(_) | Self::Cases(_))
    }
}
