//! `crosshead simulate`: one run of a machine, its signals, what they say, and pictures.

use crate::Failure;
use crate::output::{hint, refuse_existing};
use crate::progress::Progress;
use ::report::run_folder::RunFolder;
use ::report::{Error, summary};
use clap::Args;
use input::quantity::{AboveZero, Frequency, Quantity};
use input::{MachineFile, Resolved};
use scalar::random::{Purpose, stream};
use serde_json::Value;
use simulate::settings::TOLERANCES;
use simulate::{Settings, Transient};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use sweep::run::{Asked, Run};

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
    #[arg(long, default_value = "parquet", value_parser = ["parquet", "csv"])]
    format: String,
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let asked = what_to_run(arguments)?;
    let out = arguments.out.clone().unwrap_or_else(|| folder(arguments));
    let files = RunFolder::new(&out, &format!("signals.{}", arguments.format));
    refuse_existing(files.files(), arguments.overwrite, "--out DIR")?;

    let name = asked.machine.name.clone();
    let named = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let recordable = asked.settings.check(asked.machine.speed);
    recordable.map_err(|error| Failure::input(named(&error)))?;
    let run = simulated(asked).map_err(|error| Failure::work(named(&error)))?;

    let made = std::fs::create_dir_all(&out);
    made.map_err(|error| Failure::input(format!("{}: {error}", out.display())))?;
    files.write_signals(&run, arguments.trace)?;
    print!("{}", summary::run(&run));
    let written = match files.write_analysis(&run) {
        Ok(analysis) => {
            print!("{}", summary::analysis(&analysis));
            files.files()
        }
        // A record of less than a revolution has its signals all the same.
        Err(Error::Analysis(error)) => {
            eprintln!("warning: no p-V card and no rod load: {error}");
            vec![files.signals.as_path(), &files.picture]
        }
        Err(error) => return Err(error.into()),
    };
    for file in written {
        println!("{}", file.display());
    }
    if arguments.motion {
        let (motion, revolutions) = run.motion().map_err(|error| Failure::work(named(&error)))?;
        print!("{}", summary::motion(motion.as_ref(), revolutions));
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

fn simulated(asked: Asked) -> Result<Run, simulate::Error> {
    let template = "{bar:40} {pos} % simulated  {eta} left";
    let progress = Progress::new("% simulated", Some(100), template);
    asked.run(&mut |done| {
        progress.bar.set_position((100.0 * done) as u64);
        ControlFlow::Continue(())
    })
}

/// Where the run is written to, where the user names no folder.
fn folder(arguments: &Arguments) -> PathBuf {
    let stem = arguments.machine.file_stem().unwrap_or_default();
    let case = arguments.case.clone().map(Into::into);
    format!("{}-run", case.unwrap_or(stem.to_string_lossy())).into()
}

/// The machine, how it is run, and the random numbers of its noise.
fn what_to_run(arguments: &Arguments) -> Result<Asked, Failure> {
    let Some(id) = &arguments.case else {
        let machine = read_machine(&arguments.machine, &arguments.set)?;
        return Ok(Asked {
            settings: settings(arguments, machine.sample_rate)?,
            noise: stream(arguments.seed, 0, Purpose::Noise),
            machine,
        });
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
    Ok(Asked {
        noise: case.noise(),
        machine: case.resolved,
        settings: case.settings,
    })
}

fn read_machine(path: &Path, changes: &[String]) -> Result<Resolved, Failure> {
    let file = input::machine_file::read(path)?;
    if changes.is_empty() {
        return Ok(file.resolve()?);
    }
    let mut tree = file.to_tree().clone();
    for change in changes {
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
    let value = serde_json::from_str(text).ok();
    let plain = value.filter(|value: &Value| value.is_number() || value.is_boolean());
    plain.unwrap_or_else(|| text.into())
}

/// The settings of a run; `of_machine` is the machine file's sample rate, Hz.
fn settings(arguments: &Arguments, of_machine: Option<f64>) -> Result<Settings, Failure> {
    type Rate = Quantity<Frequency, AboveZero>;
    let asked = arguments.sample_rate.as_ref();
    let asked = asked.map(|text| Rate::named("--sample-rate", text));
    let asked = asked.transpose().map_err(Failure::input)?;
    let default = Settings::default();
    let tolerance = arguments.tolerance;
    let [least, most] = TOLERANCES;
    if !(least..=most).contains(&tolerance) {
        return Err(Failure::input(format!(
            "--tolerance: found {tolerance}, expected a number from {least:e} to {most:e}"
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
