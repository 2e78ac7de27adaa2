//! The arguments of `crosshead calibrate`, which override a settings file.

use crate::Failure;
use crate::bundle::AllowOutside;
use crate::result_format::ResultFormat;
use ::calibrate::Existing;
use clap::{Args, ValueEnum};
use input::bundle::Bundle;
use input::calibration::{Calibration, Optimiser, Parameters, Relation};
use input::choice::Count;
use input::yaml::Document;
use std::path::{Path, PathBuf};

/// Arguments of `crosshead calibrate`.
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
pub struct Arguments {
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
    #[arg(long, value_name = "RELATION")]
    relation: Option<Law>,
    /// Predict this run and do not fit to it; may be repeated
    #[arg(long, value_name = "RUN")]
    hold_out: Vec<String>,
    /// Do not use this run at all; may be repeated
    #[arg(long, value_name = "RUN")]
    leave_out: Vec<String>,
    #[command(flatten)]
    outside: AllowOutside,
    /// How the best fit is searched [default: default]
    #[arg(long)]
    optimiser: Option<Search>,
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

/// How the best fit is searched.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Search {
    /// Levenberg-Marquardt from several points; a global search where that leaves more than noise
    Default,
    /// CMA-ES
    CmaEs,
    /// A genetic algorithm
    Genetic,
    /// Levenberg-Marquardt from the nominal values
    LevenbergMarquardt,
}

/// How contact parameters follow the clearance.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Law {
    /// Stiffness by Eq. (5) of the papers, damping with the patch of contact
    Eq5,
    /// Stiffness by the conformal form of Hertz's formula; the restitution stays
    Conformal,
    /// Not at all
    Constant,
    /// By powers that are fitted: it takes recordings at two clearances or more
    Fitted,
}

/// The settings of bundles or of one settings file, with this machine file instead of theirs. Also
/// returns the folder from which their paths start, and the settings file, if there is one.
///
/// # Errors
/// An invalid settings file, or a settings file beside other inputs.
pub(crate) fn read(
    input: &[PathBuf],
    machine: Option<&Path>,
) -> Result<(Calibration, PathBuf, Option<Document>), Failure> {
    let is_bundle = |path: &PathBuf| path.is_dir() || Bundle::is_at(path);
    let (mut settings, base, document) = match input {
        [file] if !is_bundle(file) => {
            let (settings, document) = Calibration::read(file)?;
            let base = file.parent().unwrap_or(Path::new("")).to_owned();
            (settings, base, Some(document))
        }
        bundles => (
            Calibration::with_defaults(bundles.to_vec()),
            PathBuf::new(),
            None,
        ),
    };
    if let Some(machine) = machine {
        // From here on, and not from the folder of the file.
        let machine = std::path::absolute(machine);
        settings.machine = Some(machine.map_err(Failure::input)?);
    }
    Ok((settings, base, document))
}

impl Arguments {
    /// The settings, the folder from which their paths start, and their file where there is one.
    ///
    /// # Errors
    /// An invalid settings file, or a settings file beside other inputs.
    pub(super) fn settings(&self) -> Result<(Calibration, PathBuf, Option<Document>), Failure> {
        let (mut settings, base, document) = read(&self.input, self.machine.as_deref())?;
        if !self.parameter.is_empty() {
            let paths = self.parameter.iter().cloned();
            settings.parameters = Parameters(paths.map(|path| (path, None)).collect());
        }
        if !self.hold_out.is_empty() {
            settings.hold_out = Some(self.hold_out.clone());
        }
        if !self.leave_out.is_empty() {
            settings.leave_out = self.leave_out.clone();
        }
        if let Some(search) = self.optimiser {
            settings.optimiser = match search {
                Search::Default => Optimiser::Default,
                Search::CmaEs => Optimiser::CmaEs,
                Search::Genetic => Optimiser::Genetic(None),
                Search::LevenbergMarquardt => Optimiser::LevenbergMarquardt,
            };
        }
        if let Some(law) = self.relation {
            settings.relation = Some(match law {
                Law::Eq5 => Relation::Eq5,
                Law::Conformal => Relation::Conformal,
                Law::Constant => Relation::Constant,
                Law::Fitted => Relation::Fitted,
            });
        }
        settings.evaluations = self
            .evaluations
            .and_then(Count::new)
            .or(settings.evaluations);
        settings.seed = self.seed.and_then(Count::new).or(settings.seed);
        Ok((settings, base, document))
    }

    /// The bundle, or the settings file, that is named first.
    pub(super) fn first_input(&self) -> &Path {
        self.input.first().map_or(Path::new(""), PathBuf::as_path)
    }

    pub(super) fn allow_outside(&self) -> bool {
        self.outside.allow_outside
    }

    pub(super) fn format(&self) -> ResultFormat {
        self.format
    }

    pub(super) fn out(&self) -> &Path {
        &self.out
    }

    pub(super) fn existing(&self) -> Existing {
        match (self.resume, self.overwrite) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Overwrite,
            _ => Existing::Refuse,
        }
    }
}
