//! What can go wrong in reading a dataset.

use crate::dataset::Damage;
use std::path::PathBuf;

/// What can go wrong in reading a dataset.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is nothing at the place.
    #[error("{}: no such folder", .0.display())]
    NoFolder(PathBuf),
    /// The dataset has no manifest yet.
    #[error(
        "{folder}: the dataset is not finished (no manifest.json): gen-dataset SWEEP.yaml --out {folder} --resume finishes it",
        folder = .0.display()
    )]
    NotFinished(PathBuf),
    /// The folder is no dataset.
    #[error("{}: no dataset (no manifest.json)", .0.display())]
    NoDataset(PathBuf),
    /// The manifest or a table cannot be read.
    #[error(transparent)]
    File(recordings::Error),
    /// The sweep cannot be read.
    #[error(transparent)]
    Sweep(#[from] input::Error),
    /// A table is not the one that was written.
    #[error("{} {damage}: `crosshead verify` names all such files", path.display())]
    Damaged {
        /// The table.
        path: PathBuf,
        /// What is wrong with it.
        damage: Damage,
    },
    /// A table could not be compared with its checksum.
    #[error(transparent)]
    Compare(#[from] Box<crate::Error>),
    /// A table lacks a column.
    #[error("{}: no column `{name}`, which every dataset of this sweep has", path.display())]
    NoColumn {
        /// The table.
        path: PathBuf,
        /// The column.
        name: String,
    },
    /// A column of a table has another type.
    #[error("{}: {error}", path.display())]
    ColumnKind {
        /// The table.
        path: PathBuf,
        /// Which column, and the types.
        error: recordings::Error,
    },
    /// A row of the signals is of another case than that of the features.
    #[error(
        "{place} is of {of}, that of the features of {features_of}: they are not of one dataset"
    )]
    OtherCase {
        /// The table of signals and the row.
        place: String,
        /// The case of its row.
        of: String,
        /// The case of the row of features.
        features_of: String,
    },
}

impl Error {
    /// That the table at `path` cannot be read.
    pub(super) fn of_table(path: PathBuf, error: recordings::Error) -> Self {
        match error {
            recordings::Error::NoColumn { name, .. } => Self::NoColumn { path, name },
            recordings::Error::ColumnKind { .. } => Self::ColumnKind { path, error },
            other => Self::File(other),
        }
    }

    /// Whether the dataset is wrong; else the work failed.
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Compare(_))
    }
}
