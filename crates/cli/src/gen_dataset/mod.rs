//! `gen-dataset`: a sweep becomes a labelled dataset.

mod bar;
mod calibrated;
mod dry_run;
mod summary;

pub(crate) use bar::Bar;
pub(crate) use summary::{failures, summarise, warn};

use crate::output::hint;
use crate::{Failure, console, interrupt, try_case};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use sweep::dataset::{Claim, Existing, Options, check_calibration, generate_in};
use sweep::sweep_file::Format;
use sweep::{Plan, Sweep, simulate_cases};

/// Arguments of `gen-dataset`.
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
    #[arg(long, value_enum)]
    format: Option<FormatArgument>,
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

/// Format of the recordings.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum FormatArgument {
    /// Parquet tables, one row per window
    Parquet,
    /// One MCAP file per case
    Mcap,
}

/// Writes the dataset.
///
/// # Errors
/// Wrong input, an output that cannot be written, or cases that failed (the others are there).
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let sweep = Sweep::read(&arguments.sweep)?;
    // Mistakes in the sweep are found before anything is calibrated.
    let nominal = sweep.nominal()?;
    nominal.check_size().map_err(|e| failure(arguments, e))?;
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| default_folder(&nominal.name));
    if arguments.dry_run {
        return dry_run::dry_run(&arguments.planned(&sweep, nominal, &out)?);
    }
    let cancel = interrupt::flag()?;
    let existing = match (arguments.resume, arguments.overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let options = Options {
        existing,
        threads: console::threads(),
        cancel: &cancel,
        retry_failed: arguments.retry_failed,
        trial: Some(&try_case::command),
    };
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
    summarise(&plan, &manifest, &out, started.elapsed().as_secs_f64());
    let failed = failures(&manifest.failed, manifest.counts.cases, &out);
    if let Some(text) = failed {
        return Err(Failure::work(text));
    }
    hint(format_args!("crosshead report {}", out.display()));
    Ok(())
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
    match sweep.calibrate() {
        None => {
            check_calibration(&nominal)?;
            Ok((Claim::new(out, existing)?, nominal))
        }
        Some(_) => calibrated::plan(sweep, out, existing, cancel),
    }
}

/// `plan` with the recordings in another format, where one is asked for.
///
/// # Errors
/// A format that the plan cannot have.
pub(crate) fn with_format(plan: Plan, format: Option<FormatArgument>) -> Result<Plan, Failure> {
    Ok(match format {
        None => plan,
        Some(FormatArgument::Parquet) => plan.with_format(Format::Parquet)?,
        Some(FormatArgument::Mcap) => plan.with_format(Format::Mcap)?,
    })
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
pub fn read_plan(path: &Path) -> Result<Plan, Failure> {
    let sweep = Sweep::read(path)?;
    let nominal = sweep.nominal()?;
    if sweep.calibrate().is_none() {
        return Ok(nominal);
    }
    let root = default_folder(&nominal.name);
    calibrated::plan_if_kept(&sweep, &root)?.ok_or_else(|| {
        Failure::input(format!(
            "{}: this sweep calibrates its machine first, and {} does not hold that calibration: \
             make the dataset, or name its own sweep.yaml, which has the calibrated machine",
            path.display(),
            root.display()
        ))
    })
}

impl Arguments {
    /// The plan as far as it is known without calibrating anything.
    fn planned(&self, sweep: &Sweep, nominal: Plan, out: &Path) -> Result<Plan, Failure> {
        let plan = match sweep.calibrate() {
            None => nominal,
            Some(_) => match calibrated::plan_if_kept(sweep, out)? {
                Some(plan) => {
                    println!("calibrated before, and nothing has changed since");
                    plan
                }
                None => {
                    println!(
                        "the machine would be calibrated first; what follows is for the nominal \
                         one, without its uncertainty"
                    );
                    nominal
                }
            },
        };
        with_format(plan, self.format)
    }
}

fn failure(arguments: &Arguments, error: sweep::Error) -> Failure {
    match error {
        sweep::Error::TooManyCases { .. } => {
            Failure::input(format!("{}: cases: {error}", arguments.sweep.display()))
        }
        error => error.into(),
    }
}
