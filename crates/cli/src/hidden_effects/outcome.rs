//! What became of a case, and the file that has a line for each.

use super::outside::Outside;
use crate::Failure;
use crate::output::write_file;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Name of the file of cases.
pub const CASES: &str = "cases.jsonl";

/// What became of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Number of the case.
    pub case: u64,
    /// What tells the case from the same number of another file.
    pub fingerprint: String,
    /// The machine's name.
    pub machine: String,
    /// Noise of the accelerations, of their RMS.
    pub noise: f64,
    /// Amplitudes asked for, over the usual ones.
    pub size: f64,
    /// What was hidden.
    pub hidden: Vec<Hidden>,
    /// What was hidden that no catalogue has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<Outside>,
    /// Whether the joints followed another contact law.
    pub other_contact_law: bool,
    /// What the workflow found; none where it failed.
    pub found: Option<Explained>,
    /// Why it failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Processor time of the workflow, s, where the system tells it.
    pub cpu_seconds: Option<f64>,
}

/// A hidden effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Its name.
    pub effect: String,
    /// Its section of a machine file.
    pub section: Value,
}

impl Hidden {
    /// An effect that found no place.
    pub fn somewhere(name: &str) -> Self {
        Self {
            effect: name.to_owned(),
            section: Value::Null,
        }
    }
}

/// What `gap.json` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explained {
    /// The verdict.
    pub verdict: String,
    /// The effects that it names, the first first.
    pub named: Vec<Named>,
    /// Misfits in standard deviations of the noise: of the calibrated machine and of the explained
    /// one, on runs that were fitted and on runs that were not.
    pub gap: Gap,
    /// Wall-clock time, s.
    pub seconds: f64,
}

/// A named effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Its name.
    pub effect: String,
    /// Its joint, where it has one.
    pub joint: Option<String>,
    /// Its throw, where it has one.
    pub throw: Option<String>,
    /// The names of its rivals.
    pub rivals: Vec<String>,
}

/// Misfits, in standard deviations of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// What noise alone leaves.
    pub noise_floor: f64,
    /// Of the calibrated machine.
    pub before: f64,
    /// Of the explained one.
    pub after: f64,
    /// The same of runs that were held out.
    pub heldout_before: Option<f64>,
    /// See [`Gap::heldout_before`].
    pub heldout_after: Option<f64>,
}

impl Explained {
    /// From the content of `gap.json`.
    ///
    /// # Errors
    /// Content that is none.
    pub fn of(results: &Value) -> Result<Self, Failure> {
        let word = |value: &Value| value.as_str().map(str::to_owned);
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let named = list(&results["effects"]).into_iter().map(|effect| Named {
            effect: word(&effect["effect"]).unwrap_or_default(),
            joint: word(&effect["joint"]),
            throw: word(&effect["throw"]),
            rivals: list(&effect["rivals"])
                .iter()
                .filter_map(|rival| word(&rival["effect"]))
                .collect(),
        });
        Ok(Self {
            verdict: word(&results["verdict"]).unwrap_or_default(),
            named: named.collect(),
            gap: Gap::deserialize(&results["gap"]).map_err(Failure::work)?,
            seconds: results["seconds"].as_f64().unwrap_or_default(),
        })
    }

    /// The effect that is named first; else the verdict.
    pub fn first(&self) -> &str {
        let first = self.named.first();
        first.map_or(&self.verdict, |named| &named.effect)
    }
}

impl Named {
    /// Whether it is where `hidden` is, as far as both say.
    pub fn is_at(&self, hidden: &Hidden) -> bool {
        let same = |key: &str, place: &Option<String>| {
            let hidden = hidden.section[key].as_str();
            hidden.is_none() || place.is_none() || hidden == place.as_deref()
        };
        same("joint", &self.joint) && same("throw", &self.throw)
    }
}

impl Gap {
    /// Share of the distance to the floor that is gone on the runs held out; none where there was no
    /// distance.
    pub fn closed(&self) -> Option<f64> {
        let before = self.heldout_before? - self.noise_floor;
        (before > 0.0).then(|| {
            self.heldout_after
                .map(|after| 1.0 - (after - self.noise_floor) / before)
        })?
    }
}

/// The file of cases: a whole line for each that is done.
pub struct Ledger {
    path: PathBuf,
}

impl Ledger {
    /// That of a folder.
    pub fn of(folder: &Path) -> Self {
        Self {
            path: folder.join(CASES),
        }
    }

    /// Whether there is one.
    pub fn exists(&self) -> bool {
        self.path.exists()
    }

    /// The cases that are done, by their number. A last line that was cut off is taken out of the file.
    ///
    /// # Errors
    /// A line that is none, or a file that cannot be read.
    pub fn read(&self) -> Result<Vec<Outcome>, Failure> {
        let shown = self.path.display();
        let text = match std::fs::read_to_string(&self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(Failure::input(format!("{shown}: {error}"))),
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        if whole < text.len() {
            write_file(&self.path, &text.as_bytes()[..whole])?;
        }
        let line = |(i, line): (usize, &str)| -> Result<Outcome, Failure> {
            serde_json::from_str(line)
                .map_err(|error| Failure::input(format!("{shown}:{}: {error}", i + 1)))
        };
        let outcomes = text[..whole].lines().enumerate().map(line);
        let mut outcomes = outcomes.collect::<Result<Vec<_>, _>>()?;
        outcomes.sort_by_key(|outcome| outcome.case);
        outcomes.dedup_by_key(|outcome| outcome.case);
        Ok(outcomes)
    }

    /// Adds a case, in one piece, so that several processes may share the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&self, outcome: &Outcome) -> Result<(), Failure> {
        let mut line = serde_json::to_string(outcome).map_err(Failure::work)?;
        line.push('\n');
        let file = OpenOptions::new()
            .append(true)
            .create(true)
            .open(&self.path);
        file.and_then(|mut file| file.write_all(line.as_bytes()))
            .map_err(|error| Failure::unwritten(&self.path, error))
    }
}
