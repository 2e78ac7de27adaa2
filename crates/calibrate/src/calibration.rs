//! A calibration into a folder: from settings to `calibration.json`, the calibrated `machine.yaml` and what
//! pictures are drawn from.

use crate::comparison::compare;
use crate::earlier::{self, Existing, Outcome};
use crate::error::Error;
use crate::fit::Fit;
use crate::meter::Meter;
use crate::pictures;
use crate::pressure_gap::pressure_gaps;
use crate::problem::Problem;
use crate::results::{Found, MACHINE, RESULTS, Results};
use crate::sensors::{Fitted, Sensors};
use crate::stages::{self, Searched, Watcher};
use crate::task::{Settings, Task, task};
use input::MachineFile;
use recordings::WholeFile;
use std::path::{Path, PathBuf};

/// A calibration that is on the disk.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// The calibrated machine file.
    pub machine: PathBuf,
    /// The content of `calibration.json`.
    pub results: Results,
    /// True where it was there before, and nothing was to be done.
    pub reused: bool,
}

/// A calibration whose input has been read and found to be usable.
pub struct Prepared {
    task: Task,
    fingerprint: String,
    out: PathBuf,
    existing: Existing,
    earlier: Option<Results>,
}

/// Reads everything that a calibration into the folder `out` needs, and what is there of it already.
/// Nothing is written.
///
/// # Errors
/// Settings, a bundle, a machine or recordings that cannot be used or contradict each other, or a
/// folder that is in the way.
pub fn prepare(settings: &Settings, out: &Path, existing: Existing) -> Result<Prepared, Error> {
    earlier::check_folder::<Results>(out, existing)?;
    let task = task(settings)?;
    task.refuse_without_mean()?;
    let fingerprint = task.fingerprint();
    Ok(Prepared {
        earlier: earlier::read_existing(out, existing, &fingerprint)?,
        task,
        fingerprint,
        existing,
        out: out.to_owned(),
    })
}

impl Outcome for Results {
    const FILE: &str = RESULTS;
    const NAME: &str = "a calibration";

    fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    fn is_complete(&self) -> bool {
        self.complete
    }
}

impl Prepared {
    /// Whether it is there already, complete.
    pub fn is_done(&self) -> bool {
        self.earlier.as_ref().is_some_and(Results::is_complete)
    }

    /// Searches, unless it is done. Where `watcher` stops the search, the best result so far is written,
    /// marked as incomplete. Each evaluation is written to the disk at once. A calibration that was
    /// stopped or killed therefore continues from there, and ends with the same results.
    ///
    /// # Errors
    /// A machine that cannot be simulated, or files that cannot be written.
    pub fn finish(self, watcher: &mut dyn Watcher) -> Result<Calibrated, Error> {
        let Prepared {
            mut task,
            fingerprint,
            out,
            existing,
            earlier,
        } = self;
        let machine = out.join(MACHINE);
        if let Some(results) = earlier.filter(Results::is_complete) {
            return Ok(Calibrated {
                machine,
                results,
                reused: true,
            });
        }
        let checkpoint = earlier::checkpoint(&out, existing, &fingerprint)?;
        task.problem.meter = Meter::with_checkpoint(checkpoint);
        let Searched {
            mut fit,
            mut corrected,
            evaluations,
        } = stages::search(&mut task, watcher)?;
        if let Some((problem, better)) = corrected.as_mut().and_then(|found| found.fit.take()) {
            task.problem = problem;
            let complete = fit.complete;
            fit = better;
            fit.complete &= complete;
        }
        // A search that was stopped is not compared with others.
        let transfer = match fit.complete {
            true => stages::relations(&task, &fit, watcher)?,
            false => None,
        };
        let x = fit.coordinates();
        pictures::write(&out, &compare(&task.problem, &task.runs, &x)?)?;
        let sensors = Sensors::from_recordings(&Fitted {
            problem: &task.problem,
            x: &x,
            misfits: fit.runs.iter().map(|run| run.calibrated).collect(),
            runs: &task.runs,
            encoded: &task.encoded,
        })?;
        let text = calibrated(&task.problem, &fit, &sensors)?;
        WholeFile::write(&machine, &text)?;
        // Where the gas was not fitted, its gaps are not reported.
        let mut fitted = fit.estimates.iter().map(|e| &e.parameter.path);
        let gas = match fitted.any(|path| path.contains("cylinder.")) {
            true => Some(pressure_gaps(&task.problem, &task.runs, &x)?),
            false => None,
        };
        if let Some(gaps) = &gas {
            pictures::write_indicator(&out, gaps)?;
        }
        let found = Found {
            fit: &fit,
            transfer,
            corrected: corrected.as_ref(),
            sensors: &sensors,
            gas: gas.as_deref(),
            fingerprint,
            evaluations,
        };
        // What makes the folder whole comes last.
        let results = Results::from_search(&task, found)?;
        let path = out.join(RESULTS);
        let text = serde_json::to_string_pretty(&results);
        let text = text.map_err(|error| Error::file(&path, error))?;
        WholeFile::write(&path, &text)?;
        if fit.complete {
            earlier::remove_checkpoint(&out)?;
        }
        Ok(Calibrated {
            machine,
            results,
            reused: false,
        })
    }
}

/// The machine file with what was found, as YAML.
fn calibrated(problem: &Problem, fit: &Fit, sensors: &Sensors) -> Result<String, Error> {
    let mut tree = problem.tree.clone();
    for estimate in fit.estimates.iter().filter(|e| e.interval.is_some()) {
        estimate.parameter.write(&mut tree, estimate.value)?;
    }
    sensors.write(&mut tree)?;
    Ok(MachineFile::from_tree(&tree).and_then(|file| file.to_yaml())?)
}
