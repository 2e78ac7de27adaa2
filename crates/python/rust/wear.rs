//! Which joints are worn, and how much.

use crate::calibrate::Watch;
use crate::interruptible::interruptible;
use crate::machine::Machine;
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use ::calibrate::wear::{Asked, prepare};
use ::calibrate::{Existing, Settings};
use cli::Failure;
use cli::report::{self, PAGE};
use input::calibration::{Calibration, Parameters};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// Estimates the clearances of `machine`, the healthy one, from the recordings in `bundle`, into the folder `out`.
///
/// # Errors
/// An invalid bundle, work that fails, or Ctrl-C.
#[pyfunction]
#[pyo3(signature = (bundle, machine, out, worn_from, leave_out, allow_outside, overwrite, progress))]
pub fn estimate_wear(
    py: Python<'_>,
    bundle: PathBuf,
    machine: &Machine,
    out: PathBuf,
    worn_from: f64,
    leave_out: Vec<String>,
    allow_outside: bool,
    overwrite: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let machine = machine.tree();
    interruptible(py, progress, |shared| {
        let mut calibration = Calibration::with_defaults(vec![bundle]);
        calibration.parameters = Parameters(vec![(CRANK_ANGLE_OFFSET.to_owned(), None)]);
        calibration.hold_out = Some(Vec::new());
        calibration.leave_out = leave_out;
        let asked = Asked {
            settings: Settings {
                calibration: &calibration,
                base: Path::new(""),
                machine: Some(machine),
                allow_outside,
                clearances_unknown: true,
                locate: &|error| error,
            },
            worn_from,
        };
        let existing = match overwrite {
            true => Existing::Overwrite,
            false => Existing::Resume,
        };
        let prepared = prepare(&asked, &out, existing).map_err(Failure::input)?;
        let done = prepared.finish(&mut Watch(shared)).map_err(Failure::work)?;
        report::write(&out, &out.join(PAGE))?;
        match done.results.complete {
            true => Ok(()),
            false => Err(Failure::interrupted("stopped before the end")),
        }
    })
}
