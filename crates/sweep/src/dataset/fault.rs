//! What can be wrong with a file of a dataset.

use serde::Serialize;
use std::fmt::{self, Display};

/// A damaged file of a dataset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// The file, within the dataset.
    pub path: String,
    /// What is wrong with it.
    pub damage: Damage,
}

impl Fault {
    pub(super) fn new(path: &str, damage: Damage) -> Self {
        Self {
            path: path.to_owned(),
            damage,
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // A name from a manifest may hold anything.
        write!(f, "{}: {}", self.path.escape_debug(), self.damage)
    }
}

/// What is wrong with a file of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum Damage {
    /// It is not there.
    #[error("is missing")]
    Missing,
    /// It is shorter or longer.
    #[error("has {found} bytes instead of {expected}")]
    Length {
        /// Its length in bytes.
        found: u64,
        /// The length that was written.
        expected: u64,
    },
    /// Its content is not what was written.
    #[error("has another checksum than when it was written")]
    Content,
    /// A table with other rows than the manifest says.
    #[error("has {found} rows instead of {expected}")]
    Rows {
        /// Its rows.
        found: u64,
        /// The rows that the manifest says.
        expected: u64,
    },
    /// A table whose footer cannot be read.
    #[error("is no Parquet file")]
    Table,
    /// No record has it.
    #[error("is in no record of this dataset, and readers of its folder read it too")]
    Extra,
    /// `SHA256SUMS` is not that of the manifest: one of them was changed.
    #[error("does not agree with manifest.json: one of the two was changed")]
    Sums,
    /// The counts of the manifest contradict its files or failures.
    #[error("its counts are not those of its files and failures")]
    Counts,
    /// The manifest has a file twice.
    #[error("has a file twice")]
    Twice,
    /// The manifest names a file outside of the dataset.
    #[error("lies outside of the dataset and is not read")]
    Outside,
}
