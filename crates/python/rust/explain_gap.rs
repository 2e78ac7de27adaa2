//! The effect that a model lacks and recordings show.

use crate::interruptible::interruptible;
use crate::settings::settings;
use cli::explain_gap::into_folder;
use gap::Asked;
use pyo3::prelude::*;
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
        let say = |text: &str| shared.say(text.to_owned());
        into_folder(&asked, &out, &say, &|| shared.is_stopped()).map(drop)
    })
}
