//! The features of recordings in memory, as a dataset has them.

use crate::in_order::in_order;
use crate::reader::{Like, Unlike};
use features::recorded::{Input, Row, Said, Table as Columns, WindowLength, row};
use recordings::{Kind, Schema, Table};
use std::path::PathBuf;

/// What ends the reading of recordings.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A recording that cannot be used.
    #[error(transparent)]
    Recording(#[from] features::recorded::Error),
    /// Recordings that do not go with the dataset.
    #[error(transparent)]
    Unlike(#[from] Unlike),
    /// A row that is not one of the table.
    #[error(transparent)]
    Row(#[from] recordings::Error),
    /// The folder of a table that cannot be made.
    #[error("{}: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(recordings::Error),
    /// The caller asked for it.
    #[error("interrupted; nothing was written")]
    Stopped,
}

impl Error {
    /// Whether the recordings or the arguments are wrong, or the table has no place; else the work failed.
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Folder { .. } | Self::Write(_) | Self::Stopped)
    }
}

/// A row for each window of some recordings.
#[derive(Debug)]
pub struct RecordedTable {
    /// The rows: file, window, start and what the files say of them, then the features.
    pub rows: Table,
    /// What looks wrong with windows.
    pub warnings: Vec<String>,
}

/// Computes the features of all windows of `inputs`, in order, on the threads of `pool`. With `like` these are the features of
/// that dataset, from windows as it has them. `go_on` is asked before each row.
///
/// # Errors
/// [`Error`].
pub fn recorded_table(
    inputs: &[Input],
    said: &Said,
    length: WindowLength,
    like: Option<&Like>,
    pool: &rayon::ThreadPool,
    go_on: impl FnMut() -> bool,
) -> Result<RecordedTable, Error> {
    let columns = Columns::new(inputs, said)?;
    let kept = kept(columns.schema(), like)?;
    let mut rows = Table::new(columns.schema().select(&kept));
    let mut warnings = Vec::new();
    each_row(columns, length, like, &kept, pool, go_on, |row| {
        warnings.extend(row.warning());
        rows.push(row.values).map_err(Error::Row)
    })?;
    Ok(RecordedTable { rows, warnings })
}

/// The columns that stay: all of them, or those of the dataset.
pub(crate) fn kept(schema: &Schema, like: Option<&Like>) -> Result<Vec<usize>, Unlike> {
    match like {
        Some(like) => like.columns(schema),
        None => Ok((0..schema.columns().len()).collect()),
    }
}

/// Hands the columns `kept` of the row of each window on, in order; gives the time that was too short for a window, s.
pub(crate) fn each_row(
    columns: Columns,
    length: WindowLength,
    like: Option<&Like>,
    kept: &[usize],
    pool: &rayon::ThreadPool,
    mut go_on: impl FnMut() -> bool,
    mut take: impl FnMut(Row) -> Result<(), Error>,
) -> Result<f64, Error> {
    let mut windows = columns.windows(length);
    in_order(
        pool,
        2 * pool.current_num_threads(),
        &mut windows,
        |window| window.as_ref().ok().map(row),
        |window, made| {
            window?;
            if !go_on() {
                return Err(Error::Stopped);
            }
            let Some(mut made) = made else { return Ok(()) };
            if let Some(like) = like {
                like.check(&made)?;
                made.keep(kept);
            }
            take(made)
        },
    )?;
    Ok(windows.left_out_s())
}

impl RecordedTable {
    /// A name for the recording of each row. Windows that follow each other in one file are of one recording; a dataset's rows
    /// have a column `group`.
    ///
    /// # Errors
    /// A table without the columns of all tables of recordings.
    pub fn recordings(&self) -> Result<Vec<String>, recordings::Error> {
        let schema = self.rows.schema().columns();
        if schema
            .iter()
            .any(|column| column.name == "group" && column.kind == Kind::Text)
        {
            let groups = self.rows.values::<String>("group")?.iter();
            return Ok(groups
                .map(|group| group.clone().unwrap_or_default())
                .collect());
        }
        let (files, starts) = (
            self.rows.values::<String>("file")?,
            self.rows.values::<f64>("start_s")?,
        );
        let mut number = 0;
        let mut before: Option<(&Option<String>, f64)> = None;
        let rows = files.iter().zip(starts).map(|(file, start)| {
            let start = start.unwrap_or(0.0);
            let goes_on = before.is_some_and(|(of, begin)| of == file && begin < start);
            number += usize::from(!goes_on);
            before = Some((file, start));
            number.to_string()
        });
        Ok(rows.collect())
    }
}
