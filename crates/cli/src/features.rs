//! `crosshead features`: measured recordings become a table of features.

use crate::output::{hint, make_folder_of};
use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::ResultFormat;
use crate::{Failure, console, interrupt};
use ::features::recorded::{Input, Summary, Table, counted, inputs, row};
use clap::Args;
use recordings::WholeFile;
use recordings::formats::table_file::{TableFile, TableFormat};
use recordings::measured::LONGEST_BRIDGED;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use sweep::in_order::in_order;
use sweep::reader::Like;

/// Arguments of `crosshead features`.
#[derive(Args, Debug)]
#[command(after_help = "\
FILE is CSV, WAV, MAT (version 5 to 7), Parquet or MCAP, a bundle (a folder with recordings.yaml),
a dataset of gen-dataset or a folder of crosshead simulate. The sample rate is read from a column
of time (t, t_s, time), units from the columns' names: acc_m_s2, 'acc [m/s^2]', 'pressure (bar)'.
The recordings.yaml in the folder of a file says what its channels are: crank angle, tacho,
accelerations and pressures with their units.

The crank angle is the column crank_angle_rad or crank_angle_deg, which counts from top dead
centre, or the one of --crank-angle or --tacho. Without a unit there are statistics alone; without
a speed, a crank angle or a tacho nothing per order or revolution; without top dead centre no
sectors of the crank angle. The column `missing` has the reason for a null value, `warnings` lists
what looks wrong.

Indicated power and mean pressure of a cylinder pressure need the crank angle from top dead centre,
and bore, stroke and rod: the machine section of a bundle, or --machine.

Gaps of up to 4 samples without a number are bridged by straight lines; a longer gap ends a window.

Examples:
  crosshead features bearing.wav --unit '50 m/s^2' --speed '1480 rpm' --out bearing.parquet
  crosshead features log.csv --column 'acc [g]' --window '10 revolutions' --speed '500 rpm' \\
      --out log.parquet
  crosshead features log.csv --tacho keyphasor --top-dead-centre '30 deg' --out log-features.csv
  crosshead features indicated.csv --machine machine.yaml --out indicated.parquet
  crosshead features datasets/paper2 my-bundle/ --out features.parquet
  crosshead features measured/ --like datasets/bearing-faults --out measured.parquet

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 interrupted.")]
pub struct Arguments {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    /// Compute the features of this dataset, from windows of its length; recordings of another sample rate, length or of
    /// other channels are refused
    #[arg(long, value_name = "DATASET", conflicts_with_all = ["window", "chaos"])]
    like: Option<PathBuf>,
    /// The table to write, .parquet or .csv; one that is there is replaced
    #[arg(long, value_name = "FILE.parquet")]
    out: PathBuf,
    #[command(flatten)]
    format: ResultFormat,
}

/// What was written.
#[derive(Serialize)]
struct Written<'a> {
    /// The table.
    table: &'a Path,
    windows: u64,
    columns: usize,
    files: usize,
    /// Why columns are empty, a line per reason.
    empty: Vec<String>,
    warnings: Vec<String>,
    bridged_samples: usize,
    /// Time that was too short for a window, s.
    left_out_s: f64,
}

impl Written<'_> {
    fn print(&self) {
        println!(
            "{}: {}, {}, {}",
            self.table.display(),
            counted(self.windows, "window"),
            counted(self.columns as u64, "column"),
            counted(self.files as u64, "file"),
        );
        for line in &self.empty {
            println!("{line}");
        }
        if self.bridged_samples > 0 {
            println!(
                "  {} bridged by lines (gaps of up to {LONGEST_BRIDGED})",
                counted(self.bridged_samples as u64, "missing sample")
            );
        }
        if self.left_out_s > 0.0 {
            println!(
                "  {:.3} s were too short for a window and are left out",
                self.left_out_s
            );
        }
    }
}

/// Computes the features and writes them.
///
/// # Errors
/// Wrong arguments, a file that cannot be read (nothing is then written), or a table that cannot
/// be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let format = format(out)?;
    let (mut said, mut length) = (arguments.reading.said()?, arguments.reading.window()?);
    let like = arguments.like.as_deref().map(Like::read);
    let like = like.transpose().map_err(Failure::input)?;
    if let Some(like) = &like {
        length = like.length();
        like.say(&mut said);
    }
    let inputs = inputs(&arguments.files, &said).map_err(Failure::input)?;
    refuse_input_as_output(&inputs, out)?;
    let table = Table::new(&inputs, &said).map_err(Failure::input)?;
    let note = table.without_unit().map(|(file, channels)| {
        let channels = channels.join(", ");
        format!(
            "note: {file}: no unit of {channels}: statistics alone; --unit 'm/s^2' gives the rest"
        )
    });
    let kept = like.as_ref().map(|like| like.columns(table.schema()));
    let kept = kept.transpose().map_err(Failure::input)?;
    let schema = match &kept {
        Some(kept) => table.schema().select(kept),
        None => table.schema().clone(),
    };
    let columns = schema.columns().len();

    make_folder_of(out)?;
    let file = WholeFile::create(&out.with_extension("part"), out).map_err(Failure::input)?;
    let mut output = TableFile::new(file, format, &schema).map_err(Failure::work)?;
    let mut summary = Summary::new(columns);
    let cancel = interrupt::flag()?;
    let pool = console::pool()?;
    let mut windows = table.windows(length);
    let progress = Progress::new(
        "windows",
        None,
        "{spinner} {pos} windows  {per_sec}  {elapsed}",
    );
    in_order(
        &pool,
        2 * console::threads(),
        &mut windows,
        |window| window.as_ref().ok().map(row),
        |window, row| {
            window.map_err(Failure::input)?;
            if cancel.load(Ordering::Relaxed) {
                return Err(Failure::interrupted("interrupted; nothing was written"));
            }
            progress.add(1);
            let Some(mut row) = row else { return Ok(()) };
            if let (Some(like), Some(kept)) = (&like, &kept) {
                like.check(&row).map_err(Failure::input)?;
                row.keep(kept);
            }
            summary.add(&mut row);
            output.write(row.values).map_err(Failure::work)
        },
    )?;
    drop(progress);
    output.commit().map_err(Failure::work)?;
    let warnings: Vec<String> = note.into_iter().chain(summary.warnings()).collect();
    warnings.iter().for_each(|line| eprintln!("{line}"));
    let written = Written {
        table: out,
        windows: summary.rows(),
        columns,
        files: inputs.len(),
        empty: summary.empty(&schema),
        warnings,
        bridged_samples: summary.bridged(),
        left_out_s: windows.left_out_s(),
    };
    arguments.format.print(&written, Written::print)?;
    if format == TableFormat::Parquet {
        hint(format_args!(
            "python3 -c 'import pandas; print(pandas.read_parquet(\"{}\").T)'",
            out.display()
        ));
    }
    Ok(())
}

/// The format of the table `out`.
fn format(out: &Path) -> Result<TableFormat, Failure> {
    let shown = out.display();
    if out.is_dir() {
        return Err(Failure::input(format!(
            "--out: {shown} is a folder, expected a file, e.g. features.parquet"
        )));
    }
    TableFormat::from_path(out).ok_or_else(|| {
        Failure::input(format!(
            "--out: found {shown}, expected a name that ends in .parquet or .csv"
        ))
    })
}

fn refuse_input_as_output(inputs: &[Input], out: &Path) -> Result<(), Failure> {
    let canonical = out.canonicalize().ok();
    let same = |input: &&Input| canonical.is_some() && input.path.canonicalize().ok() == canonical;
    match inputs.iter().find(same) {
        None => Ok(()),
        Some(input) => Err(Failure::input(format!(
            "--out: {} is one of the recordings",
            input.path.display()
        ))),
    }
}
