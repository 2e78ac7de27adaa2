//! A sweep becomes a labelled dataset.

use crate::calibrate::Watch;
use crate::failure::wrong;
use crate::interruptible::{Shared, interruptible};
use crate::machine::Machine;
use cli::Failure;
use cli::report::{PAGE, write_calibration};
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
    out: Option<PathBuf>,
    existing: &str,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PathBuf, Vec<String>)> {
    let existing = match existing {
        "resume" => Existing::Resume,
        "overwrite" => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let machine = machine.map(|machine| machine.tree().clone());
    let known = match calibration {
        None => None,
        Some(folder) => Some(Known {
            folder,
            uncertainty: named("uncertainty", uncertainty)?,
            undetermined: named("undetermined", undetermined)?,
        }),
    };
    interruptible(py, progress, |shared| {
        let (sweep, nominal) = planned(&sweep, machine, known.as_ref())?;
        nominal.check_size()?;
        let out = out.unwrap_or_else(|| Path::new("datasets").join(&nominal.name));
        let asks = sweep.calibrate().is_some() && known.is_none();
        let (claim, plan) = match asks {
            false => {
                check_calibration(&nominal)?;
                (Claim::new(&out, existing)?, nominal)
            }
            true => calibrated(&sweep, &out, existing, shared)?,
        };
        let plan = match &channels {
            Some(channels) => plan.with_channels(channels)?,
            None => plan,
        };
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

/// A calibration that is there, and how much of its uncertainty the cases draw.
struct Known {
    folder: PathBuf,
    uncertainty: Uncertainty,
    undetermined: Undetermined,
}

/// The value that files call `name`.
fn named<T: DeserializeOwned>(key: &str, name: &str) -> PyResult<T> {
    let value = serde_json::from_value(Value::String(name.to_owned()));
    value.map_err(|error| wrong(format!("{key}: {error}")))
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// The sweep and its plan, as far as they are known without calibrating anything.
fn planned(
    sweep: &Path,
    machine: Option<Value>,
    known: Option<&Known>,
) -> Result<(Sweep, Plan), Failure> {
    let mut sweep = Sweep::read(sweep)?;
    if let Some(machine) = machine {
        sweep = sweep.with_machine(machine)?;
    }
    let plan = match known {
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

/// Calibrates the machine into the dataset's folder, as the sweep asks.
fn calibrated(
    sweep: &Sweep,
    out: &Path,
    existing: Existing,
    shared: &Shared,
) -> Result<(Claim, Plan), Failure> {
    let prepared = sweep.prepared(out).map_err(Failure::input)?;
    let mut claim = Claim::new(out, existing)?;
    let folder = claim.calibration(prepared.is_done())?;
    let done = prepared.finish(&mut Watch(shared)).map_err(Failure::work)?;
    if !done.reused {
        write_calibration(&folder, &folder.join(PAGE))?;
    }
    if !done.results.complete {
        return Err(Failure::interrupted("stopped during the calibration"));
    }
    Ok((claim, sweep.kept(&folder)?))
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
