//! `crosshead explain-gap`: which effect a model lacks that recordings show.

mod progress;

use crate::bundle::AllowOutside;
use crate::calibrate::arguments::read;
use crate::output::{hint, refuse_existing};
use crate::result_format::ResultFormat;
use crate::{Failure, interrupt, report};
use ::report::folder_kind::FolderKind;
use clap::Args;
use gap::folder::MACHINE;
use gap::results::RESULTS;
use gap::{Asked, Results};
use progress::Bar;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Arguments of `crosshead explain-gap`.
#[derive(Args, Debug)]
#[command(after_help = "\
The machine is calibrated to the recordings first. Where that leaves more than noise, the effects of
the catalogue are tried one after another. Those that the recordings show, and that also predict the
held-out runs, are added to the machine file. After Ctrl-C, the same command continues from what was
finished.

A settings file, as for crosshead calibrate, says what is calibrated, with its bounds; its optimiser
is not used. Recordings of pressures alone explain the gas.

Examples:
  crosshead explain-gap my-bundle --out explained
  crosshead explain-gap calibration.yaml --out explained
  crosshead explain-gap my-bundle --machine machine.yaml --out explained

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 stopped.")]
pub struct Arguments {
    /// Folder of recordings; or a settings file with one (crosshead schema calibration)
    #[arg(value_name = "BUNDLE|SETTINGS.yaml")]
    input: PathBuf,
    /// The machine file [default: the machine section of the bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Folder to write into: gap.json, machine.yaml, simulated/, baseline/, report.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Predict this run and do not fit to it; may be repeated
    #[arg(long, value_name = "RUN")]
    hold_out: Vec<String>,
    /// Do not use this run at all; may be repeated
    #[arg(long, value_name = "RUN")]
    leave_out: Vec<String>,
    #[command(flatten)]
    outside: AllowOutside,
    /// Replace an explanation that is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

/// Explains the gap and prints the results.
///
/// # Errors
/// An invalid bundle or machine, runs that cannot be used, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    refuse_existing([out.join(RESULTS)], arguments.overwrite)?;
    let input = std::slice::from_ref(&arguments.input);
    let (mut calibration, base, document) = read(input, arguments.machine.as_deref())?;
    if !arguments.hold_out.is_empty() {
        calibration.hold_out = Some(arguments.hold_out.clone());
    }
    if !arguments.leave_out.is_empty() {
        calibration.leave_out = arguments.leave_out.clone();
    }
    let cancel = interrupt::flag()?;
    let asked = Asked {
        calibration: &calibration,
        base: &base,
        allow_outside: arguments.outside.allow_outside,
        locate: &|error| match &document {
            Some(document) => document.locate(error),
            None => error,
        },
    };
    let results = into_folder(&asked, out, &cancel)?;
    arguments.format.print(&results, |results| {
        print!("{results}");
        println!("{}", out.join(MACHINE).display());
        println!("{}", out.join(report::PAGE).display());
    })?;
    hint(format_args!(
        "crosshead simulate {}",
        out.join(MACHINE).display()
    ));
    Ok(())
}

/// Explains the gap into the folder `out`, with its page; `cancel` stops it.
///
/// # Errors
/// As [`run`]; [`Failure::Work`] where it was stopped.
pub(crate) fn into_folder(
    asked: &Asked,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<Results, Failure> {
    let bar = Bar::new();
    let watch = || match cancel.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let results = gap::into_folder(asked, out, &|stage| bar.show(stage), &watch);
    drop(bar);
    let results = results.map_err(|error| match error {
        gap::Error::Input(error) => Failure::input(error),
        gap::Error::Stopped => Failure::interrupted(gap::Error::Stopped),
        error => Failure::work(error),
    })?;
    report::write_result(FolderKind::Explanation, out, &out.join(report::PAGE))?;
    Ok(results)
}
