//! `crosshead simulate`: one run of a machine, its signals and a picture.

use crate::Failure;
use crate::run_progress::Progress;
use ::report::case_picture::CasePicture;
use clap::{Args, ValueEnum};
use input::quantity::{AboveZero, Frequency, Quantity};
use input::{MachineFile, Resolved};
use mechanism::drive::Drive;
use recordings::WholeFile;
use recordings::formats::parquet::ROWS_PER_GROUP;
use recordings::formats::{csv, parquet};
use scalar::random::{Purpose, Stream, stream};
use serde_json::Value;
use signal::channel::Channel;
use simulate::{
    ExponentSettings, Extent, Motion, Penetration, Record, Regime, Settings, Transient,
};
use std::io::Write;
use std::path::{Path, PathBuf};
use sweep::run_table::run_table;

/// Arguments of `crosshead simulate`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead simulate data/machines/single-stage.yaml --set joints.big_end.clearance='0.2 mm'
  crosshead simulate machine.yaml --revolutions 5 --sample-rate '50 kHz' --format csv --out run1
  crosshead simulate datasets/paper2/sweep.yaml --case case-000003")]
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

/// Runs the machine and writes `signals.parquet` (or `.csv`) and `picture.svg`.
///
/// # Errors
/// A wrong machine file or argument, an integration that fails, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (machine, settings, mut noise) = what_to_run(arguments)?;
    let out = arguments.out.clone().unwrap_or_else(|| {
        let stem = arguments.machine.file_stem().unwrap_or_default();
        let name = arguments
            .case
            .clone()
            .map_or(stem.to_string_lossy(), Into::into);
        PathBuf::from(format!("{name}-run"))
    });
    let signals = out.join(match arguments.format {
        Format::Parquet => "signals.parquet",
        Format::Csv => "signals.csv",
    });
    let picture = out.join("picture.svg");
    refuse_existing(&[&signals, &picture], arguments.overwrite)?;

    let recordable = settings.check(machine.speed);
    recordable.map_err(|e| Failure::input(format!("{}: {e}", machine.name)))?;
    let mut progress = Progress::new();
    let (m, sensors) = (&machine.machine, &machine.sensors);
    let record = simulate::simulate_watched(m, sensors, &settings, &mut |done| progress.show(done))
        .map_err(|e| Failure::work(format!("{}: {e}", machine.name)))?;
    let throws: Vec<&str> = machine
        .machine
        .throws
        .iter()
        .map(|t| t.name.as_str())
        .collect();
    let channels = simulate::measure(&record, &machine.sensors, &throws, &mut noise);

    std::fs::create_dir_all(&out).map_err(|e| Failure::input(format!("{}: {e}", out.display())))?;
    let trace = record.trace.as_ref().filter(|_| arguments.trace);
    let table = run_table(&record, &channels, trace, &throws).map_err(Failure::work)?;
    write_whole(&signals, |file| match arguments.format {
        Format::Parquet => parquet::write_table(file, &table, ROWS_PER_GROUP),
        Format::Csv => csv::write_table(file, &table),
    })?;
    let svg = picture_of(&machine, &record);
    write_whole(&picture, |mut file| {
        file.write_all(svg.as_bytes())
            .map_err(recordings::Error::Write)?;
        Ok(file)
    })?;
    summarise(&machine, &record, &channels, &[&signals, &picture]);
    if arguments.motion {
        let judged = ExponentSettings {
            tolerance: settings.tolerance,
            ..ExponentSettings::default()
        };
        let motion = simulate::machine_motion(&machine.machine, &judged, Extent::Spectrum)
            .map_err(|e| Failure::work(format!("{}: {e}", machine.name)))?;
        tell_motion(motion.as_ref(), judged.revolutions);
    }
    Ok(())
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

fn refuse_existing(paths: &[&Path], overwrite: bool) -> Result<(), Failure> {
    match paths.iter().find(|path| path.exists() && !overwrite) {
        None => Ok(()),
        Some(path) => Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            path.display()
        ))),
    }
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

/// The picture of the run; empty where it has no throw.
fn picture_of(machine: &Resolved, record: &Record) -> String {
    let deep = too_deep(record).map(|joint| {
        let times = joint.deepest / joint.clearance;
        format!(
            " · {} penetrates by {times:.2} times its clearance",
            joint.joint
        )
    });
    let deep: String = deep.collect();
    let title = format!("{}, {}{deep}", machine.name, rpm(machine.speed));
    let trace = record.trace.as_ref();
    let picture = trace.and_then(|trace| CasePicture::new(&title, trace));
    picture.map_or(String::new(), |picture| picture.svg())
}

/// The joints whose surfaces penetrate each other too deeply.
fn too_deep(record: &Record) -> impl Iterator<Item = &Penetration> {
    record
        .penetrations
        .iter()
        .filter(|joint| joint.is_too_deep())
}

fn summarise(machine: &Resolved, record: &Record, channels: &[Channel], files: &[&Path]) {
    println!("{}, {}", machine.name, rpm(machine.speed));
    let energy = record.energy_residual.map_or(String::new(), |missing| {
        format!(
            ", energy ledger closes to within {:.1e} of the energy turned over",
            missing.abs()
        )
    });
    println!(
        "  {} steps, {} contact and gas switches{energy}",
        record.work.accepted, record.work.switches
    );
    for channel in channels {
        let samples = channel.samples.iter().map(|x| f64::from(*x));
        let count = channel.samples.len().max(1) as f64;
        let rms = (samples.clone().map(|x| x * x).sum::<f64>() / count).sqrt();
        let peak = samples.map(f64::abs).fold(0.0, f64::max);
        println!(
            "  {}: rms {rms:.4e}, peak {peak:.4e} {}",
            channel.name, channel.unit
        );
    }
    if let Drive::Free(_) = machine.machine.drive {
        println!("  mean speed {}", rpm(record.mean_speed));
    }
    for joint in too_deep(record) {
        println!("  warning: {joint}");
    }
    for file in files {
        println!("{}", file.display());
    }
}

/// What kind of motion it is, and the numbers that say so.
fn tell_motion(motion: Option<&Motion>, revolutions: u32) {
    let Some(motion) = motion else {
        println!("motion: periodic, 1 revolution; nothing moves freely");
        return;
    };
    let period = match motion.regime {
        Regime::Periodic { revolutions } => format!(", {revolutions} rev"),
        _ => String::new(),
    };
    println!("motion: {}{period}", motion.regime.name());
    println!("  Lyapunov exponents, 1/s, with standard errors, over {revolutions} revolutions:");
    for exponent in &motion.exponents {
        let (value, error) = (exponent.per_second, exponent.standard_error);
        println!("    {value:.4} +- {error:.1e}");
    }
    if let Some(orbit) = &motion.orbit {
        println!("  Floquet multipliers, over {:.6} s:", orbit.period);
        // Below, they are rounding.
        for multiplier in orbit.multipliers.iter().filter(|m| m.norm() > 1e-9) {
            match multiplier.im {
                0.0 => println!("    {:.3e}", multiplier.re),
                im => println!("    {:.3e} {im:+.3e}i", multiplier.re),
            }
        }
    }
}

/// A speed in rad/s as people say it.
fn rpm(speed: f64) -> String {
    format!("{:.4} rpm", speed * 30.0 / std::f64::consts::PI).replace(".0000", "")
}
