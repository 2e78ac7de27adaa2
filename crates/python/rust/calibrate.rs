//! The model of a machine fitted to recordings of it.

use crate::interruptible::{Shared, interruptible};
use crate::machine::Machine;
use crate::settings::settings;
use ::calibrate::optimiser::Progress;
use ::calibrate::{Existing, Settings, Stage, Watcher, prepare};
use cli::Failure;
use cli::report::{self, PAGE};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Calibrates into the folder `out`: `calibration` has the keys of a calibration file, as JSON. What is there already is
/// kept if it has the same recordings, machine and settings; an interrupted calibration continues.
///
/// # Errors
/// Wrong settings, an invalid bundle or machine, work that fails, or Ctrl-C.
#[pyfunction]
#[pyo3(signature = (calibration, machine, out, allow_outside, overwrite, progress))]
pub fn calibrate(
    py: Python<'_>,
    calibration: &str,
    machine: Option<&Machine>,
    out: PathBuf,
    allow_outside: bool,
    overwrite: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let existing = match overwrite {
        true => Existing::Overwrite,
        false => Existing::Resume,
    };
    let machine = machine.map(Machine::tree);
    interruptible(py, progress, |shared| {
        let calibration = settings(calibration)?;
        let settings = Settings {
            calibration: &calibration,
            base: Path::new(""),
            machine,
            allow_outside,
            clearances_unknown: false,
            locate: &|error| error,
        };
        let prepared = prepare(&settings, &out, existing).map_err(Failure::input)?;
        let done = prepared.finish(&mut Watch(shared)).map_err(Failure::work)?;
        if !done.reused {
            report::write(&out, &out.join(PAGE))?;
        }
        match done.results.complete {
            true => Ok(()),
            false => Err(Failure::interrupted(format!(
                "stopped before the end: {} has the best so far",
                out.display()
            ))),
        }
    })
}

/// The progress of the stage that is under way.
pub struct Watch<'a>(pub &'a Shared);

impl Watcher for Watch<'_> {
    fn begins(&mut self, stage: Stage, evaluations: u64) {
        let what = match stage {
            Stage::Fit => "evaluations at most",
            Stage::DataSheet => "evaluations for values of the data sheet",
            Stage::Screen => "evaluations to screen clearances",
            Stage::Clearances => "evaluations to fit clearances",
            Stage::Relations => "evaluations to compare relations",
        };
        self.0
            .begin(what, (evaluations > 0).then_some(evaluations), 0);
    }

    fn progress(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.0.set(progress.evaluations);
        self.0.say(format!("misfit {:.3}", progress.misfit()));
        match self.0.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn ends(&mut self) {}
}
