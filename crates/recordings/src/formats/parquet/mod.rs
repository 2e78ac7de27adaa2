//! Parquet: the format of datasets, and of measured recordings.
//!
//! Recordings are lists of float32. Their bytes are split into four streams (`BYTE_STREAM_SPLIT`)
//! before zstd: the exponents of neighbouring samples are alike, the last digits are noise.
//! Units and descriptions stand twice in a file. They stand with each Arrow field (`unit`, `description`) and,
//! for readers that show the file's own keys only, as JSON objects under `units` and
//! `descriptions`. pandas finds the units in `DataFrame.attrs`.

mod batches;
mod pages;
mod read;
mod recordings;
mod widened;
mod write;

pub use batches::Batches;
pub use read::{ParquetFile, read_table, rows_of_footer};
pub use write::{PENDING_ROWS, TableWriter, write_table};

use super::recording_format::{RecordingFormat, has};

/// Parquet as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "Parquet",
    endings: &["parquet"],
    signature_at: Some(0),
    recognise: |head| has(head, 0, b"PAR1").then_some("a Parquet file"),
    open: recordings::open,
};

/// Rows of a group in a table of samples.
pub const ROWS_PER_GROUP: usize = 65_536;

#[cfg(test)]
mod tests;
