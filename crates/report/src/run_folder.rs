//! The files of one run: its signals, its numbers and its pictures.

use crate::case_picture::CasePicture;
use crate::run_figures::{FIGURES, RunFigures};
use crate::summary::{rpm, too_deep};
use crate::{Error, write_page};
use recordings::WholeFile;
use recordings::formats::parquet::ROWS_PER_GROUP;
use recordings::formats::table_file::TableFormat;
use recordings::formats::{csv, parquet};
use std::path::{Path, PathBuf};
use sweep::run::Run;
use sweep::run_analysis::{RunAnalysis, RunSummary};
use sweep::run_table::run_table;

/// Where a run is written to.
#[derive(Clone, Debug)]
pub struct RunFolder {
    /// The signals over time.
    pub signals: PathBuf,
    /// The motion in the joints.
    pub picture: PathBuf,
    /// The numbers of the analysis.
    pub summary: PathBuf,
    /// The figures of the analysis.
    pub figures: [PathBuf; FIGURES.len()],
}

impl RunFolder {
    /// In `folder`. The name of the file of `signals` ends as that of a format of tables.
    pub fn new(folder: &Path, signals: &str) -> Self {
        Self {
            signals: folder.join(signals),
            picture: folder.join("picture.svg"),
            summary: folder.join("summary.json"),
            figures: FIGURES.map(|name| folder.join(name)),
        }
    }

    /// All files.
    pub fn files(&self) -> Vec<&Path> {
        let first = [&self.signals, &self.picture, &self.summary];
        let all = first.into_iter().chain(&self.figures);
        all.map(PathBuf::as_path).collect()
    }

    /// Writes the signals, with the motion itself where that is asked for, and the picture, which is empty where the
    /// machine has no throw. Each file appears whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_signals(&self, run: &Run, with_motion: bool) -> Result<(), Error> {
        let trace = run.record.trace.as_ref();
        let throws = run.machine.machine.throw_names();
        let moved = trace.filter(|_| with_motion);
        let table = run_table(&run.record, &run.channels, moved, &throws);
        let table = table.map_err(Error::Write)?;
        let file = WholeFile::create(&self.signals.with_extension("part"), &self.signals);
        let written = file.and_then(|file| match TableFormat::from_path(&self.signals) {
            Some(TableFormat::Csv) => csv::write_table(file, &table),
            _ => parquet::write_table(file, &table, ROWS_PER_GROUP),
        });
        written.and_then(WholeFile::commit).map_err(Error::Write)?;
        let deep = too_deep(&run.record).map(|joint| {
            let times = joint.deepest / joint.clearance;
            let joint = &joint.joint;
            format!(" · {joint} penetrates by {times:.2} times its clearance")
        });
        let title = title(run) + &deep.collect::<String>();
        let picture = trace.and_then(|trace| CasePicture::new(&title, trace));
        let picture = picture.map_or(String::new(), |picture| picture.svg());
        write_page(&self.picture, &picture)
    }

    /// Writes what the user of a machine looks at first, numbers and figures, and gives the numbers back.
    ///
    /// # Errors
    /// [`Error::Analysis`] for a run that cannot be analysed, as one of less than a revolution; a file that cannot be written.
    pub fn write_analysis(&self, run: &Run) -> Result<RunSummary, Error> {
        let analysis = RunAnalysis::new(&run.machine.machine, &run.record, &run.channels)?;
        let numbers = analysis.summary(&run.machine.name, run.record.mean_speed);
        let text = serde_json::to_string_pretty(&numbers);
        let text = text.map_err(|error| Error::Write(recordings::Error::Write(error.into())))?;
        write_page(&self.summary, &text)?;
        let trace = run.record.trace.iter();
        let angles = trace.flat_map(|trace| trace.crank_angle.iter().step_by(trace.stride.max(1)));
        let figures = RunFigures {
            title: &title(run),
            analysis: &analysis,
            crank_angle_rad: &angles.copied().collect::<Vec<_>>(),
            channels: &run.channels,
        };
        let mut made = figures.files().into_iter().zip(&self.figures);
        made.try_for_each(|(figure, file)| write_page(file, &figure.svg))?;
        Ok(numbers)
    }
}

/// The machine and its operating point.
fn title(run: &Run) -> String {
    format!("{}, {}", run.machine.name, rpm(run.machine.speed))
}
