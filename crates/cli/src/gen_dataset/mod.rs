//! `gen-dataset`: a sweep becomes a labelled dataset.

mod bar;
mod dry_run;

pub(crate) use bar::Bar;

use crate::choice::one_of;
use crate::output::{hint, warn};
use crate::{Failure, calibrate, console, interrupt, try_case};
use clap::Args;
use recordings::Manifest;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use sweep::dataset::{Claim, Existing, Options, doubtful, failures, finished};
use sweep::dataset::{generate_in, late_warnings};
use sweep::sweep_file::Format;
use sweep::{Plan, Sweep, simulate_cases};

/// Formats of the recordings.
pub(crate) const FORMATS: [(&str, &str, Format); 2] = [
    (
        "parquet",
        "Parquet tables, one row per window",
        Format::Parquet,
    ),
    ("mcap", "One MCAP file per case", Format::Mcap),
];

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  gen-dataset pipelines/paper2.yaml
  gen-dataset pipelines/bearing-faults.yaml --out faults --threads 8
  gen-dataset pipelines/bearing-faults.yaml --out faults --resume
  gen-dataset pipelines/bearing-faults.yaml --out faults --resume --retry-failed
  gen-dataset pipelines/bearing-faults.yaml --dry-run

Exit status: 0 done; 1 the work failed, or some cases did; 2 the input or the arguments are wrong;
130 interrupted.")]
pub struct Arguments {
    /// The sweep file
    sweep: PathBuf,
    /// Folder of the dataset, or s3://BUCKET/PREFIX [default: datasets/NAME, NAME being the sweep's]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the recordings, instead of the sweep's own
    #[arg(long, value_parser = one_of(FORMATS))]
    format: Option<Format>,
    /// Continue a dataset that was interrupted
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Make the shards with failed cases again
    #[arg(long, requires = "resume")]
    retry_failed: bool,
    /// Replace a dataset that is there
    #[arg(long)]
    overwrite: bool,
    /// Estimate size and time from a measured sample, and write nothing
    #[arg(long)]
    dry_run: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let sweep = Sweep::read(&arguments.sweep)?;
    // Mistakes in the sweep are found before anything is calibrated.
    let nominal = sweep.nominal()?;
    nominal.check_size().map_err(|e| failure(arguments, e))?;
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| default_folder(&nominal.name));
    if arguments.dry_run {
        let plan = dry_run::planned(&sweep, nominal, &out)?;
        return dry_run::run(&with_format(plan, arguments.format)?);
    }
    let cancel = interrupt::flag()?;
    let existing = match (arguments.resume, arguments.overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let options = options(existing, arguments.retry_failed, &cancel);
    let started = Instant::now();
    let claim = || claim(&sweep, nominal, &out, existing, &cancel);
    let (claim, plan) = console::pool()?.install(claim)?;
    let plan = with_format(plan, arguments.format)?;
    // Before hours of simulation.
    warn(&plan.census().mistakes());
    let mut bar = Bar::default();
    let manifest = generate_in(claim, &plan, &options, &simulate_cases, &mut bar)
        .map_err(|error| failure(arguments, error))?;
    drop(bar);
    match summarise(&plan, &manifest, &out, started) {
        Some(failed) => Err(Failure::work(failed)),
        None => {
            hint(format_args!("crosshead report {}", out.display()));
            Ok(())
        }
    }
}

/// How shards are made.
pub(crate) fn options(existing: Existing, retry_failed: bool, cancel: &AtomicBool) -> Options<'_> {
    Options {
        existing,
        threads: console::threads(),
        cancel,
        retry_failed,
        trial: Some(&try_case::command),
    }
}

/// Locks the place of the dataset, and calibrates the machine where the sweep asks for it; else its
/// plan is `nominal`.
pub(crate) fn claim(
    sweep: &Sweep,
    nominal: Plan,
    out: &Path,
    existing: Existing,
    cancel: &AtomicBool,
) -> Result<(Claim, Plan), Failure> {
    sweep.claim(nominal, out, existing, |prepared, folder| {
        let done = calibrate::finish(prepared, cancel)?;
        match done.reused {
            true => println!("calibrated before, and nothing has changed since:"),
            false => println!("calibrated into {}:", folder.display()),
        }
        print!("{}", done.results);
        match done.results.complete {
            true => Ok(()),
            false => Err(Failure::interrupted(format!(
                "stopped during the calibration, before the first case; {} has the best so far, and \
                 --resume continues from there",
                folder.display()
            ))),
        }
    })
}

/// `plan` with the recordings in another format, where one is asked for.
///
/// # Errors
/// A format that the plan cannot have.
pub(crate) fn with_format(plan: Plan, format: Option<Format>) -> Result<Plan, Failure> {
    match format {
        None => Ok(plan),
        Some(format) => Ok(plan.with_format(format)?),
    }
}

/// Prints what a finished dataset has, and gives what is to be said of cases that failed.
pub(crate) fn summarise(
    plan: &Plan,
    manifest: &Manifest,
    out: &Path,
    started: Instant,
) -> Option<String> {
    let seconds = started.elapsed().as_secs_f64();
    print!("{}", finished(plan, manifest, out, seconds));
    warn(&late_warnings(plan, manifest));
    if let Some(text) = doubtful(&manifest.warnings) {
        println!("{text}");
    }
    failures(&manifest.failed, manifest.counts.cases, out)
}

/// The folder of the dataset of a sweep with this name, where the user names none.
fn default_folder(name: &str) -> PathBuf {
    Path::new("datasets").join(name)
}

/// The plan of the sweep file at `path`. One that calibrates its machine first has the calibration
/// that its dataset keeps.
///
/// # Errors
/// A mistake in the file, or a calibration that is not there.
pub(crate) fn read_plan(path: &Path) -> Result<Plan, Failure> {
    let sweep = Sweep::read(path)?;
    let nominal = sweep.nominal()?;
    if sweep.calibrate().is_none() {
        return Ok(nominal);
    }
    let root = default_folder(&nominal.name);
    sweep.plan_if_kept(&root)?.ok_or_else(|| {
        Failure::input(format!(
            "{}: this sweep calibrates its machine first, and {} does not hold that calibration: \
             make the dataset, or name its own sweep.yaml, which has the calibrated machine",
            path.display(),
            root.display()
        ))
    })
}

fn failure(arguments: &Arguments, error: sweep::Error) -> Failure {
    match error {
        sweep::Error::TooManyCases { .. } => {
            Failure::input(format!("{}: cases: {error}", arguments.sweep.display()))
        }
        error => error.into(),
    }
}
