//! `crosshead hidden-effects`: the proof of `explain-gap` on recordings whose truth is known.
//!
//! Each case goes through the disk: a bundle is made, the workflow is given its folder and nothing
//! else, and what it writes is held against what was hidden.

use crate::output::hint;
use crate::{Failure, console, explain_gap, interrupt};
use bench::matrix::MATRIX;
use bench::outcome::CASES;
use bench::{Bench, Case, HiddenEffects, Ledger, Machine, Matrix, NOTHING, Outside};
use bench::{Recorder, cases};
use clap::Args;
use input::effects::CATALOGUE;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Arguments of `crosshead hidden-effects`.
#[derive(Args, Debug)]
#[command(after_help = "\
Each case makes a bundle of recordings of a machine. The contacts of that machine differ from the
stated ones, and effects are hidden in it (or none). The case then runs crosshead explain-gap on
the bundle alone. DIR/cases.jsonl gets a line per case, matrix.json and matrix.md the counts, and
cases/ machine, results and page of each explanation. Several processes may share a folder, each
with its own --cases and --resume.

Examples:
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --dry-run
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --cases 1..29
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --resume --only valve_loss

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 stopped.")]
pub struct Arguments {
    /// What is hidden in what (crosshead schema hidden-effects)
    #[arg(value_name = "SETTINGS.yaml")]
    settings: PathBuf,
    /// Folder to write into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Only cases that hide this effect, or nothing; may be repeated
    #[arg(long, value_name = "EFFECT")]
    only: Vec<String>,
    /// Only cases of these numbers, both ends included
    #[arg(long, value_name = "FIRST..LAST", value_parser = numbers)]
    cases: Option<RangeInclusive<u64>>,
    /// Continue a proof that was stopped
    #[arg(long)]
    resume: bool,
    /// Keep the true machine and the recordings, measured and simulated: some 10 MB a case
    #[arg(long)]
    keep: bool,
    /// List the cases, and write nothing
    #[arg(long)]
    dry_run: bool,
}

fn numbers(text: &str) -> Result<RangeInclusive<u64>, String> {
    let ends = text.split_once("..").unwrap_or((text, text));
    match (ends.0.trim().parse(), ends.1.trim().parse()) {
        (Ok(first), Ok(last)) if 0 < first && first <= last => Ok(first..=last),
        _ => Err("expected numbers from 1 on, e.g. 1..29".to_owned()),
    }
}

/// Makes the cases, explains them, and counts what was found.
///
/// # Errors
/// Invalid settings or machines, a folder with the cases of others, or files that cannot be
/// written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (settings, document) = HiddenEffects::read(&arguments.settings)?;
    let base = arguments.settings.parent().unwrap_or(Path::new(""));
    let machines = settings.machines.iter().enumerate();
    let machines: Vec<Machine> = machines
        .map(|(i, entry)| {
            let own = |error: input::Error| document.locate(error.under(format!("machines.{i}")));
            Machine::open(entry, base).map_err(|error| match error.place() {
                Some(_) => error,
                None => own(error),
            })
        })
        .collect::<Result<_, _>>()?;
    let cases = chosen(arguments, cases(&settings))?;
    if arguments.dry_run {
        list(&cases, &machines);
        return Ok(());
    }
    let out = &arguments.out;
    let ledger = Ledger::in_folder(out);
    if ledger.exists() && !arguments.resume {
        return Err(Failure::input(format!(
            "{} is already there; --resume continues it, --out DIR writes elsewhere",
            out.join(CASES).display()
        )));
    }
    let bench = Bench {
        recorder: Recorder::new(&settings),
        settings: &settings,
        machines: &machines,
        out,
        keep: arguments.keep,
    };
    let done = ledger.read().map_err(failure)?;
    let open = bench.open(&cases, &done).map_err(failure)?;
    std::fs::create_dir_all(out).map_err(|error| Failure::unwritten(out, error))?;
    let cancel = interrupt::flag()?;
    let count = open.len();
    for (i, case) in open.into_iter().enumerate() {
        let outcome = bench.outcome(case, |asked, folder| {
            let results = explain_gap::into_folder(asked, folder, &cancel);
            results.map_err(|failure| failure.message().to_owned())
        });
        if cancel.load(Ordering::Relaxed) {
            let done = ledger.read().map_err(failure)?;
            Matrix::new(&done).write(out).map_err(failure)?;
            return Err(Failure::interrupted(format!(
                "stopped: {i} of {count} cases are done; --resume continues from there"
            )));
        }
        let outcome = outcome.map_err(failure)?;
        ledger.add(&outcome).map_err(failure)?;
        if !console::is_quiet() {
            let (number, label) = (case.number, case.label());
            eprintln!("{} of {count}: case {number}, {label}: {outcome}", i + 1);
        }
    }
    let done = ledger.read().map_err(failure)?;
    let matrix = Matrix::new(&done);
    matrix.write(out).map_err(failure)?;
    print!("{}", matrix.summary());
    println!("{}", out.join(MATRIX[1]).display());
    hint(format_args!(
        "the page of each case is {}/cases/*/report.html",
        out.display()
    ));
    Ok(())
}

/// The failure of a bench.
fn failure(error: bench::Error) -> Failure {
    match error.is_of_input() {
        true => Failure::input(error),
        false => Failure::work(error),
    }
}

/// The cases that are asked for.
fn chosen(arguments: &Arguments, mut cases: Vec<Case>) -> Result<Vec<Case>, Failure> {
    let others = || Outside::ALL.map(Outside::name).into_iter().chain([NOTHING]);
    let names = || CATALOGUE.iter().map(|e| e.name).chain(others());
    if let Some(unknown) = arguments
        .only
        .iter()
        .find(|only| names().all(|n| n != *only))
    {
        let nearest = input::nearest(unknown, names());
        let hint = nearest.map_or(".".into(), |near| format!("; did you mean {near}?"));
        return Err(Failure::input(format!(
            "--only {unknown}: there is no such effect{hint} They are {}.",
            names().collect::<Vec<_>>().join(", ")
        )));
    }
    let count = cases.len();
    cases.retain(|case| {
        let range = arguments.cases.as_ref();
        let only = &arguments.only;
        range.is_none_or(|range| range.contains(&case.number))
            && (only.is_empty() || only.iter().any(|name| case.hides(name)))
    });
    match cases.is_empty() {
        true => Err(Failure::input(format!(
            "none of the {count} cases is asked for by --cases and --only"
        ))),
        false => Ok(cases),
    }
}

fn list(cases: &[Case], machines: &[Machine]) {
    for case in cases {
        let machine = &machines[case.machine];
        println!(
            "{:4}  {} ({} runs), noise {:.1} %, size {}: {}",
            case.number,
            machine.name,
            machine.runs.len(),
            100.0 * case.noise,
            case.size,
            case.label()
        );
    }
}
