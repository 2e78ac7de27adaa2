//! `crosshead calibrate`: a machine's parameters from recordings of it.

pub(crate) mod arguments;
pub(crate) mod progress;

use crate::output::hint;
use crate::{Failure, interrupt, report};
use ::calibrate::{Calibrated, Prepared, Settings, prepare};
use ::report::folder_kind::FolderKind;
use std::sync::atomic::AtomicBool;

pub use arguments::Arguments;

/// Calibrates from a settings file or from arguments, and prints the results.
///
/// # Errors
/// An invalid bundle or machine, runs that cannot be used, or files that cannot be written.
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
        allow_outside: arguments.allow_outside(),
        clearances_unknown: false,
        locate: &locate,
    };
    let cancel = interrupt::flag()?;
    let out = arguments.out();
    let prepared = prepare(&settings, out, arguments.existing()).map_err(Failure::input)?;
    let done = finish(prepared, &cancel)?;
    arguments.format().print(&done.results, |results| {
        if done.reused {
            println!("nothing has changed since this was found:");
        }
        print!("{results}");
        println!("{}", done.machine.display());
        println!("{}", out.join(report::PAGE).display());
    })?;
    if !done.results.complete {
        return Err(Failure::interrupted(format!(
            "stopped before the end: {} has the best so far; --resume continues from there",
            out.display()
        )));
    }
    hint(format_args!(
        "crosshead explain-gap {} --machine {} --out explained",
        arguments.first_input().display(),
        done.machine.display()
    ));
    Ok(())
}

/// Makes a calibration until `cancel` is set, and its page.
///
/// # Errors
/// A machine that cannot be simulated, or files that cannot be written.
pub fn finish(prepared: Prepared, cancel: &AtomicBool) -> Result<Calibrated, Failure> {
    let done = prepared.finish(&mut progress::Bar::new(cancel));
    let done = done.map_err(Failure::work)?;
    if let (false, Some(folder)) = (done.reused, done.machine.parent()) {
        report::write_result(FolderKind::Calibration, folder, &folder.join(report::PAGE))?;
    }
    Ok(done)
}
