//! The features of recordings as a file.

use crate::reader::Like;
use crate::recorded_table::{Error, each_row, kept};
use features::recorded::{Input, Said, Summary, Table, WindowLength, counted};
use recordings::WholeFile;
use recordings::formats::table_file::{TableFile, TableFormat};
use recordings::measured::LONGEST_BRIDGED;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::path::Path;

/// What was written; as text a summary of it.
#[derive(Debug, Serialize)]
pub struct Written<'a> {
    /// The table.
    pub table: &'a Path,
    /// Its rows.
    pub windows: u64,
    /// Its columns.
    pub columns: usize,
    /// The files that were read.
    pub files: usize,
    /// Why columns are empty, a line per reason.
    pub empty: Vec<String>,
    /// What looks wrong, a line each.
    pub warnings: Vec<String>,
    /// Missing samples that were bridged by lines.
    pub bridged_samples: usize,
    /// Time that was too short for a window, s.
    pub left_out_s: f64,
}

/// Computes the features of all windows of `inputs` on the threads of `pool`, and writes them to the file `out`, which
/// appears whole or not at all. With `like` these are the features of that dataset, from windows as it has them. `go_on` is
/// asked before each row.
///
/// # Errors
/// [`Error`].
pub fn write<'a>(
    inputs: &[Input],
    said: &Said,
    length: WindowLength,
    like: Option<&Like>,
    (out, format): (&'a Path, TableFormat),
    pool: &rayon::ThreadPool,
    go_on: impl FnMut() -> bool,
) -> Result<Written<'a>, Error> {
    let table = Table::new(inputs, said)?;
    let note = table.without_unit().map(|(file, channels)| {
        let channels = channels.join(", ");
        format!(
            "note: {file}: no unit of {channels}: statistics alone; --unit 'm/s^2' gives the rest"
        )
    });
    let kept = kept(table.schema(), like)?;
    let schema = table.schema().select(&kept);
    let folder = out.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).map_err(|error| Error::Folder {
        path: folder.to_owned(),
        error,
    })?;
    let file = WholeFile::create(&out.with_extension("part"), out).map_err(Error::Row)?;
    let mut output = TableFile::new(file, format, &schema).map_err(Error::Write)?;
    let mut summary = Summary::new(kept.len());
    let left_out_s = each_row(table, length, like, &kept, pool, go_on, |mut row| {
        summary.add(&mut row);
        output.write(row.values).map_err(Error::Write)
    })?;
    output.commit().map_err(Error::Write)?;
    Ok(Written {
        table: out,
        windows: summary.rows(),
        columns: kept.len(),
        files: inputs.len(),
        empty: summary.empty(&schema),
        warnings: note.into_iter().chain(summary.warnings()).collect(),
        bridged_samples: summary.bridged(),
        left_out_s,
    })
}

impl Display for Written<'_> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(
            f,
            "{}: {}, {}, {}",
            self.table.display(),
            counted(self.windows, "window"),
            counted(self.columns as u64, "column"),
            counted(self.files as u64, "file"),
        )?;
        (self.empty.iter()).try_for_each(|line| writeln!(f, "{line}"))?;
        if self.bridged_samples > 0 {
            let samples = counted(self.bridged_samples as u64, "missing sample");
            writeln!(
                f,
                "  {samples} bridged by lines (gaps of up to {LONGEST_BRIDGED})"
            )?;
        }
        match self.left_out_s > 0.0 {
            true => writeln!(
                f,
                "  {:.3} s were too short for a window and are left out",
                self.left_out_s
            ),
            false => Ok(()),
        }
    }
}
