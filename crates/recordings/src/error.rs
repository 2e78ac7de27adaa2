//! What can go wrong with a table or its file.

use crate::Kind;
use std::error::Error as StdError;
use std::io;
use std::path::{Path, PathBuf};

/// What can go wrong with a table or its file.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The operating system refused; `source` says why (a full disk, no permission, ...).
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried: `create`, `write`, `rename`, ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// The writer below a format refused the bytes; `0` names the file where it is one.
    #[error("{0}")]
    Write(io::Error),
    /// A format could not encode what it was given.
    #[error("cannot write {format}: {source}")]
    Encode {
        /// Name of the format.
        format: &'static str,
        /// The reason.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// The file is damaged, or is not of the format that it is read as.
    #[error("cannot read `{}` as {format}: {reason}", path.display())]
    Damaged {
        /// Name of the format.
        format: &'static str,
        /// The file.
        path: PathBuf,
        /// What the decoder found.
        reason: String,
    },
    /// A column of time that determines no rate, or contradicts the stated one.
    #[error("`{}`, column `{column}`: {reason}", path.display())]
    Time {
        /// The file.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// What is wrong with the times.
        reason: String,
    },
    /// A sample rate that is not the one in the file.
    #[error("`{}` has samples at {file_hz} Hz, but the sample rate is said to be {stated_hz} Hz", path.display())]
    RateContradicts {
        /// The file.
        path: PathBuf,
        /// What the file says, Hz.
        file_hz: f64,
        /// What was said, Hz.
        stated_hz: f64,
    },
    /// A temporary file that readers of the folder would take for data.
    #[error("temporary file `{}` must end in `.part`, or readers take it for data", .0.display())]
    TemporaryName(PathBuf),
    /// Two columns of one name.
    #[error("two columns are called `{0}`")]
    DuplicateColumn(String),
    /// A column without a name.
    #[error("column {0} has no name")]
    NamelessColumn(usize),
    /// Nothing to read.
    #[error("no file to read")]
    NoFiles,
    /// A row of the wrong length.
    #[error("row {row} has {found} values where the table has {expected} columns")]
    RowLength {
        /// Index of the row, from 0.
        row: usize,
        /// Values in the row.
        found: usize,
        /// Columns in the table.
        expected: usize,
    },
    /// A value of the wrong kind.
    #[error("row {row}, column `{column}`: found {found}, expected {expected}")]
    ValueKind {
        /// Index of the row, from 0.
        row: usize,
        /// Name of the column.
        column: String,
        /// What the row holds there.
        found: Kind,
        /// What the column holds.
        expected: Kind,
    },
    /// A missing value in a column that must be complete.
    #[error("row {row}, column `{column}`: the value is missing, and the column is not optional")]
    MissingValue {
        /// Index of the row, from 0.
        row: usize,
        /// Name of the column.
        column: String,
    },
    /// A recording too long for one row.
    #[error("row {row}, column `{column}`: {samples} samples, more than the {most} of one row")]
    TooManySamples {
        /// Index of the row, from 0.
        row: usize,
        /// Name of the column.
        column: String,
        /// Samples in the row.
        samples: usize,
        /// The most that a row can hold.
        most: usize,
    },
    /// Columns of one table that differ in length.
    #[error("column `{column}` has {found} rows where the first column has {expected}")]
    ColumnLength {
        /// Name of the column.
        column: String,
        /// Its rows.
        found: usize,
        /// Rows of the first column.
        expected: usize,
    },
    /// Another number of data columns than the schema has.
    #[error("{found} columns of data for a schema of {expected}")]
    ColumnCount {
        /// Columns of data.
        found: usize,
        /// Columns of the schema.
        expected: usize,
    },
    /// No column of that name.
    #[error("no column `{name}`; there are: {}", among.join(", "))]
    NoColumn {
        /// The name asked for.
        name: String,
        /// The names that there are.
        among: Vec<String>,
    },
    /// A column of another kind than asked for.
    #[error("column `{column}` holds {found}, not {expected}")]
    ColumnKind {
        /// Name of the column.
        column: String,
        /// What it holds.
        found: Kind,
        /// What was asked for.
        expected: Kind,
    },
    /// A column of a type that tables do not have.
    #[error("column `{column}` of `{}` has type {found}, which is none of text, whole numbers, real numbers, flags and lists of float32", path.display())]
    ColumnType {
        /// The file.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// Its Arrow type.
        found: String,
    },
    /// Rows outside the file.
    #[error("rows {start} to {end} of `{}`, which has {rows}", path.display())]
    NoSuchRows {
        /// The file.
        path: PathBuf,
        /// First row asked for.
        start: usize,
        /// One past the last.
        end: usize,
        /// Rows of the file.
        rows: usize,
    },
    /// A column that a plain text file cannot hold.
    #[error("column `{0}` holds recordings, which have no place in CSV: write Parquet")]
    NotPlain(String),
    /// A row group of no rows.
    #[error("a row group must have at least one row")]
    EmptyRowGroup,
    /// A channel whose name cannot be a field of a message.
    #[error(
        "channel `{0}` cannot be a field of a message: use letters, digits and single `_`, starting with a letter"
    )]
    FieldName(String),
    /// Two channels with the same field in a message.
    #[error("two channels are the field `{0}` of the message")]
    DuplicateField(String),
    /// Channels of one recording that differ in length.
    #[error("channel `{channel}` has {found} samples where the first channel has {expected}")]
    ChannelLength {
        /// Name of the channel.
        channel: String,
        /// Its samples.
        found: usize,
        /// Samples of the first channel.
        expected: usize,
    },
    /// A rate that is not a positive number.
    #[error("sample rate is {0} Hz and must be positive and finite")]
    SampleRate(f64),
}

impl Error {
    /// Whether the disk, or the user's share of it, is full.
    pub fn is_storage_full(&self) -> bool {
        let kind = match self {
            Self::Io { source, .. } | Self::Write(source) => source.kind(),
            _ => return false,
        };
        matches!(
            kind,
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded
        )
    }

    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io {
            action,
            path,
            source,
        }
    }

    pub(crate) fn damaged(format: &'static str, path: &Path, reason: impl ToString) -> Self {
        Self::Damaged {
            format,
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }

    pub(crate) fn time(path: &Path, column: &str, reason: String) -> Self {
        Self::Time {
            path: path.to_owned(),
            column: column.to_owned(),
            reason,
        }
    }

    /// The error of an encoder: the writer's own, where that is what lies beneath.
    pub(crate) fn encode(
        format: &'static str,
        source: impl StdError + Send + Sync + 'static,
    ) -> Self {
        let mut cause: Option<&(dyn StdError + 'static)> = Some(&source);
        while let Some(error) = cause {
            if let Some(io) = error.downcast_ref::<io::Error>() {
                return Self::Write(io::Error::new(io.kind(), io.to_string()));
            }
            cause = error.source();
        }
        Self::Encode {
            format,
            source: Box::new(source),
        }
    }
}
