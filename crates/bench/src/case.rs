//! One case: made, explained, and held against what is true.

use crate::error::Error;
use crate::machine::Machine;
use crate::matrix::Matrix;
use crate::outcome::{CASES, Explained, Hidden, Ledger, Outcome};
use crate::outside::Outside;
use crate::plan::Case;
use crate::recordings::{Clean, Recorder};
use crate::settings::HiddenEffects;
use crate::truth;
use ::recordings::WholeFile;
use gap::{Asked, Results};
use input::calibration::Calibration;
use rand::RngExt;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::Path;

/// How often a place and values are drawn for an effect before it is given up.
const DRAWS: usize = 100;
/// An effect that changes no channel by this share of its RMS is not there.
const THERE: f64 = 1e-5;
/// Name of the file of the true machine, where it is kept.
const TRUTH: &str = "truth.yaml";

/// Makes and explains cases.
pub struct Bench<'a> {
    /// What is hidden in what.
    pub settings: &'a HiddenEffects,
    /// The machines of the settings.
    pub machines: &'a [Machine],
    /// How recordings are made.
    pub recorder: Recorder,
    /// The folder of the proof.
    pub out: &'a Path,
    /// Whether recordings are kept.
    pub keep: bool,
}

/// A machine with what is true of it, and its runs.
struct Made {
    hidden: Vec<Hidden>,
    /// Its machine file.
    truth: Value,
    other_contact_law: bool,
    clean: Vec<Clean>,
}

impl Bench<'_> {
    /// Distinguishes a case from that of the same number under other settings. SHA-256 in hexadecimal.
    fn fingerprint(&self, case: &Case) -> String {
        let machine = &self.machines[case.machine];
        let runs: Vec<&[(String, Value)]> = machine.runs.iter().map(|r| &r.settings[..]).collect();
        let content = format!(
            "{} {} {:?} {:?} {:?} {} {runs:?} {} {} {}",
            env!("CARGO_PKG_VERSION"),
            case.id(),
            self.recorder,
            self.settings.other_contact_law,
            self.settings.other_forms,
            machine.section,
            machine.pressure,
            case.noise,
            case.size,
        );
        format!("{:x}", Sha256::digest(content))
    }

    /// Those of `cases` that are not among the outcomes `done`.
    ///
    /// # Errors
    /// An outcome of a case of that number under other settings.
    pub fn open<'c>(&self, cases: &'c [Case], done: &[Outcome]) -> Result<Vec<&'c Case>, Error> {
        let mut open = Vec::new();
        for case in cases {
            match done.iter().find(|outcome| outcome.case == case.number) {
                None => open.push(case),
                Some(earlier) if earlier.fingerprint == self.fingerprint(case) => {}
                Some(_) => {
                    return Err(Error::Cases(format!(
                        "{} has another case {}: the settings, a machine or the program have changed; --out DIR \
                         writes elsewhere",
                        self.out.join(CASES).display(),
                        case.number
                    )));
                }
            }
        }
        Ok(open)
    }

    /// Makes those of `cases` that are not in the ledger of the folder yet, adds them to it, and writes the counts over all
    /// that are there, which it gives back. `explain` explains a bundle into a folder; it says why where it cannot. `done` is
    /// told which case of how many came to what.
    ///
    /// # Errors
    /// A ledger with the cases of others; files that cannot be written; [`Error::Stopped`] once `is_stopped`.
    pub fn run(
        &self,
        cases: &[Case],
        explain: impl Fn(&Asked, &Path) -> Result<Results, String>,
        is_stopped: impl Fn() -> bool,
        done: impl Fn([usize; 2], &Case, &Outcome),
    ) -> Result<Vec<Outcome>, Error> {
        let ledger = Ledger::in_folder(self.out);
        let open = self.open(cases, &ledger.read()?)?;
        std::fs::create_dir_all(self.out).map_err(|error| Error::file(self.out, error))?;
        let count = open.len();
        let counted = || {
            let outcomes = ledger.read()?;
            Matrix::new(&outcomes).write(self.out)?;
            Ok(outcomes)
        };
        for (i, case) in open.into_iter().enumerate() {
            let outcome = self.outcome(case, &explain);
            if is_stopped() {
                return counted().and(Err(Error::Stopped { done: i, count }));
            }
            let outcome = outcome?;
            ledger.add(&outcome)?;
            done([i + 1, count], case, &outcome);
        }
        counted()
    }

    /// Makes the recordings of a case and has `explain` explain them into a folder; it says why where it
    /// cannot. What cannot be hidden, or explained, is an outcome, too.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn outcome(
        &self,
        case: &Case,
        explain: impl FnOnce(&Asked, &Path) -> Result<Results, String>,
    ) -> Result<Outcome, Error> {
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
            outside: case.outside,
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
        if self.keep {
            let text = input::yaml::to_string(&made.truth)?;
            WholeFile::write(&folder.join(TRUTH), &text)?;
        }
        let start = cpu_seconds();
        let calibration = Calibration::with_defaults(vec![bundle.clone()]);
        let asked = Asked {
            calibration: &calibration,
            base: Path::new(""),
            allow_outside: false,
            locate: &|error| error,
        };
        let found = explain(&asked, &folder);
        outcome.cpu_seconds = start.zip(cpu_seconds()).map(|(start, end)| end - start);
        match found {
            Ok(results) => outcome.found = Some(Explained::from_results(&results)),
            Err(message) => outcome.error = Some(message),
        }
        if !self.keep {
            for part in [&bundle, &folder.join("simulated"), &folder.join("baseline")] {
                if part.exists() {
                    std::fs::remove_dir_all(part).map_err(|e| Error::file(part, e))?;
                }
            }
        }
        Ok(outcome)
    }

    /// Draws what is true in a case until the machine runs with it and each effect is seen; or says
    /// why that cannot be.
    fn made(&self, case: &Case) -> Result<Result<Made, String>, Error> {
        let machine = &self.machines[case.machine];
        let seed = u64::from(self.settings.seed.map_or(0, |seed| seed.get()));
        let mut random = stream(seed, case.number, Purpose::Variation);
        let share = self.settings.other_contact_law.as_ref();
        let other_contact_law = random.random::<f64>() < share.map_or(0.0, |share| share.si())
            || case.outside == Some(Outside::ContactLaw);
        let mut truth = truth::contacts(machine, other_contact_law, &mut random)?;
        if case.outside == Some(Outside::DataSheet) {
            truth::wrong_data_sheet(&mut truth, &mut random)?;
        }
        let other_forms = self.settings.other_forms.unwrap_or_default();
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
            let effects: Vec<Vec<Value>> = drawn
                .map(|entry| truth::effect(entry, machine, case.size, other_forms, &mut random))
                .collect();
            let items = effects.concat();
            let seen = |effect: &Vec<Value>| -> Result<(), String> {
                match alone(effect)?.differs(&bare) > THERE {
                    true => Ok(()),
                    false => Err("it changes nothing".to_owned()),
                }
            };
            let clean = effects
                .iter()
                .try_for_each(seen)
                .and_then(|()| self.recorder.runs(machine, &with(&items)));
            match clean {
                Ok(mut clean) => {
                    if let Some(outside) = case.outside {
                        clean
                            .iter_mut()
                            .for_each(|run| self.recorder.change(run, outside));
                    }
                    let hidden = case
                        .hidden
                        .iter()
                        .zip(&effects)
                        .map(|(entry, items)| Hidden {
                            effect: entry.name.to_owned(),
                            section: items[0][entry.name].clone(),
                        });
                    return Ok(Ok(Made {
                        hidden: hidden.collect(),
                        truth: with(&items),
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

/// Processor time of this process, s, as Linux reports it in hundredths of a second (proc(5): user and
/// system time are the 14th and 15th field, and the 2nd, a name in brackets, may hold blanks).
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, fields) = text.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11);
    let mut next = || times.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}
