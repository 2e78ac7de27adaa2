//! A sweep becomes a labelled dataset.

use crate::calibrate::Watch;
use crate::failure::wrong;
use crate::interruptible::{Shared, interruptible};
use crate::machine::Machine;
use cli::Failure;
use cli::report::{self, PAGE};
use cli::try_case;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};
use sweep::dataset::{Claim, Existing, Options, Progress, Trial, check_calibration, generate_in};
use sweep::sweep_file::{Uncertainty, Undetermined};
use sweep::{Plan, Sweep, simulate_cases};

/// Writes the dataset of the sweep file `sweep` to the folder `out`; gives the folder, and what is wrong with it.
///
/// `machine` takes the place of the sweep's own. `calibration` is the folder of a calibration, whose machine and
/// uncertainty do: `uncertainty` is `sampled` or `ignored`, `undetermined` is `prior` or `nominal`.
/// `channels` are those that are recorded, all of the machine's where none are given.
///
/// # Errors
/// Wrong input, an output that cannot be written, or Ctrl-C. Cases that failed are none: the manifest names them.
#[pyfunction]
#[pyo3(signature = (sweep, machine, calibration, uncertainty, undetermined, channels, out, existing, threads, progress))]
pub fn generate(
    py: Python<'_>,
    sweep: PathBuf,
    machine: Option<&Machine>,
    calibration: Option<PathBuf>,
    uncertainty: &str,
    undetermined: &str,
    channels: Option<Vec<String>>,
    out: PathBuf,
    existing: &str,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PathBuf, Vec<String>)> {
    let existing = match existing {
        "resume" => Existing::Resume,
        "overwrite" => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let asked = Asked::new(machine, calibration, uncertainty, undetermined, channels)?;
    interruptible(py, progress, |shared| {
        let (sweep, nominal) = asked.planned(&sweep)?;
        nominal.check_size()?;
        let (claim, plan) = match asked.calibrates(&sweep) {
            false => {
                check_calibration(&nominal)?;
                (Claim::new(&out, existing)?, nominal)
            }
            true => sweep.claim(nominal, &out, existing, |prepared, folder| {
                let done = prepared.finish(&mut Watch(shared)).map_err(Failure::work)?;
                if !done.reused {
                    report::write(folder, &folder.join(PAGE))?;
                }
                match done.results.complete {
                    true => Ok(()),
                    false => Err(Failure::interrupted("stopped during the calibration")),
                }
            })?,
        };
        let plan = asked.with_channels(plan)?;
        let mut shown = Shown {
            shared,
            warnings: plan.census().mistakes(),
        };
        let options = Options {
            existing,
            threads: threads.unwrap_or_else(cores).max(1),
            cancel: &shared.stop,
            retry_failed: false,
            // Without its own program this process is the interpreter, which tries no case.
            trial: sweep::program::is_named().then_some(&try_case::command as &Trial),
        };
        generate_in(claim, &plan, &options, &simulate_cases, &mut shown)?;
        Ok((out, shown.warnings))
    })
}

/// What the arguments put in the place of the sweep's own.
pub struct Asked {
    machine: Option<Value>,
    known: Option<Known>,
    channels: Option<Vec<String>>,
}

/// A calibration that is there, and how much of its uncertainty the cases draw.
struct Known {
    folder: PathBuf,
    uncertainty: Uncertainty,
    undetermined: Undetermined,
}

impl Asked {
    pub fn new(
        machine: Option<&Machine>,
        calibration: Option<PathBuf>,
        uncertainty: &str,
        undetermined: &str,
        channels: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let known = match calibration {
            None => None,
            Some(folder) => Some(Known {
                folder,
                uncertainty: named("uncertainty", uncertainty)?,
                undetermined: named("undetermined", undetermined)?,
            }),
        };
        Ok(Self {
            machine: machine.map(|machine| machine.tree().clone()),
            known,
            channels,
        })
    }

    /// The sweep and its plan, as far as they are known without calibrating anything.
    pub fn planned(&self, sweep: &Path) -> Result<(Sweep, Plan), Failure> {
        let mut sweep = Sweep::read(sweep)?;
        if let Some(machine) = &self.machine {
            sweep = sweep.with_machine(machine.clone())?;
        }
        let plan = match &self.known {
            None => sweep.nominal()?,
            Some(known) => {
                let (uncertainty, undetermined) = (known.uncertainty, known.undetermined);
                let mut plan = sweep.kept_with(&known.folder, uncertainty, undetermined)?;
                plan.calibrated = Some(known.folder.clone());
                plan
            }
        };
        Ok((sweep, plan))
    }

    /// Whether the sweep calibrates its machine itself.
    pub fn calibrates(&self, sweep: &Sweep) -> bool {
        sweep.calibrate().is_some() && self.known.is_none()
    }

    /// The plan with the channels that were asked for.
    pub fn with_channels(&self, plan: Plan) -> Result<Plan, Failure> {
        Ok(match &self.channels {
            Some(channels) => plan.with_channels(channels)?,
            None => plan,
        })
    }
}

/// The value that files call `name`.
fn named<T: DeserializeOwned>(key: &str, name: &str) -> PyResult<T> {
    let value = serde_json::from_value(Value::String(name.to_owned()));
    value.map_err(|error| wrong(format!("{key}: {error}")))
}

/// Threads that the processor has.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// Cases that are done, and what is wrong.
struct Shown<'a> {
    shared: &'a Shared,
    warnings: Vec<String>,
}

impl Progress for Shown<'_> {
    fn begins(&mut self, cases: u64, finished: u64) {
        self.shared.begin("cases", Some(cases), finished);
    }

    fn warning(&mut self, text: &str) {
        self.warnings.push(text.to_owned());
    }

    fn case_done(&mut self, _case: u64, _failed: bool) {
        self.shared.add(1);
    }

    fn diagrams_begin(&mut self, values: u64, finished: u64) {
        self.shared
            .begin("values of bifurcation diagrams", Some(values), finished);
    }

    fn values_done(&mut self, values: u64) {
        self.shared.add(values);
    }
}
