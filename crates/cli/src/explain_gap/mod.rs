//! `crosshead explain-gap`: which effect a model lacks that recordings show.

pub mod output;
mod progress;
mod words;

use crate::bundle::AllowOutside;
use crate::calibrate::arguments::read;
use crate::{Failure, interrupt, replay, report};
use ::calibrate::pressure_gap::pressure_gaps_of;
use ::calibrate::sensors::{Fitted, Sensors};
use ::calibrate::{Settings, pictures, task};
use clap::Args;
use gap::{Effort, Journal};
use input::calibration::Calibration;
use input::yaml::Document;
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Name of the file of finished work, with which an explanation that was stopped goes on.
const FINISHED: &str = "finished.jsonl";
/// Most evaluations of the model in one descent.
const EVALUATIONS: u64 = 120;

/// Arguments of `crosshead explain-gap`.
#[derive(Args, Debug)]
#[command(after_help = "\
The machine is calibrated to the recordings first. Where that leaves more than noise, the effects of
the catalogue are tried one after another, and those that the recordings show, and that predict the
runs that were held out, are added to the machine file. Stopped with Ctrl-C, the same command goes on
from what was finished.

A settings file, as crosshead calibrate reads it, says what is calibrated, with its bounds; how that is
searched is not asked of it. Pressures that were recorded alone explain the gas.

Examples:
  crosshead explain-gap my-bundle --out explained
  crosshead explain-gap calibration.yaml --out explained
  crosshead explain-gap my-bundle --machine machine.yaml --out explained

Exit status: 0 done; 1 the work failed or was stopped; 2 the input or the arguments are wrong.")]
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
}

/// Explains the gap, and tells what was found.
///
/// # Errors
/// A bundle or machine that is none, runs that cannot be used, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    if out.join(output::RESULTS).exists() && !arguments.overwrite {
        return Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            out.join(output::RESULTS).display()
        )));
    }
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
        document: document.as_ref(),
        outside: arguments.outside,
    };
    let results = into_folder(&asked, out, &cancel)?;
    output::summary(&results)?;
    println!("{}", out.join(output::MACHINE).display());
    println!("{}", out.join(report::PAGE).display());
    Ok(())
}

/// What is to be explained.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The recordings and what is calibrated.
    pub calibration: &'a Calibration,
    /// The folder from which its paths start.
    pub base: &'a Path,
    /// The file that it was read from, if it was.
    pub document: Option<&'a Document>,
    /// Whether the bundle may name recordings outside of its folder.
    pub outside: AllowOutside,
}

/// Explains the gap between a machine and the recordings of one bundle into the folder `out`, and gives
/// back what `gap.json` says. `cancel` stops it.
///
/// # Errors
/// As [`run`]; [`Failure::Work`] where it was stopped.
pub fn into_folder(asked: &Asked, out: &Path, cancel: &AtomicBool) -> Result<Value, Failure> {
    let Asked {
        calibration,
        base,
        document,
        outside,
    } = *asked;
    let [bundle] = calibration.bundles() else {
        return Err(Failure::input(format!(
            "explain-gap takes one bundle, not {}",
            calibration.bundles().len()
        )));
    };
    let bundle = outside.read(&base.join(bundle))?;
    let mut task = task(&Settings {
        calibration,
        base,
        machine: None,
        allow_outside: outside.allow_outside,
        locate: &|error| match document {
            Some(document) => document.locate(error),
            None => error,
        },
    })
    .map_err(Failure::input)?;
    let watch = || match cancel.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let held_out = task.settings.held_out.clone();
    std::fs::create_dir_all(out).map_err(|error| Failure::unwritten(out, error))?;
    let finished = out.join(FINISHED);
    let journal = Journal::open(&finished).map_err(Failure::work)?;
    let effort =
        Effort::new(&task.problem, held_out, EVALUATIONS, journal).map_err(Failure::work)?;
    let bar = progress::Bar::new();
    let hum = gap::remove_hum(&mut task.problem, &mut task.runs).map_err(Failure::work)?;
    let explanation = gap::explain(
        &task.problem,
        &hum,
        &effort,
        &|stage| bar.tell(stage),
        &watch,
    );
    bar.finish();
    let explanation = explanation.map_err(Failure::work)?;
    let [before, after] = [&explanation.baseline, &explanation.explained];
    let baseline = before.problem.fitted(&before.x).map_err(Failure::work)?;
    let explained = output::tree(&explanation, |name| name != "mains_hum")?;
    for (folder, tree, model) in [
        ("simulated", explained, after),
        ("baseline", baseline, before),
    ] {
        let conditions = |run: &str| model.problem.conditions(run, &model.x);
        let folder = out.join(folder);
        replay::into_folder(&bundle, tree, conditions, &calibration.leave_out, &folder)?;
    }
    let models = [before, after].map(|model| (&model.problem, &model.x[..]));
    let compared = ::calibrate::compare_models(models, &task.runs).map_err(Failure::work)?;
    pictures::write(out, &compared).map_err(Failure::work)?;
    let gas = pressure_gaps_of(models, &task.runs).map_err(Failure::work)?;
    let sensors = Sensors::of(&Fitted {
        problem: &after.problem,
        x: &after.x,
        misfits: after.by_run.clone(),
        runs: &task.runs,
        encoded: &task.encoded,
    })
    .map_err(Failure::work)?;
    let results = output::write(out, &explanation, &effort, &gas, &sensors)?;
    report::write_gap(out, &out.join(report::PAGE))?;
    std::fs::remove_file(&finished).map_err(|error| Failure::unwritten(&finished, error))?;
    Ok(results)
}
