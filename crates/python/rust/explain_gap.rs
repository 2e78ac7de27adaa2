//! The effect that a model lacks and recordings show.

use crate::interruptible::interruptible;
use crate::settings::settings;
use cli::Failure;
use cli::report::{self, PAGE};
use gap::{Asked, Error, Stage};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Explains the gap into the folder `out`: `calibration` has the keys of a calibration file, as JSON, and names the machine
/// file where the bundle's section is not to serve. An interrupted explanation continues.
///
/// # Errors
/// Wrong settings, an invalid bundle or machine, work that fails, or Ctrl-C.
#[pyfunction]
#[pyo3(signature = (calibration, out, allow_outside, progress))]
pub fn explain_gap(
    py: Python<'_>,
    calibration: &str,
    out: PathBuf,
    allow_outside: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    interruptible(py, progress, |shared| {
        let calibration = settings(calibration)?;
        let asked = Asked {
            calibration: &calibration,
            base: Path::new(""),
            allow_outside,
            locate: &|error| error,
        };
        shared.begin("explaining the gap", None, 0);
        let report = |stage: &Stage| {
            let misfit = match stage.misfit.is_finite() {
                true => format!(", misfit {:.2}", stage.misfit),
                false => String::new(),
            };
            shared.say(format!("{}{misfit}", stage.words));
        };
        let watch = || match shared.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        gap::into_folder(&asked, &out, &report, &watch).map_err(|error| match error {
            Error::Input(error) => Failure::input(error),
            Error::Stopped => Failure::interrupted(Error::Stopped),
            error => Failure::work(error),
        })?;
        report::write(&out, &out.join(PAGE)).map(drop)
    })
}
