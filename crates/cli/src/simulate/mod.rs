//! `crosshead simulate`: one run of a machine, its signals, what they say, and pictures.

mod summary;

use crate::Failure;
use crate::output::{hint, refuse_existing, write_file};
use crate::progress::Progress;
use ::report::case_picture::CasePicture;
use ::report::run_figures::{FIGURES, RunFigures};
use clap::{Args, ValueEnum};
use input::quantity::{AboveZero, Frequency, Quantity};
use input::{MachineFile, Resolved};
use recordings::WholeFile;
use recordings::formats::parquet::ROWS_PER_GROUP;
use recordings::formats::{csv, parquet};
use scalar::random::{Purpose, Stream, stream};
use serde_json::Value;
use signal::channel::Channel;
use simulate::{ExponentSettings, Extent, Record, Settings, Transient};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use sweep::run_analysis::RunAnalysis;
use sweep::run_table::run_table;

/// Arguments of `crosshead simulate`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead simulate data/machines/single-stage.yaml --set joints.big_end.clearance='0.2 mm'
  crosshead simulate machine.yaml --revolutions 5 --sample-rate '50 kHz' --format csv --out run1
  crosshead simulate datasets/paper2/sweep.yaml --case case-000003

DIR gets the signals, picture.svg (the motion in the joints), pv-card.svg (pressure over volume of
each chamber), rod-load.svg (gas, inertia and combined load at the crosshead pin, and where it
reverses), waveform.svg (pressure and acceleration over the crank angle), and summary.json:
indicated power and mean pressure of each chamber, the combined rod load with its reversal as API
618 asks for it, and the overall vibration from 2 to 1000 Hz.")]
pub struct Arguments {
    /// The machine file, or with --case a sweep file
    machine: PathBuf,
    /// Simulate this case of a sweep, as its dataset has it
    #[arg(long, value_name = "CASE_ID", conflicts_with_all = ["set", "revolutions", "transient", "sample_rate", "tolerance", "seed"])]
    case: Option<String>,
    /// Folder to write into [default: NAME-run, NAME being the machine file's]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the signals
    #[arg(long, value_enum, default_value_t = Format::Parquet)]
    format: Format,
    /// Change a value of the machine file; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Revolutions to record
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    revolutions: u32,
    /// Revolutions to leave out before
    #[arg(long, default_value_t = 10)]
    transient: u32,
    /// Sample rate of the recording [default: the machine file's, or 10 kHz]
    #[arg(long)]
    sample_rate: Option<String>,
    /// Relative local error of the integration
    #[arg(long, default_value = "1e-9")]
    tolerance: f64,
    /// Seed of the sensors' noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Also write the motion itself, as no sensor sees it
    #[arg(long)]
    trace: bool,
    /// Also judge the motion from the equations: exponents, regime, period, Floquet multipliers
    #[arg(long)]
    motion: bool,
    /// Replace the files of an earlier run
    #[arg(long)]
    overwrite: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    Parquet,
    Csv,
}

/// Runs the machine and writes `signals.parquet` (or `.csv`), `summary.json`, `picture.svg` and the figures.
///
/// # Errors
/// A wrong machine file or argument, an integration that fails, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (machine, settings, mut noise) = what_to_run(arguments)?;
    let files = Files::new(arguments);
    refuse_existing(files.all(), arguments.overwrite)?;

    let recordable = settings.check(machine.speed);
    recordable.map_err(|e| Failure::input(format!("{}: {e}", machine.name)))?;
    let progress = Progress::new(
        "% simulated",
        Some(100),
        "{bar:40} {pos} % simulated  {eta} left",
    );
    let (m, sensors) = (&machine.machine, &machine.sensors);
    let mut watch = |done: f64| {
        progress.set((100.0 * done) as u64);
        ControlFlow::Continue(())
    };
    let record = simulate::simulate_watched(m, sensors, &settings, &mut watch)
        .map_err(|e| Failure::work(format!("{}: {e}", machine.name)))?;
    drop(progress);
    let throws: Vec<&str> = machine
        .machine
        .throws
        .iter()
        .map(|t| t.name.as_str())
        .collect();
    let channels = simulate::measure(&record, &machine.sensors, &throws, &mut noise);

    files.make_folder()?;
    let trace = record.trace.as_ref().filter(|_| arguments.trace);
    let table = run_table(&record, &channels, trace, &throws).map_err(Failure::work)?;
    write_whole(&files.signals, |file| match arguments.format {
        Format::Parquet => parquet::write_table(file, &table, ROWS_PER_GROUP),
        Format::Csv => csv::write_table(file, &table),
    })?;
    write_file(&files.picture, picture_of(&machine, &record).as_bytes())?;
    summary::print(&machine, &record, &channels);
    for file in analyse(&machine, &record, &channels, &files)? {
        println!("{}", file.display());
    }
    if arguments.motion {
        let judged = ExponentSettings {
            tolerance: settings.tolerance,
            ..ExponentSettings::default()
        };
        let motion = simulate::machine_motion(&machine.machine, &judged, Extent::Spectrum)
            .map_err(|e| Failure::work(format!("{}: {e}", machine.name)))?;
        summary::print_motion(motion.as_ref(), judged.revolutions);
    }
    let of_machine = match arguments.case {
        None => format!(" --machine {}", arguments.machine.display()),
        Some(_) => String::new(),
    };
    hint(format_args!(
        "crosshead features {}{of_machine} --out features.parquet",
        files.signals.display()
    ));
    Ok(())
}

/// Where the run is written to.
struct Files {
    folder: PathBuf,
    signals: PathBuf,
    picture: PathBuf,
    summary: PathBuf,
    figures: [PathBuf; 3],
}

impl Files {
    fn new(arguments: &Arguments) -> Self {
        let folder = arguments.out.clone().unwrap_or_else(|| {
            let stem = arguments.machine.file_stem().unwrap_or_default();
            let name = arguments
                .case
                .clone()
                .map_or(stem.to_string_lossy(), Into::into);
            PathBuf::from(format!("{name}-run"))
        });
        let signals = match arguments.format {
            Format::Parquet => "signals.parquet",
            Format::Csv => "signals.csv",
        };
        Self {
            signals: folder.join(signals),
            picture: folder.join("picture.svg"),
            summary: folder.join("summary.json"),
            figures: FIGURES.map(|name| folder.join(name)),
            folder,
        }
    }

    fn all(&self) -> Vec<&Path> {
        let mut all: Vec<&Path> = vec![&self.signals, &self.picture, &self.summary];
        all.extend(self.figures.iter().map(PathBuf::as_path));
        all
    }

    fn make_folder(&self) -> Result<(), Failure> {
        let made = std::fs::create_dir_all(&self.folder);
        made.map_err(|e| Failure::input(format!("{}: {e}", self.folder.display())))
    }
}

/// Writes and prints what the user of a machine looks at first; returns all files of the run.
fn analyse<'a>(
    machine: &Resolved,
    record: &Record,
    channels: &[Channel],
    files: &'a Files,
) -> Result<Vec<&'a Path>, Failure> {
    let analysis = match RunAnalysis::new(&machine.machine, record, channels) {
        Ok(analysis) => analysis,
        // A record of less than a revolution has its signals all the same.
        Err(error) => {
            eprintln!("warning: no p-V card and no rod load: {error}");
            return Ok(vec![&files.signals, &files.picture]);
        }
    };
    let numbers = analysis.summary(&machine.name, record.mean_speed);
    let text = serde_json::to_string_pretty(&numbers).map_err(Failure::work)?;
    write_file(&files.summary, text.as_bytes())?;
    write_figures(machine, record, channels, &analysis, &files.figures)?;
    summary::print_analysis(&numbers);
    Ok(files.all())
}

/// The machine, how it is run, and the random numbers of its noise.
fn what_to_run(arguments: &Arguments) -> Result<(Resolved, Settings, Stream), Failure> {
    let Some(id) = &arguments.case else {
        let noise = stream(arguments.seed, 0, Purpose::Noise);
        let machine = read_machine(arguments)?;
        let settings = settings(arguments, machine.sample_rate)?;
        return Ok((machine, settings, noise));
    };
    let plan = crate::gen_dataset::read_plan(&arguments.machine)?;
    let Some(index) = plan.case_index(id) else {
        return Err(Failure::input(format!(
            "--case: found {id}, expected one of {} to {}",
            plan.case_id(0),
            plan.case_id(plan.cases() - 1)
        )));
    };
    let case = plan.case(index)?;
    let noise = case.noise();
    Ok((case.resolved, case.settings, noise))
}

fn read_machine(arguments: &Arguments) -> Result<Resolved, Failure> {
    let file = input::machine_file::read(&arguments.machine)?;
    if arguments.set.is_empty() {
        return Ok(file.resolve()?);
    }
    let mut tree = file.to_tree().clone();
    for change in &arguments.set {
        let (path, value) = change.split_once('=').ok_or_else(|| {
            Failure::input(format!(
                "--set {change}: expected PATH=VALUE, e.g. joints.big_end.clearance='0.2 mm'"
            ))
        })?;
        input::paths::set(&mut tree, path.trim(), scalar_of(value.trim()))
            .map_err(|e| Failure::input(format!("--set {change}: {e}")))?;
    }
    let changed = MachineFile::from_tree(&tree).and_then(|file| file.resolve());
    changed.map_err(|e| Failure::input(format!("with --set: {e}")))
}

/// A number where the text is one, the text itself elsewhere.
fn scalar_of(text: &str) -> Value {
    serde_json::from_str(text)
        .ok()
        .filter(|value: &Value| value.is_number() || value.is_boolean())
        .unwrap_or_else(|| Value::String(text.to_owned()))
}

/// The settings of a run; `of_machine` is the machine file's sample rate, Hz.
fn settings(arguments: &Arguments, of_machine: Option<f64>) -> Result<Settings, Failure> {
    let asked = arguments.sample_rate.as_ref().map(|text| {
        Quantity::<Frequency, AboveZero>::parse(text).map_err(|found| {
            let expected = Quantity::<Frequency, AboveZero>::expected();
            Failure::input(format!("--sample-rate: found {found}, expected {expected}"))
        })
    });
    let asked = asked.transpose()?.map(|rate| rate.si());
    let default = Settings::default();
    let tolerance = arguments.tolerance;
    if !(1e-14..=1e-2).contains(&tolerance) {
        return Err(Failure::input(format!(
            "--tolerance: found {tolerance}, expected a number from 1e-14 to 1e-2"
        )));
    }
    Ok(Settings {
        transient: Transient::Revolutions(arguments.transient),
        revolutions: arguments.revolutions,
        sample_rate: asked.or(of_machine).unwrap_or(default.sample_rate),
        tolerance,
        ..default
    })
}

/// Writes a file that appears whole or not at all.
fn write_whole(
    path: &Path,
    write: impl FnOnce(WholeFile) -> Result<WholeFile, recordings::Error>,
) -> Result<(), Failure> {
    let temporary = path.with_extension("part");
    WholeFile::create(&temporary, path)
        .and_then(write)
        .and_then(WholeFile::commit)
        .map(drop)
        .map_err(Failure::work)
}

/// Writes the figures of the analysis to these files.
fn write_figures(
    machine: &Resolved,
    record: &Record,
    channels: &[Channel],
    analysis: &RunAnalysis,
    files: &[PathBuf],
) -> Result<(), Failure> {
    let trace = record.trace.iter();
    let angles = trace.flat_map(|trace| trace.crank_angle.iter().step_by(trace.stride.max(1)));
    let figures = RunFigures {
        title: &title(machine),
        analysis,
        crank_angle_rad: &angles.copied().collect::<Vec<_>>(),
        channels,
    };
    let mut made = figures.files().into_iter().zip(files);
    made.try_for_each(|(figure, file)| write_file(file, figure.svg.as_bytes()))
}

/// The machine and its operating point.
fn title(machine: &Resolved) -> String {
    format!("{}, {}", machine.name, summary::rpm(machine.speed))
}

/// The picture of the run; empty where it has no throw.
fn picture_of(machine: &Resolved, record: &Record) -> String {
    let deep = summary::too_deep(record).map(|joint| {
        let times = joint.deepest / joint.clearance;
        format!(
            " · {} penetrates by {times:.2} times its clearance",
            joint.joint
        )
    });
    let deep: String = deep.collect();
    let title = format!("{}{deep}", title(machine));
    let trace = record.trace.as_ref();
    let picture = trace.and_then(|trace| CasePicture::new(&title, trace));
    picture.map_or(String::new(), |picture| picture.svg())
}
