//! `crosshead hidden-effects`: the proof of `explain-gap` on recordings whose truth is known.
//!
//! Each case goes through the disk: a bundle is made, the workflow is given its folder and nothing
//! else, and what it writes is held against what was hidden.

use crate::explain_gap::shown;
use crate::output::hint;
use crate::{Failure, console, interrupt};
use bench::matrix::MATRIX;
use bench::outcome::CASES;
use bench::{Bench, HiddenEffects, Ledger, Machine, Matrix, Recorder, cases, chosen, listed};
use clap::Args;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (settings, document) = HiddenEffects::read(&arguments.settings)?;
    let base = arguments.settings.parent().unwrap_or(Path::new(""));
    let machines = Machine::all(&settings, &document, base)?;
    let cases = chosen(cases(&settings), &arguments.only, arguments.cases.as_ref())?;
    if arguments.dry_run {
        print!("{}", listed(&cases, &machines));
        return Ok(());
    }
    let out = &arguments.out;
    if Ledger::in_folder(out).exists() && !arguments.resume {
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
    let cancel = interrupt::flag()?;
    let outcomes = bench.run(
        &cases,
        |asked, folder| {
            let results = shown(asked, folder, &cancel);
            results.map_err(|failure| failure.message().to_owned())
        },
        || cancel.load(Ordering::Relaxed),
        |[done, count], case, outcome| {
            if !console::is_quiet() {
                let (number, label) = (case.number, case.label());
                eprintln!("{done} of {count}: case {number}, {label}: {outcome}");
            }
        },
    )?;
    print!("{}", Matrix::new(&outcomes).summary());
    println!("{}", out.join(MATRIX[1]).display());
    hint(format_args!(
        "the page of each case is {}/cases/*/report.html",
        out.display()
    ));
    Ok(())
}
