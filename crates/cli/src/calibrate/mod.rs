//! `crosshead calibrate`: a machine's parameters from recordings of it.

pub(crate) mod arguments;
mod contradiction;
mod earlier;
pub mod gas;
pub mod output;
pub(crate) mod pictures;
mod problem;
mod progress;
pub(crate) mod relation;
pub(crate) mod sensors;

use crate::bundle::AllowOutside;
use crate::{Failure, interrupt, report};
use ::calibrate::meter::Meter;
use ::calibrate::optimiser::Progress;
use earlier::Earlier;
use input::calibration::Calibration;
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

pub use arguments::Arguments;
pub use problem::{Task, task};

/// What is calibrated, and how.
pub struct Settings<'a> {
    /// The settings as a file has them.
    pub calibration: &'a Calibration,
    /// The folder from which their paths start.
    pub base: &'a Path,
    /// The tree of the machine file, in the place of the file that the settings name.
    pub machine: Option<&'a Value>,
    /// Whether its bundles may name recordings outside of their folders.
    pub outside: AllowOutside,
    /// Gives a mistake in the settings the place where they stand.
    pub locate: &'a dyn Fn(input::Error) -> input::Error,
}

impl Settings<'_> {
    /// Whether there is a machine file beside the bundle's machine section.
    fn has_machine_file(&self) -> bool {
        self.machine.is_some() || self.calibration.machine.is_some()
    }
}

/// What becomes of a calibration that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is left alone, and that is an error.
    Refuse,
    /// It is kept where it is complete and goes on where it is not; one of other recordings,
    /// another machine or other settings is an error.
    Resume,
    /// The same, but one that was made from something else is made anew.
    Renew,
    /// It is made anew.
    Overwrite,
}

/// A calibration that is on the disk.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// The calibrated machine file.
    pub machine: PathBuf,
    /// The content of `calibration.json`.
    pub results: Value,
    /// True where it was there before, and nothing was to be done.
    pub reused: bool,
}

/// Calibrates from a settings file or from arguments, and tells what was found.
///
/// # Errors
/// A bundle or machine that is none, runs that cannot be used, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (calibration, base, document) = arguments.settings()?;
    let locate = |error| match &document {
        Some(document) => document.locate(error),
        None => error,
    };
    let settings = Settings {
        calibration: &calibration,
        base: &base,
        machine: None,
        outside: arguments.outside(),
        locate: &locate,
    };
    let cancel = interrupt::flag()?;
    let out = arguments.out();
    let done = into_folder(&settings, out, arguments.existing(), &cancel)?;
    if done.reused {
        println!("nothing has changed since this was found:");
    }
    output::summary(&done.results)?;
    println!("{}", done.machine.display());
    println!("{}", out.join(report::PAGE).display());
    if done.results["complete"] == false {
        return Err(Failure::work(format!(
            "stopped before the end: {} has the best so far; --resume goes on from there",
            out.display()
        )));
    }
    Ok(())
}

/// Calibrates into the folder `out`: [`prepare`], then [`Prepared::finish`].
///
/// # Errors
/// As those.
pub fn into_folder(
    settings: &Settings,
    out: &Path,
    existing: Existing,
    cancel: &AtomicBool,
) -> Result<Calibrated, Failure> {
    prepare(settings, out, existing)?.finish(cancel)
}

/// A calibration whose input has been read and found to be usable.
pub struct Prepared {
    task: Task,
    fingerprint: String,
    out: PathBuf,
    existing: Existing,
    earlier: Option<Earlier>,
}

/// Reads everything that a calibration into the folder `out` needs, and what is there of it already.
/// Nothing is written.
///
/// # Errors
/// Settings, a bundle, a machine or recordings that cannot be used or contradict each other, or a
/// folder that is in the way.
pub fn prepare(settings: &Settings, out: &Path, existing: Existing) -> Result<Prepared, Failure> {
    earlier::check_folder(out, existing)?;
    let task = task(settings)?;
    let fingerprint = task.fingerprint();
    Ok(Prepared {
        earlier: earlier::look(out, existing, &fingerprint)?,
        task,
        fingerprint,
        existing,
        out: out.to_owned(),
    })
}

impl Prepared {
    /// Whether it is there already, complete.
    pub fn is_done(&self) -> bool {
        self.earlier.as_ref().is_some_and(Earlier::is_complete)
    }

    /// Searches, unless it is done. `cancel` stops the search at its next step, and what was best so
    /// far is written, marked as incomplete. What is evaluated is on the disk at once, so that a calibration that
    /// was stopped, or killed, goes on from there and ends with the same results.
    ///
    /// # Errors
    /// A machine that cannot be simulated, or files that cannot be written.
    pub fn finish(self, cancel: &AtomicBool) -> Result<Calibrated, Failure> {
        let Prepared {
            mut task,
            fingerprint,
            out,
            existing,
            earlier,
        } = self;
        let machine = out.join(output::MACHINE);
        if let Some(earlier) = earlier.filter(Earlier::is_complete) {
            return Ok(Calibrated {
                machine,
                results: earlier.results,
                reused: true,
            });
        }
        let checkpoint = earlier::checkpoint(&out, existing, &fingerprint)?;
        task.problem.meter = Meter::with_checkpoint(checkpoint);
        let progress::Searched {
            mut fit,
            mut corrected,
            evaluations,
        } = progress::search(&mut task, cancel)?;
        if let Some((problem, better)) = corrected.as_mut().and_then(|found| found.fit.take()) {
            task.problem = problem;
            let complete = fit.complete;
            fit = better;
            fit.complete &= complete;
        }
        let watch = |_: &Progress| match cancel.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        // A search that was stopped is not compared with others.
        let transfer = match fit.complete {
            true => ::calibrate::transfer(&task.problem, &fit, watch).map_err(Failure::work)?,
            false => None,
        };
        let found = output::Found {
            fit: &fit,
            transfer: transfer.as_ref(),
            fingerprint: &fingerprint,
            corrected: corrected.as_ref(),
            evaluations,
        };
        let x: Vec<f64> = fit
            .estimates
            .iter()
            .map(|e| e.parameter.coordinate(e.value))
            .collect();
        let compared = ::calibrate::compare(&task.problem, &task.runs, &x);
        pictures::write(&out, &compared.map_err(Failure::work)?)?;
        let results = output::write(&out, &task, &found)?;
        report::write_calibration(&out, &out.join(report::PAGE))?;
        // It is locked as long as this goes on: it goes last.
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
