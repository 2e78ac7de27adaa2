//! `gen-dataset`: a sweep becomes a labelled dataset.

mod calibrated;

use crate::{Failure, interrupt, try_case};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use recordings::{CaseWarning, FailedCase, Manifest};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use sweep::dataset::{Claim, Existing, Options, Progress, check_calibration, generate_in};
use sweep::sweep_file::Format;
use sweep::{Census, Plan, Sweep, simulate_cases};

/// Failed cases that are shown.
const SHOWN_FAILURES: usize = 5;

/// Arguments of `gen-dataset`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  gen-dataset pipelines/paper2.yaml
  gen-dataset pipelines/bearing-faults.yaml --out faults --threads 8
  gen-dataset pipelines/bearing-faults.yaml --out faults --resume
  gen-dataset pipelines/bearing-faults.yaml --out faults --resume --retry-failed
  gen-dataset pipelines/bearing-faults.yaml --dry-run

Exit status: 0 done; 1 the work failed, or some cases did; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The sweep file
    sweep: PathBuf,
    /// Folder of the dataset, or s3://BUCKET/PREFIX [default: datasets/NAME, NAME being the sweep's]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the recordings, instead of the sweep's own
    #[arg(long, value_enum)]
    format: Option<FormatArgument>,
    /// Threads that simulate [default: one per core]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Go on with a dataset that was interrupted
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Make the shards with failed cases again, whatever these failed of
    #[arg(long, requires = "resume")]
    retry_failed: bool,
    /// Replace a dataset that is there
    #[arg(long)]
    overwrite: bool,
    /// Tell what would be made, from a measured sample, and write nothing
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
        return dry_run(&arguments.planned(&sweep, nominal, &out)?);
    }
    let cancel = interrupt::flag()?;
    let existing = match (arguments.resume, arguments.overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let threads = threads(arguments.threads);
    let options = Options {
        existing,
        threads,
        cancel: &cancel,
        retry_failed: arguments.retry_failed,
        trial: Some(&try_case::command),
    };
    let started = Instant::now();
    let claim = || claim(&sweep, nominal, &out, existing, &cancel);
    let (claim, plan) = on_threads(threads, claim)?;
    let plan = with_format(plan, arguments.format);
    // Before hours of simulation.
    warn(&plan.census().mistakes());
    let mut bar = Bar::default();
    let manifest = generate_in(claim, &plan, &options, &simulate_cases, &mut bar)
        .map_err(|error| failure(arguments, error))?;
    bar.finish();
    summarise(&plan, &manifest, &out, started.elapsed().as_secs_f64());
    let failed = failures(&manifest.failed, manifest.counts.cases, &out);
    failed.map_or(Ok(()), |text| Err(Failure::work(text)))
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
            check_calibration(&nominal).map_err(failed)?;
            Ok((Claim::new(out, existing).map_err(failed)?, nominal))
        }
        Some(_) => calibrated::plan(sweep, out, existing, cancel),
    }
}

/// Threads asked for, or one per core.
pub(crate) fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(
        || std::thread::available_parallelism().map_or(1, Into::into),
        usize::from,
    )
}

/// `plan` with the recordings in another format, where one is asked for.
pub(crate) fn with_format(plan: Plan, format: Option<FormatArgument>) -> Plan {
    match format {
        None => plan,
        Some(FormatArgument::Parquet) => plan.with_format(Format::Parquet),
        Some(FormatArgument::Mcap) => plan.with_format(Format::Mcap),
    }
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
        Ok(with_format(plan, self.format))
    }
}

/// Does `work`, whatever it does in parallel on so many threads.
fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(Failure::work)?.install(work)
}

fn failure(arguments: &Arguments, error: sweep::Error) -> Failure {
    match error {
        sweep::Error::TooManyCases { .. } => {
            Failure::input(format!("{}: cases: {error}", arguments.sweep.display()))
        }
        error => failed(error),
    }
}

/// The failure that an error of a dataset is.
pub(crate) fn failed(error: sweep::Error) -> Failure {
    if error.is_input() {
        Failure::input(error)
    } else {
        Failure::work(error)
    }
}

/// The bar on standard error: rate and time left; nothing where that is no terminal.
#[derive(Default)]
pub(crate) struct Bar {
    bar: Option<ProgressBar>,
    failed: u64,
}

impl Progress for Bar {
    fn begins(&mut self, cases: u64, finished: u64) {
        self.show(cases, finished, "cases");
    }

    fn warning(&mut self, text: &str) {
        warn(&[text.to_owned()]);
    }

    fn case_done(&mut self, _case: u64, failed: bool) {
        let Some(bar) = &self.bar else { return };
        bar.inc(1);
        if failed {
            self.failed += 1;
            bar.set_message(format!("{} failed", self.failed));
        }
    }

    fn diagrams_begin(&mut self, values: u64, finished: u64) {
        self.finish();
        self.show(values, finished, "values of bifurcation diagrams");
    }

    fn values_done(&mut self, values: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(values);
        }
    }
}

impl Bar {
    fn show(&mut self, total: u64, finished: u64, what: &str) {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        let template =
            format!("{{bar:40}} {{pos}}/{{len}} {what}  {{per_sec}}  {{eta}} left  {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        bar.set_position(finished);
        bar.reset_eta();
        self.bar = Some(bar);
    }

    /// Takes it off the terminal.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Says what is wrong.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}

/// Prints what a finished dataset has, and says what is wrong with its labels beside the mistakes that
/// were told when it was begun.
pub(crate) fn summarise(plan: &Plan, manifest: &Manifest, out: &Path, seconds: f64) {
    let bytes: u64 = manifest.files.iter().map(|file| file.bytes).sum();
    let rows: u64 = manifest
        .counts
        .rows
        .values()
        .flat_map(|of| of.values())
        .sum();
    println!(
        "{}: {} cases, {rows} rows, {} files, {:.1} MB in {seconds:.1} s",
        out.display(),
        manifest.counts.cases,
        // With the manifest and SHA256SUMS.
        manifest.files.len() + 2,
        bytes as f64 / 1e6
    );
    let census = Census::of(plan, manifest);
    println!("{census}");
    let mut warnings = census.warnings();
    let told = plan.census().mistakes();
    warnings.retain(|warning| !told.contains(warning));
    warn(&warnings);
    if let Some(text) = doubtful(&manifest.warnings) {
        println!("{text}");
    }
}

/// What is doubtful about cases, if anything is: the first few.
fn doubtful(all: &[CaseWarning]) -> Option<String> {
    if all.is_empty() {
        return None;
    }
    let mut text = format!("warnings: {}", all.len());
    for CaseWarning { case_id, warning } in all.iter().take(SHOWN_FAILURES) {
        text += &format!("\n  {case_id}: {warning}");
    }
    if all.len() > SHOWN_FAILURES {
        let more = all.len() - SHOWN_FAILURES;
        text += &format!("\n  and {more} more, in `warnings` of manifest.json");
    }
    Some(text)
}

/// What is to be said of the cases that failed, if any did: the first few, each with the command that
/// runs it again.
pub(crate) fn failures(failed: &[FailedCase], cases: u64, out: &Path) -> Option<String> {
    if failed.is_empty() {
        return None;
    }
    let mut text = format!("{} of {cases} cases failed:", failed.len());
    for case in failed.iter().take(SHOWN_FAILURES) {
        let (id, reason, again) = (&case.case_id, &case.reason, case.command_in(out));
        text += &format!("\n  {id}: {reason}\n    again: {again}");
    }
    if failed.len() > SHOWN_FAILURES {
        let more = failed.len() - SHOWN_FAILURES;
        text += &format!("\n  and {more} more, in `failed` of manifest.json and in _sweep/logs");
    }
    Some(text)
}

/// Says how large the dataset will be and how long it will take, from a few simulated cases.
fn dry_run(plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate();
    println!(
        "{}: {} cases, {} rows, {} shards, {:.0} revolutions to simulate",
        plan.name, estimate.cases, estimate.rows, estimate.shards, estimate.revolutions
    );
    println!(
        "recordings before compression: {:.1} MB",
        estimate.bytes / 1e6
    );
    println!("{}", plan.census());
    warn(&plan.census().warnings());
    let timing = plan.time_cases().map_err(failed)?;
    println!(
        "time: {:.0} s on one core, measured on {} cases ({:.2} s each)",
        timing.all_s,
        timing.sampled,
        timing.sample_s / timing.sampled
    );
    dry_run_diagrams(plan)?;
    if estimate.cases > sweep::plan::MOST_CASES {
        println!(
            "a dataset can have at most {} cases: this sweep will be refused",
            sweep::plan::MOST_CASES
        );
    }
    Ok(())
}

/// The same for the bifurcation diagrams, from a few revolutions of each.
fn dry_run_diagrams(plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate_diagrams();
    if estimate.diagrams == 0 {
        return Ok(());
    }
    println!(
        "bifurcation diagrams: {}, {} values, {} revolutions to simulate, {:.1} MB before compression",
        estimate.diagrams,
        estimate.values,
        estimate.revolutions,
        estimate.bytes / 1e6
    );
    let timing = plan.time_diagrams().map_err(failed)?;
    println!(
        "time: {:.0} s more on one core, measured on {} revolutions",
        timing.all_s, timing.sampled
    );
    Ok(())
}
