//! `crosshead hidden-effects`: the proof of `explain-gap` on recordings whose truth is known.
//!
//! Each case goes through the disk: a bundle is made, the workflow is given its folder and nothing
//! else, and what it writes is held against what was hidden.

mod machine;
mod matrix;
mod outcome;
mod plan;
mod recordings;
mod truth;

use crate::calibrate::output::write_file;
use crate::{Failure, explain_gap};
use clap::Args;
use input::calibration::Calibration;
use input::effects::CATALOGUE;
use input::hidden_effects::HiddenEffects;
use machine::Machine;
use matrix::Matrix;
use outcome::{Explained, Hidden, Ledger, Outcome};
use plan::{Case, NOTHING};
use rand::RngExt;
use recordings::{Clean, Recorder};
use scalar::random::{Purpose, stream};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Names of the files with what all cases come to.
pub const MATRIX: [&str; 2] = ["matrix.json", "matrix.md"];
/// How often a place and values are drawn for an effect before it is given up.
const DRAWS: usize = 100;
/// An effect that changes no channel by this share of its RMS is not there.
const THERE: f64 = 1e-5;

/// Arguments of `crosshead hidden-effects`.
#[derive(Args, Debug)]
#[command(after_help = "\
Each case makes a bundle of recordings of a machine whose contacts are not those that are told, hides
effects in it (or none), and explains it as crosshead explain-gap does, which sees the bundle alone.
DIR/cases.jsonl gets a line per case, matrix.json and matrix.md what they come to, and cases/ machine,
results and page of each explanation. Several processes may share a folder, each with --cases of
its own and --resume.

Examples:
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --dry-run
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --cases 1..26
  crosshead hidden-effects pipelines/hidden-effects.yaml --out proof --resume --only valve_loss

Exit status: 0 done; 1 the work failed or was stopped; 2 the input or the arguments are wrong.")]
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
    /// Go on with a proof that was stopped
    #[arg(long)]
    resume: bool,
    /// Keep the recordings, measured and simulated: some 10 MB a case
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
        _ => Err("expected numbers from 1 on, e.g. 1..26".to_owned()),
    }
}

/// Makes the cases, explains them, and tells what was found.
///
/// # Errors
/// Settings or machines that are none, a folder with the cases of others, or files that cannot be
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
    let cases = chosen(arguments, plan::cases(&settings))?;
    if arguments.dry_run {
        list(&cases, &machines);
        return Ok(());
    }
    let out = &arguments.out;
    let ledger = Ledger::of(out);
    if ledger.exists() && !arguments.resume {
        return Err(Failure::input(format!(
            "{} is already there; --resume goes on with it, --out DIR writes elsewhere",
            out.join(outcome::CASES).display()
        )));
    }
    let bench = Bench {
        recorder: Recorder::new(&settings),
        settings: &settings,
        machines: &machines,
        out,
        keep: arguments.keep,
    };
    let done = ledger.read()?;
    for case in &cases {
        let earlier = done.iter().find(|outcome| outcome.case == case.number);
        if earlier.is_some_and(|earlier| earlier.fingerprint != bench.fingerprint(case)) {
            return Err(Failure::input(format!(
                "{} has another case {}: the settings, a machine or the program have changed; \
                 --out DIR writes elsewhere",
                out.join(outcome::CASES).display(),
                case.number
            )));
        }
    }
    std::fs::create_dir_all(out).map_err(|error| Failure::unwritten(out, error))?;
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(Failure::work)?;
    let open = cases
        .iter()
        .filter(|case| done.iter().all(|outcome| outcome.case != case.number));
    let count = open.clone().count();
    for (i, case) in open.enumerate() {
        let outcome = bench.outcome(case, &cancel);
        if cancel.load(Ordering::Relaxed) {
            write(&Matrix::of(&ledger.read()?), out)?;
            return Err(Failure::work(format!(
                "stopped: {i} of {count} cases are done; --resume goes on from there"
            )));
        }
        let outcome = outcome?;
        ledger.add(&outcome)?;
        eprintln!("{} of {count}: {}", i + 1, told(case, &outcome));
    }
    let done = ledger.read()?;
    let matrix = Matrix::of(&done);
    write(&matrix, out)?;
    print!("{}", matrix.summary());
    println!("{}", out.join(MATRIX[1]).display());
    Ok(())
}

/// The cases that are asked for.
fn chosen(arguments: &Arguments, mut cases: Vec<Case>) -> Result<Vec<Case>, Failure> {
    let names = || CATALOGUE.iter().map(|e| e.name).chain([NOTHING]);
    if let Some(unknown) = arguments
        .only
        .iter()
        .find(|only| names().all(|n| n != *only))
    {
        let nearest = input::nearest(unknown, names());
        let hint = nearest.map_or(String::new(), |near| format!("; did you mean {near}?"));
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

/// A case in a line.
fn told(case: &Case, outcome: &Outcome) -> String {
    let what = match (&outcome.found, &outcome.error) {
        (Some(found), _) => {
            let named: Vec<&str> = found.named.iter().map(|n| n.effect.as_str()).collect();
            let (before, after) = (found.gap.before, found.gap.after);
            let named = match named.is_empty() {
                true => "nothing named".to_owned(),
                false => named.join(", "),
            };
            format!("{}, {named}, {before:.2} to {after:.2}", found.verdict)
        }
        (None, error) => error.clone().unwrap_or_default(),
    };
    let seconds = outcome.cpu_seconds;
    let seconds = seconds.map_or(String::new(), |seconds| format!(" ({seconds:.0} s)"));
    format!("case {}, {}: {what}{seconds}", case.number, case.label())
}

/// Writes what the cases come to.
fn write(matrix: &Matrix, out: &Path) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(&matrix.json()).map_err(Failure::work)?;
    write_file(&out.join(MATRIX[0]), text.as_bytes())?;
    write_file(&out.join(MATRIX[1]), matrix.markdown().as_bytes())
}

/// Makes and explains cases.
struct Bench<'a> {
    settings: &'a HiddenEffects,
    machines: &'a [Machine],
    recorder: Recorder,
    out: &'a Path,
    keep: bool,
}

/// A machine with what is true of it, and its runs.
struct Made {
    hidden: Vec<Hidden>,
    other_contact_law: bool,
    clean: Vec<Clean>,
}

impl Bench<'_> {
    /// What tells a case from that of the same number under other settings. SHA-256 in hexadecimal.
    fn fingerprint(&self, case: &Case) -> String {
        let machine = &self.machines[case.machine];
        let runs: Vec<&[(String, Value)]> = machine.runs.iter().map(|r| &r.settings[..]).collect();
        let content = format!(
            "{} {} {:?} {:?} {} {runs:?} {} {} {}",
            env!("CARGO_PKG_VERSION"),
            case.id(),
            self.recorder,
            self.settings.other_contact_law,
            machine.section,
            machine.pressure,
            case.noise,
            case.size,
        );
        format!("{:x}", Sha256::digest(content))
    }

    /// Makes the recordings of a case and explains them. What cannot be hidden, or explained, is an
    /// outcome, too.
    ///
    /// # Errors
    /// Files that cannot be written.
    fn outcome(&self, case: &Case, cancel: &AtomicBool) -> Result<Outcome, Failure> {
        let machine = &self.machines[case.machine];
        let mut outcome = Outcome {
            case: case.number,
            fingerprint: self.fingerprint(case),
            machine: machine.name.clone(),
            noise: case.noise,
            size: case.size,
            hidden: case
                .hidden
                .iter()
                .map(|entry| Hidden::somewhere(entry.name))
                .collect(),
            other_contact_law: false,
            found: None,
            error: None,
            cpu_seconds: None,
        };
        let made = match self.made(case)? {
            Ok(made) => made,
            Err(reason) => {
                outcome.error = Some(format!("cannot be made: {reason}"));
                return Ok(outcome);
            }
        };
        outcome.hidden = made.hidden;
        outcome.other_contact_law = made.other_contact_law;
        let folder = self.out.join("cases").join(case.id());
        let bundle = folder.join("bundle");
        self.recorder
            .write(machine, &made.clean, case.noise, case.number, &bundle)?;
        let start = cpu_seconds();
        let calibration = Calibration::of(vec![bundle.clone()]);
        let found = explain_gap::into_folder(&calibration, &folder, cancel);
        outcome.cpu_seconds = start.zip(cpu_seconds()).map(|(start, end)| end - start);
        match found.and_then(|results| Explained::of(&results)) {
            Ok(found) => outcome.found = Some(found),
            Err(Failure::Input(message) | Failure::Work(message)) => outcome.error = Some(message),
        }
        if !self.keep {
            for part in [&bundle, &folder.join("simulated"), &folder.join("baseline")] {
                if part.exists() {
                    std::fs::remove_dir_all(part).map_err(|e| Failure::unwritten(part, e))?;
                }
            }
        }
        Ok(outcome)
    }

    /// Draws what is true in a case until the machine runs with it and each effect is seen; or says
    /// why that cannot be.
    fn made(&self, case: &Case) -> Result<Result<Made, String>, Failure> {
        let machine = &self.machines[case.machine];
        let seed = u64::from(self.settings.seed.map_or(0, |seed| seed.get()));
        let mut random = stream(seed, case.number, Purpose::Variation);
        let share = self.settings.other_contact_law.as_ref();
        let other_contact_law = random.random::<f64>() < share.map_or(0.0, |share| share.si());
        let truth = truth::contacts(machine, other_contact_law, &mut random)?;
        let with = |effects: &[Value]| {
            let mut tree = truth.clone();
            tree["effects"] = effects.to_vec().into();
            tree
        };
        let last = &machine.runs[machine.runs.len() - 1];
        let alone = |effects: &[Value]| self.recorder.run(machine, &with(effects), last);
        let bare = match alone(&[]) {
            Ok(bare) => bare,
            Err(reason) => return Ok(Err(reason)),
        };
        let mut random = stream(seed, case.number, Purpose::Design);
        let mut reason = String::new();
        for _ in 0..DRAWS {
            let drawn = case.hidden.iter();
            let items: Vec<Value> = drawn
                .map(|entry| truth::effect(entry, machine, case.size, &mut random))
                .collect();
            let seen = |item: &Value| -> Result<(), String> {
                match alone(std::slice::from_ref(item))?.differs(&bare) > THERE {
                    true => Ok(()),
                    false => Err("it changes nothing".to_owned()),
                }
            };
            let clean = items
                .iter()
                .try_for_each(seen)
                .and_then(|()| self.recorder.runs(machine, &with(&items)));
            match clean {
                Ok(clean) => {
                    let hidden = case.hidden.iter().zip(items).map(|(entry, item)| Hidden {
                        effect: entry.name.to_owned(),
                        section: item[entry.name].clone(),
                    });
                    return Ok(Ok(Made {
                        hidden: hidden.collect(),
                        other_contact_law,
                        clean,
                    }));
                }
                Err(why) => reason = why,
            }
        }
        Ok(Err(reason))
    }
}

/// Processor time of this process, s, as Linux tells it in hundredths of a second (proc(5): user and
/// system time are the 14th and 15th field, and the 2nd, a name in brackets, may hold blanks).
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, fields) = text.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11);
    let mut next = || times.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}
