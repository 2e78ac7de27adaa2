//! `crosshead calibrate`: a machine's parameters from recordings of it.

mod arguments;
mod contradiction;
mod earlier;
pub mod output;
mod problem;
mod progress;

use crate::Failure;
use input::calibration::Calibration;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

pub use arguments::Arguments;
pub use problem::{Task, task};

/// What is calibrated, and how.
pub struct Settings<'a> {
    /// The settings as a file has them.
    pub calibration: &'a Calibration,
    /// The folder from which their paths start.
    pub base: &'a Path,
    /// Gives a mistake in the settings the place where they stand.
    pub locate: &'a dyn Fn(input::Error) -> input::Error,
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
        locate: &locate,
    };
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(Failure::work)?;
    let out = arguments.out();
    let done = into_folder(&settings, out, arguments.existing(), &cancel)?;
    if done.reused {
        println!("nothing has changed since this was found:");
    }
    output::summary(&done.results);
    println!("{}", done.machine.display());
    if done.results["complete"] == false {
        return Err(Failure::work(format!(
            "stopped before the end: {} has the best so far; --resume goes on from there",
            out.display()
        )));
    }
    Ok(())
}

/// Calibrates into the folder `out`. `cancel` stops the search at its next step, and what was best
/// so far is written, marked as incomplete. Everything that can be wrong with the input is found
/// before the search begins, and nothing is written then.
///
/// # Errors
/// Settings, a bundle, a machine or recordings that cannot be used or contradict each other, a
/// folder that is in the way, or files that cannot be written.
pub fn into_folder(
    settings: &Settings,
    out: &Path,
    existing: Existing,
    cancel: &AtomicBool,
) -> Result<Calibrated, Failure> {
    earlier::check_folder(out, existing)?;
    let mut task = task(settings)?;
    let fingerprint = task.fingerprint();
    let machine = out.join(output::MACHINE);
    let (mut evaluations, mut seconds) = (0, 0.0);
    if let Some(earlier) = earlier::look(out, existing, &fingerprint)? {
        if earlier.is_complete() {
            return Ok(Calibrated {
                machine,
                results: earlier.results,
                reused: true,
            });
        }
        task.settings.start = Some(earlier.start(&task.problem));
        (evaluations, seconds) = earlier.spent();
    }
    let start = Instant::now();
    let fit = progress::search(&mut task, cancel)?;
    let found = output::Found {
        fit: &fit,
        fingerprint: &fingerprint,
        evaluations: evaluations + fit.evaluations,
        seconds: seconds + start.elapsed().as_secs_f64(),
    };
    let results = output::write(out, &task, &found)?;
    Ok(Calibrated {
        machine,
        results,
        reused: false,
    })
}
