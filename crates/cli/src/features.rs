//! `crosshead features`: measured recordings become a table of features.

use crate::output::{hint, refuse_folder};
use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::ResultFormat;
use crate::{Failure, console, interrupt};
use ::features::recorded::{Input, inputs};
use clap::Args;
use recordings::formats::table_file::TableFormat;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use sweep::feature_file::write;
use sweep::reader::Like;

#[derive(Args, Debug)]
#[command(after_help = "\
FILE is CSV, WAV, MAT, HDF5, Parquet or MCAP, a bundle (a folder with recordings.yaml),
a dataset of gen-dataset or a folder of crosshead simulate. The sample rate is read from a column
of time (t_s, time_ms), units from the columns' names: acc_m_s2, 'acc [m/s^2]', 'pressure (bar)'.
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let format = format(out)?;
    let (mut said, mut length) = (arguments.reading.said()?, arguments.reading.window()?);
    let like = arguments.like.as_deref().map(Like::read);
    let like = like.transpose().map_err(Failure::input)?;
    if let Some(like) = &like {
        length = like.length();
        like.say(&mut said);
    }
    let inputs = inputs(&arguments.files, &said)?;
    refuse_input_as_output(&inputs, out)?;
    let (pool, cancel) = (console::pool()?, interrupt::flag()?);
    let progress = Progress::of_windows();
    let go_on = || {
        progress.bar.inc(1);
        !cancel.load(Ordering::Relaxed)
    };
    let table = (out.as_path(), format);
    let written = write(&inputs, &said, length, like.as_ref(), table, &pool, go_on)?;
    drop(progress);
    written.warnings.iter().for_each(|line| eprintln!("{line}"));
    arguments.format.print(&written, &written)?;
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
    refuse_folder(out)?;
    let shown = out.display();
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
