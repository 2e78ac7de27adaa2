//! What became of a case, and the file that has a line for each.

use crate::error::Error;
use crate::outside::Outside;
use gap::Verdict;
use gap::results::{Effect, Results};
use recordings::WholeFile;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;
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
    /// Distinguishes the case from the same number of another file.
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
    /// Processor time of the workflow, s, if the system reports it.
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
    pub verdict: Verdict,
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
    /// Probability that it is what is there, 0 to 1; none in a file of an earlier version.
    #[serde(default)]
    pub probability: Option<f64>,
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
    /// From the results of an explanation.
    pub fn from_results(results: &Results) -> Self {
        let named = |effect: &Effect| Named {
            effect: effect.effect.clone(),
            joint: effect.joint.clone(),
            throw: effect.throw.clone(),
            probability: Some(effect.probability),
            rivals: effect
                .rivals
                .iter()
                .map(|rival| rival.effect.clone())
                .collect(),
        };
        let gap = &results.gap;
        Self {
            verdict: results.verdict,
            named: results.effects.iter().map(named).collect(),
            gap: Gap {
                noise_floor: gap.noise_floor,
                before: gap.before,
                after: gap.after,
                heldout_before: gap.heldout_before,
                heldout_after: gap.heldout_after,
            },
            seconds: results.seconds.unwrap_or_default(),
        }
    }

    /// The effect that is named first; else the verdict.
    pub fn first(&self) -> &str {
        let first = self.named.first();
        first.map_or(self.verdict.name(), |named| &named.effect)
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

/// What was found, in a line.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (&self.found, &self.error) {
            (Some(found), _) => {
                let named: Vec<&str> = found.named.iter().map(|n| n.effect.as_str()).collect();
                let named = match named.is_empty() {
                    true => "nothing named".to_owned(),
                    false => named.join(", "),
                };
                let (verdict, gap) = (found.verdict.name(), &found.gap);
                write!(
                    f,
                    "{verdict}, {named}, {:.2} to {:.2}",
                    gap.before, gap.after
                )?;
            }
            (None, error) => write!(f, "{}", error.as_deref().unwrap_or_default())?,
        }
        match self.cpu_seconds {
            Some(seconds) => write!(f, " ({seconds:.0} s)"),
            None => Ok(()),
        }
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
    pub fn in_folder(folder: &Path) -> Self {
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
    /// An invalid line, or a file that cannot be read.
    pub fn read(&self) -> Result<Vec<Outcome>, Error> {
        let shown = self.path.display();
        let text = match std::fs::read_to_string(&self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(Error::Cases(format!("{shown}: {error}"))),
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        if whole < text.len() {
            WholeFile::write(&self.path, &text[..whole])?;
        }
        let line = |(i, line): (usize, &str)| -> Result<Outcome, Error> {
            serde_json::from_str(line)
                .map_err(|error| Error::Cases(format!("{shown}:{}: {error}", i + 1)))
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
    pub fn add(&self, outcome: &Outcome) -> Result<(), Error> {
        let mut line = serde_json::to_string(outcome)?;
        line.push('\n');
        let file = OpenOptions::new()
            .append(true)
            .create(true)
            .open(&self.path);
        file.and_then(|mut file| file.write_all(line.as_bytes()))
            .map_err(|error| Error::file(&self.path, error))
    }
}
