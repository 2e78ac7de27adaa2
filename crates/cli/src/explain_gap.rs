//! `crosshead explain-gap`: which effect a model lacks that recordings show.

use crate::bundle::Runs;
use crate::calibrate::given;
use crate::output::{hint, refuse_existing};
use crate::progress::Progress;
use crate::result_format::ResultFormat;
use crate::{Failure, interrupt};
use ::report::folder_kind::{FolderKind, REPORT};
use clap::Args;
use gap::folder::MACHINE;
use gap::results::RESULTS;
use gap::{Asked, Results, Stage};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::slice::from_ref;
use std::sync::atomic::{AtomicBool, Ordering};

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
pub(crate) struct Arguments {
    /// Folder of recordings; or a settings file with one (crosshead schema calibration)
    #[arg(value_name = "BUNDLE|SETTINGS.yaml")]
    input: PathBuf,
    /// The machine file [default: the machine section of the bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Folder to write into: gap.json, machine.yaml, simulated/, baseline/, report.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    runs: Runs,
    /// Replace an explanation that is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    refuse_existing([out.join(RESULTS)], arguments.overwrite, "--out DIR")?;
    let (input, machine) = (from_ref(&arguments.input), arguments.machine.as_deref());
    let given = given(input, machine, &arguments.runs)?;
    let cancel = interrupt::flag()?;
    let asked = Asked {
        calibration: &given.calibration,
        base: &given.base,
        allow_outside: arguments.runs.outside.allow_outside,
        locate: &|error| given.locate(error),
    };
    let results = shown(&asked, out, &cancel)?;
    let [machine, page] = [MACHINE, REPORT].map(|file| out.join(file));
    (arguments.format).print_found(&results, false, [&machine, &page])?;
    hint(format_args!("crosshead simulate {}", machine.display()));
    Ok(())
}

/// Explains the gap into the folder `out`, with its page, and shows what is being tried; `cancel` stops it.
///
/// # Errors
/// As [`into_folder`].
pub(crate) fn shown(asked: &Asked, out: &Path, cancel: &AtomicBool) -> Result<Results, Failure> {
    let progress = Progress::new("explaining the gap", None, "{spinner} {elapsed} {msg}");
    let is_stopped = || cancel.load(Ordering::Relaxed);
    into_folder(asked, out, &|text| progress.say(text), &is_stopped)
}

/// Explains the gap into the folder `out`, with its page. `say` is told what is being tried.
///
/// # Errors
/// An invalid bundle or machine, runs that cannot be used, files that cannot be written, or work that `is_stopped`.
pub fn into_folder(
    asked: &Asked,
    out: &Path,
    say: &(dyn Fn(&str) + Sync),
    is_stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Results, Failure> {
    let report = |stage: &Stage| {
        let misfit = match stage.misfit.is_finite() {
            true => format!(", misfit {:.2}", stage.misfit),
            false => String::new(),
        };
        say(&format!("{}{misfit}", stage.words));
    };
    let watch = || match is_stopped() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let results = gap::into_folder(asked, out, &report, &watch)?;
    FolderKind::Explanation.write(out, &out.join(REPORT))?;
    Ok(results)
}
