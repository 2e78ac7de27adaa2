//! `crosshead features`: measured recordings become a table of features.

mod inputs;
mod output;
mod shaft;
mod summary;
mod table;
mod units;
mod warnings;
mod window;

use crate::bundle::AllowOutside;
use crate::{Failure, interrupt};
use ::features::FEWEST_SAMPLES;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use input::quantity::{AboveZero, Frequency, Quantity, Speed};
use inputs::{Input, Said};
use output::{Format, Output};
use recordings::Value;
use recordings::measured::{LONGEST_BRIDGED, MeasuredFile, Options, Recording, Windows};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use summary::{Summary, counted};
use sweep::in_order::in_order;
use table::{Columns, Job, Layout};
use window::Asked;

/// Rows per group of the output.
const ROWS_PER_GROUP: usize = 4096;

/// Arguments of `crosshead features`.
#[derive(Args, Debug)]
#[command(after_help = "\
FILE is CSV, WAV, MAT (version 5 to 7), Parquet or MCAP, a bundle (a folder with recordings.yaml) or
a dataset of gen-dataset. A column of time (t, t_s, time) tells the sample rate. Units stand in the
columns' names: acc_m_s2, 'acc [m/s^2]', 'pressure (bar)'. The recordings.yaml in the folder of a file
says what its channels are: crank angle, tacho, accelerations and pressures with their units.

The crank angle is the column crank_angle_rad or crank_angle_deg, which counts from top dead centre,
or the one of --crank-angle or --tacho. Without a unit there are statistics alone; without a speed, a
crank angle or a tacho nothing per order or revolution; without top dead centre no sectors of the
crank angle. The column `missing` tells why a value is null, `warnings` what looks wrong.

Gaps of up to 4 samples without a number are bridged by straight lines; a longer gap ends a window.

Examples:
  crosshead features bearing.wav --unit '50 m/s^2' --speed '1480 rpm' --out bearing.parquet
  crosshead features log.csv --column 'acc [g]' --window '10 revolutions' --speed '500 rpm' --out log.parquet
  crosshead features log.csv --tacho keyphasor --top-dead-centre '30 deg' --out log-features.csv
  crosshead features datasets/paper2 my-bundle/ --out features.parquet

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Take this column only; may be repeated [default: every column of numbers]
    #[arg(long, value_name = "NAME")]
    column: Vec<String>,
    /// Sample rate, where no column of time and no heading tells it; a plain number is in Hz
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    sample_rate: Option<String>,
    /// Unit of the columns that have none, or what 1 in the file is (in a WAV file: full scale)
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Speed of the crank, where neither a crank angle nor the file tells it
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Crank angle, where its column is not called crank_angle_rad or crank_angle_deg; the unit in
    /// brackets where the file has none: 'encoder [deg]'
    #[arg(long, value_name = "COLUMN", conflicts_with = "tacho")]
    crank_angle: Option<String>,
    /// Pulses, one per revolution
    #[arg(long, value_name = "COLUMN")]
    tacho: Option<String>,
    /// Reading of the crank angle at top dead centre; with a tacho, how far the crank turns from the
    /// pulse to there
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    top_dead_centre: Option<String>,
    /// Length of a window: '2 s' or '10 revolutions' [default: the whole file up to 10 s (or
    /// 100000 samples), windows of that length of a longer one; rows of a table are one window each]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    window: Option<String>,
    #[command(flatten)]
    outside: AllowOutside,
    /// The table to write, .parquet or .csv; one that is there is replaced
    #[arg(long, value_name = "FILE.parquet")]
    out: PathBuf,
    /// Threads that compute [default: one per core]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

/// Computes the features and writes them.
///
/// # Errors
/// Wrong arguments, a file that cannot be read (nothing is then written), or a table that cannot
/// be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let format = Format::of(&arguments.out)?;
    let asked = Asked::parse(arguments.window.as_deref())?;
    let unit = arguments
        .unit
        .as_deref()
        .map(units::parse_argument)
        .transpose()?;
    let options = Options {
        columns: arguments.column.clone(),
        sample_rate_hz: arguments
            .sample_rate
            .as_deref()
            .map(sample_rate)
            .transpose()?,
    };
    let top_dead_centre = arguments.top_dead_centre.as_deref();
    let said = Said {
        options,
        speed_rpm: arguments.speed.as_deref().map(speed_rpm).transpose()?,
        crank: shaft::Asked {
            crank_angle: arguments.crank_angle.clone(),
            tacho: arguments.tacho.clone(),
            top_dead_centre: top_dead_centre
                .map(shaft::parse_top_dead_centre)
                .transpose()?,
        },
        outside: arguments.outside,
    };
    let inputs = inputs::all(&arguments.files, &said)?;
    refuse_input_as_output(&inputs, &arguments.out)?;

    let mut labels = Columns::default();
    let mut layouts = Vec::new();
    for input in &inputs {
        layouts.push(Layout::new(
            input,
            &input.open()?,
            unit.as_ref(),
            &said.crank,
            &mut labels,
        )?);
    }
    let schema = table::schema(labels, &mut layouts)?;
    let note = unknown_units(&layouts);
    let columns = schema.columns().len();

    let mut output = Output::create(&arguments.out, format, &schema)?;
    let mut summary = Summary::new(columns);
    let cancel = interrupt::flag()?;
    let threads = arguments.threads.map_or_else(
        || std::thread::available_parallelism().map_or(1, Into::into),
        usize::from,
    );
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(Failure::work)?;
    let mut left_out = 0.0;
    let jobs = Jobs {
        inputs: inputs.iter().zip(layouts.into_iter().map(Arc::new)),
        asked,
        file: None,
        recording: None,
        left_out_s: &mut left_out,
        failed: false,
    };
    let bar = bar();
    in_order(
        &pool,
        2 * threads,
        jobs,
        |job| job.as_ref().ok().map(|job| table::row(job, columns)),
        |job, row| {
            job?;
            if cancel.load(Ordering::Relaxed) {
                return Err(Failure::work("interrupted; nothing was written"));
            }
            bar.inc(1);
            let Some(mut row) = row else { return Ok(()) };
            summary.add(&mut row);
            output.write(row.values)
        },
    )?;
    bar.finish_and_clear();
    output.commit()?;
    for line in note.into_iter().chain(summary.warnings()) {
        eprintln!("{line}");
    }
    println!(
        "{}: {}, {}, {}",
        arguments.out.display(),
        counted(summary.rows(), "window"),
        counted(columns as u64, "column"),
        counted(inputs.len() as u64, "file"),
    );
    for line in summary.empty(&schema) {
        println!("{line}");
    }
    if summary.bridged() > 0 {
        println!(
            "  {} bridged by lines (gaps of up to {LONGEST_BRIDGED})",
            counted(summary.bridged() as u64, "missing sample")
        );
    }
    if left_out > 0.0 {
        println!("  {left_out:.3} s were too short for a window and are left out");
    }
    Ok(())
}

fn sample_rate(text: &str) -> Result<f64, Failure> {
    let plain = text.trim().parse().ok();
    let rate = match plain {
        Some(rate) => Quantity::<Frequency, AboveZero>::new(rate).ok_or(format!("'{text}'")),
        None => Quantity::parse(text),
    };
    rate.map(|rate| rate.si()).map_err(|found| {
        let expected = Quantity::<Frequency, AboveZero>::expected();
        Failure::input(format!("--sample-rate: found {found}, expected {expected}"))
    })
}

fn speed_rpm(text: &str) -> Result<f64, Failure> {
    let speed = Quantity::<Speed, AboveZero>::parse(text).map_err(|found| {
        let expected = Quantity::<Speed, AboveZero>::expected();
        Failure::input(format!("--speed: found {found}, expected {expected}"))
    })?;
    Ok(speed.si() * 30.0 / std::f64::consts::PI)
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

/// A note of the first file whose channels have no unit.
fn unknown_units(layouts: &[Layout]) -> Option<String> {
    let layout = layouts
        .iter()
        .find(|layout| !layout.without_unit.is_empty())?;
    Some(format!(
        "note: {}: no unit of {}: statistics alone; --unit 'm/s^2' gives the rest",
        layout.file,
        layout.without_unit.join(", ")
    ))
}

/// Windows done, on standard error; nothing where that is no terminal.
fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{spinner} {pos} windows  {per_sec}  {elapsed}")
    {
        bar.set_style(style);
    }
    bar
}

/// The windows of all files, in order; the first failure ends them.
struct Jobs<'a, I> {
    inputs: I,
    asked: Asked,
    file: Option<(Arc<Layout>, MeasuredFile)>,
    recording: Option<(Windows, Current)>,
    left_out_s: &'a mut f64,
    failed: bool,
}

/// What holds for the windows of a recording.
struct Current {
    labels: Arc<Vec<Value>>,
    sample_rate_hz: f64,
    speed_rpm: Option<f64>,
    next: u64,
}

impl<'a, I: Iterator<Item = (&'a Input, Arc<Layout>)>> Jobs<'_, I> {
    fn advance(&mut self) -> Result<Option<Job>, Failure> {
        loop {
            if let (Some((layout, _)), Some((windows, current))) = (&self.file, &mut self.recording)
            {
                match windows.next().transpose().map_err(Failure::input)? {
                    Some(window) => {
                        current.next += 1;
                        return Ok(Some(Job {
                            layout: layout.clone(),
                            labels: current.labels.clone(),
                            index: current.next - 1,
                            sample_rate_hz: current.sample_rate_hz,
                            speed_rpm: current.speed_rpm,
                            window,
                        }));
                    }
                    None if current.next == 0 => {
                        let left = windows.left_out() as f64 / current.sample_rate_hz;
                        return Err(Failure::input(format!(
                            "{}: the recording has {left:.3} s, less than a window",
                            layout.file
                        )));
                    }
                    None => {
                        *self.left_out_s += windows.left_out() as f64 / current.sample_rate_hz;
                        self.recording = None;
                    }
                }
            }
            if let Some((layout, file)) = &mut self.file {
                if let Some(recording) = file.next() {
                    let path = PathBuf::from(&layout.file);
                    let recording = recording.map_err(|e| inputs::refused(&path, e))?;
                    let whole = file.is_table();
                    self.recording = Some(windows(layout, recording, self.asked, whole)?);
                    continue;
                }
                self.file = None;
            }
            let Some((input, layout)) = self.inputs.next() else {
                return Ok(None);
            };
            self.file = Some((layout, input.open()?));
        }
    }
}

/// A recording cut into windows.
fn windows(
    layout: &Layout,
    mut recording: Recording,
    asked: Asked,
    whole: bool,
) -> Result<(Windows, Current), Failure> {
    let wrong = |reason: String| Failure::input(format!("{}: {reason}", layout.file));
    let rate = recording.sample_rate_hz().ok_or_else(|| {
        wrong(
            "neither a column of time nor a heading tells the sample rate: give --sample-rate"
                .into(),
        )
    })?;
    let stated = layout.stated_speed(recording.labels())?;
    let mut speed = stated;
    if let (None, Asked::Revolutions(_)) = (stated, asked) {
        let first = recording.peek().map_err(Failure::input)?;
        let crank = layout.crank(&first).and_then(Result::ok);
        speed = crank.and_then(|crank| shaft::speed_rpm(&crank, rate).ok());
    }
    let length = asked.length(rate, speed, whole).map_err(wrong)?;
    let current = Current {
        labels: Arc::new(recording.labels().to_vec()),
        sample_rate_hz: rate,
        speed_rpm: stated,
        next: 0,
    };
    let windows = Windows::new(recording, layout.channels.len(), rate, length)
        .bridging(layout.bridges(), FEWEST_SAMPLES);
    Ok((windows, current))
}

impl<'a, I: Iterator<Item = (&'a Input, Arc<Layout>)>> Iterator for Jobs<'_, I> {
    type Item = Result<Job, Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let job = self.advance().transpose();
        self.failed = matches!(job, Some(Err(_)));
        job
    }
}
