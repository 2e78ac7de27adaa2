//! `crosshead calibrate`: a machine's parameters from recordings of it.

pub(crate) mod output;
pub(crate) mod pictures;
mod problem;
mod progress;

use crate::{Failure, bundle, report};
use ::calibrate::fit::{FitSettings, Optimiser};
use ::calibrate::optimiser::Genetic;
use clap::{Args, ValueEnum};
use input::bundle::Bundle;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `crosshead calibrate`.
#[derive(Args, Debug)]
#[command(after_help = "\
BUNDLE is a folder with recordings.yaml. What is fitted are paths of the machine file; without
--parameter the contact stiffness, damping and friction of every joint that is clear in some run.
Every fourth run is held out and predicted, where there are four.

Examples:
  crosshead calibrate my-bundle --out calibrated
  crosshead calibrate my-bundle --machine machine.yaml --parameter cylinder.exponent \\
      --parameter cylinder.head_clearance --hold-out run07 --out calibrated

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// Folder of recordings
    bundle: PathBuf,
    /// The machine file [default: the machine section of the bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Folder to write into: machine.yaml, calibration.json, report.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A path of the machine file to be fitted; may be repeated
    #[arg(long, value_name = "PATH")]
    parameter: Vec<String>,
    /// Predict this run and do not fit to it; may be repeated
    #[arg(long, value_name = "RUN")]
    hold_out: Vec<String>,
    /// Do not use this run at all; may be repeated
    #[arg(long, value_name = "RUN")]
    leave_out: Vec<String>,
    /// How the best fit is searched
    #[arg(long, default_value = "default")]
    optimiser: Search,
    /// Most evaluations of the model, all runs being one
    #[arg(long, default_value_t = 5000)]
    evaluations: u64,
    /// Seed of a random search
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Replace the files of an earlier calibration
    #[arg(long)]
    overwrite: bool,
}

/// How the best fit is searched.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Search {
    /// Levenberg-Marquardt from several points; CMA-ES where that leaves more than noise
    Default,
    /// CMA-ES
    CmaEs,
    /// A genetic algorithm
    Genetic,
    /// Levenberg-Marquardt from the nominal values
    LevenbergMarquardt,
}

/// Calibrates, and writes what was found.
///
/// # Errors
/// A bundle or machine that is none, runs that cannot be used, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let [machine, results] = [output::MACHINE, output::RESULTS].map(|f| arguments.out.join(f));
    if let Some(path) = [&machine, &results].into_iter().find(|p| p.exists())
        && !arguments.overwrite
    {
        return Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            path.display()
        )));
    }
    let bundle = Bundle::read(&arguments.bundle)?;
    let problem = problem::problem(arguments, &bundle)?;
    let settings = FitSettings {
        optimiser: match arguments.optimiser {
            Search::Default => Optimiser::Default,
            Search::CmaEs => Optimiser::CmaEs,
            Search::Genetic => Optimiser::Genetic(Genetic::default()),
            Search::LevenbergMarquardt => Optimiser::LevenbergMarquardt,
        },
        seed: arguments.seed,
        evaluations: arguments.evaluations,
        held_out: problem::held_out(arguments, &problem)?,
    };
    let start = Instant::now();
    let fit = progress::search(&problem, &settings)?;
    let seconds = start.elapsed().as_secs_f64();
    output::write(&arguments.out, &problem, &fit, &settings, seconds)?;
    let runs = bundle::runs(&bundle, &problem.tree, &arguments.leave_out)?;
    pictures::write(&arguments.out, &problem, &runs, &fit)?;
    let page = report::write_calibration(&arguments.out, &arguments.out.join("report.html"))?;
    output::summary(&fit);
    println!("{}", machine.display());
    println!("{}", page.display());
    Ok(())
}
