//! `crosshead calibrate`: a machine's parameters from recordings of it.

mod progress;

pub(crate) use progress::Bar;

use crate::bundle::Runs;
use crate::choice::one_of;
use crate::output::hint;
use crate::result_format::ResultFormat;
use crate::{Failure, interrupt};
use ::calibrate::{Calibrated, Existing, Prepared, Settings, prepare};
use ::report::folder_kind::{FolderKind, REPORT};
use clap::Args;
use input::calibration::{Given, Optimiser, Parameters, Relation};
use input::choice::Count;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

const OPTIMISERS: [(&str, &str, Optimiser); 4] = [
    (
        "default",
        "Levenberg-Marquardt from several points; a global search where that leaves more than noise",
        Optimiser::Default,
    ),
    ("cma-es", "CMA-ES", Optimiser::CmaEs),
    ("genetic", "A genetic algorithm", Optimiser::Genetic(None)),
    (
        "levenberg-marquardt",
        "Levenberg-Marquardt from the nominal values",
        Optimiser::LevenbergMarquardt,
    ),
];

const RELATIONS: [(&str, &str, Relation); 4] = [
    (
        "eq5",
        "Stiffness by Eq. (5) of the papers, damping with the patch of contact",
        Relation::Eq5,
    ),
    (
        "conformal",
        "Stiffness by the conformal form of Hertz's formula; the restitution stays",
        Relation::Conformal,
    ),
    ("constant", "Not at all", Relation::Constant),
    (
        "fitted",
        "By powers that are fitted: it takes recordings at two clearances or more",
        Relation::Fitted,
    ),
];

#[derive(Args, Debug)]
#[command(after_help = "\
What is fitted are paths of the machine file; without --parameter the contact stiffness, damping
and friction of every joint that is clear in some run (as the run states, else as the machine file
does), or, where pressures alone were recorded, exponent, clearance and pressures of the gas. With
accelerations the zero of the crank angle is always fitted as well (crank_angle_offset). Above a
misfit of 1.5 times the noise no interval is given; then values of the data sheet are freed one by
one. Of every four runs one is held out and predicted, the last whose clearances a fitted run has.
Options override the settings file.

Examples:
  crosshead calibrate my-bundle --out calibrated
  crosshead calibrate my-bundle --machine machine.yaml --parameter cylinder.exponent \\
      --parameter cylinder.head_clearance --hold-out run07 --out calibrated
  crosshead calibrate calibration.yaml --out calibrated
  crosshead calibrate calibration.yaml --out calibrated --resume

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 stopped.")]
pub(crate) struct Arguments {
    /// Folder of recordings, or several of one machine; or a settings file (crosshead schema calibration)
    #[arg(required = true, value_name = "BUNDLE|SETTINGS.yaml")]
    input: Vec<PathBuf>,
    /// The machine file [default: the machine section of the bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Folder to write into: machine.yaml, calibration.json, report.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A path of the machine file to be fitted; may be repeated
    #[arg(long, value_name = "PATH")]
    parameter: Vec<String>,
    /// How contact parameters follow the clearance [default: as the machine file says; where the
    /// bundle's machine section says nothing, fitted if the fitted runs have several clearances, else
    /// eq5]
    #[arg(long, value_name = "RELATION", value_parser = one_of(RELATIONS))]
    relation: Option<Relation>,
    #[command(flatten)]
    runs: Runs,
    /// How the best fit is searched [default: default]
    #[arg(long, value_parser = one_of(OPTIMISERS))]
    optimiser: Option<Optimiser>,
    /// Most evaluations of the model, all runs being one [default: 5000]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    evaluations: Option<u32>,
    /// Seed of a random search [default: 0]
    #[arg(long)]
    seed: Option<u32>,
    /// Continue a calibration that was stopped
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Replace a calibration that is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

/// The settings of the `inputs`, with the machine file, the held-out runs and those left out that the arguments name
/// instead of theirs.
///
/// # Errors
/// An invalid settings file, or a settings file beside other inputs.
pub(crate) fn given(
    inputs: &[PathBuf],
    machine: Option<&Path>,
    runs: &Runs,
) -> Result<Given, Failure> {
    let mut given = Given::read(inputs)?;
    let settings = &mut given.calibration;
    if let Some(machine) = machine {
        // From here on, and not from the folder of the file.
        settings.machine = Some(std::path::absolute(machine).map_err(Failure::input)?);
    }
    if !runs.hold_out.is_empty() {
        settings.hold_out = Some(runs.hold_out.clone());
    }
    if !runs.leave_out.is_empty() {
        settings.leave_out.clone_from(&runs.leave_out);
    }
    Ok(given)
}

impl Arguments {
    /// The settings, which the options override.
    fn given(&self) -> Result<Given, Failure> {
        let machine = self.machine.as_deref();
        let mut given = given(&self.input, machine, &self.runs)?;
        let settings = &mut given.calibration;
        if !self.parameter.is_empty() {
            let paths = self.parameter.iter().cloned();
            settings.parameters = Parameters(paths.map(|path| (path, None)).collect());
        }
        settings.optimiser = self.optimiser.unwrap_or(settings.optimiser);
        settings.relation = self.relation.or(settings.relation);
        let evaluations = self.evaluations.and_then(Count::new);
        settings.evaluations = evaluations.or(settings.evaluations);
        settings.seed = self.seed.and_then(Count::new).or(settings.seed);
        Ok(given)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let given = arguments.given()?;
    let settings = Settings {
        calibration: &given.calibration,
        base: &given.base,
        machine: None,
        allow_outside: arguments.runs.outside.allow_outside,
        clearances_unknown: false,
        locate: &|error| given.locate(error),
    };
    let cancel = interrupt::flag()?;
    let out = &arguments.out;
    let existing = existing(arguments.resume, arguments.overwrite);
    let prepared = prepare(&settings, out, existing).map_err(Failure::input)?;
    let done = finish(prepared, &cancel)?;
    let page = out.join(REPORT);
    let files = [done.machine.as_path(), &page];
    (arguments.format).print_found(&done.results, done.reused, files)?;
    check_complete(done.results.complete, out)?;
    hint(format_args!(
        "crosshead explain-gap {} --machine {} --out explained",
        arguments.input[0].display(),
        done.machine.display()
    ));
    Ok(())
}

/// What becomes of results that are there.
pub(crate) fn existing(resume: bool, overwrite: bool) -> Existing {
    match (resume, overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    }
}

/// Refuses what was stopped before its end, and says what continues it.
///
/// # Errors
/// Where it is not complete.
pub(crate) fn check_complete(complete: bool, out: &Path) -> Result<(), Failure> {
    match complete {
        true => Ok(()),
        false => Err(Failure::interrupted(format!(
            "stopped before the end: {} has the best so far; --resume continues from there",
            out.display()
        ))),
    }
}

/// Makes a calibration until `cancel` is set, and its page.
///
/// # Errors
/// A machine that cannot be simulated, or files that cannot be written.
pub fn finish(prepared: Prepared, cancel: &AtomicBool) -> Result<Calibrated, Failure> {
    let done = prepared.finish(&mut Bar::new(cancel));
    let done = done.map_err(Failure::work)?;
    if let (false, Some(folder)) = (done.reused, done.machine.parent()) {
        FolderKind::Calibration.write(folder, &folder.join(REPORT))?;
    }
    Ok(done)
}
