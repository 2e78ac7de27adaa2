//! `crosshead calibrate`: a machine's parameters from recordings of it.

use crate::Failure;
use crate::bundle;
use ::calibrate::fit::{Fit, FitSettings, Optimiser};
use ::calibrate::optimiser::{Genetic, Progress};
use ::calibrate::problem::columns;
use ::calibrate::{Observation, Parameter, Problem};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use input::bundle::Bundle;
use input::{MachineFile, paths};
use recordings::WholeFile;
use serde_json::{Map, Value, json};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
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
    /// Folder to write into: machine.yaml, calibration.json
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

/// One run in so many is held out.
const HELD_OUT: usize = 4;

/// Calibrates, and writes what was found.
///
/// # Errors
/// A bundle or machine that is none, runs that cannot be used, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let [machine_file, results] =
        ["machine.yaml", "calibration.json"].map(|f| arguments.out.join(f));
    if let Some(path) = [&machine_file, &results].into_iter().find(|p| p.exists())
        && !arguments.overwrite
    {
        return Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            path.display()
        )));
    }
    let bundle = Bundle::read(&arguments.bundle)?;
    let problem = problem(arguments, &bundle)?;
    let held_out = held_out(arguments, &problem)?;
    let settings = FitSettings {
        optimiser: match arguments.optimiser {
            Search::Default => Optimiser::Default,
            Search::CmaEs => Optimiser::CmaEs,
            Search::Genetic => Optimiser::Genetic(Genetic::default()),
            Search::LevenbergMarquardt => Optimiser::LevenbergMarquardt,
        },
        seed: arguments.seed,
        evaluations: arguments.evaluations,
        held_out,
        start: None,
    };
    let start = Instant::now();
    let fit = search(&problem, &settings)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| Failure::unwritten(&arguments.out, error))?;
    let calibration = calibration(&fit, &settings, start.elapsed().as_secs_f64());
    let text = serde_json::to_string_pretty(&calibration).map_err(Failure::work)?;
    write(&results, text.as_bytes())?;
    let machine = calibrated(&problem, &fit)?;
    write(&machine_file, machine.as_bytes())?;
    summary(&fit);
    println!("{}", machine_file.display());
    Ok(())
}

fn problem(arguments: &Arguments, bundle: &Bundle) -> Result<Problem, Failure> {
    let mut tree = bundle::machine(bundle, arguments.machine.as_deref())?;
    let runs = bundle::runs(bundle, &tree, &arguments.leave_out)?;
    let Some(first) = runs.first() else {
        return Err(Failure::input("every run is left out"));
    };
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let machine = MachineFile::from_tree(&tree)?.resolve()?;
    let columns = columns(&machine);
    let clear = |path: &String, value: &Value| path.ends_with(".clearance") && value != "ideal";
    let mut fitted = arguments.parameter.clone();
    if fitted.is_empty() {
        let mut joints: Vec<&str> = runs
            .iter()
            .flat_map(|run| &run.settings)
            .filter(|(path, value)| clear(path, value))
            .map(|(path, _)| path.trim_end_matches(".clearance"))
            .collect();
        joints.sort_unstable();
        joints.dedup();
        fitted = joints
            .iter()
            .flat_map(|joint| {
                [
                    "contact.stiffness",
                    "contact.damping",
                    "friction.coefficient",
                ]
                .map(|key| format!("{joint}.{key}"))
            })
            .collect();
    }
    let parameters = fitted
        .iter()
        .map(|path| Parameter::of(&tree, path))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    let runs = runs
        .iter()
        .map(|run| Observation::of(run, &columns))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    Ok(Problem {
        tree,
        parameters,
        runs,
    })
}

fn held_out(arguments: &Arguments, problem: &Problem) -> Result<Vec<String>, Failure> {
    let ids: Vec<&str> = problem.runs.iter().map(|run| run.id.as_str()).collect();
    bundle::known_runs("--hold-out", &arguments.hold_out, &ids)?;
    if !arguments.hold_out.is_empty() {
        return Ok(arguments.hold_out.clone());
    }
    let each = ids.iter().skip(HELD_OUT - 1).step_by(HELD_OUT);
    Ok(each.map(|id| (*id).to_owned()).collect())
}

fn search(problem: &Problem, settings: &FitSettings) -> Result<Fit, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(Failure::work)?;
    let bar = ProgressBar::new(settings.evaluations);
    bar.set_draw_target(ProgressDrawTarget::stderr());
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos} evaluations, {elapsed}, misfit {msg}")
    {
        bar.set_style(style);
    }
    let fit = ::calibrate::calibrate(problem, settings, |progress: &Progress| {
        bar.set_position(progress.evaluations);
        bar.set_message(format!("{:.3}", progress.misfit()));
        if cancel.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    bar.finish_and_clear();
    fit.map_err(Failure::work)
}

/// The machine file with what was found, as YAML.
fn calibrated(problem: &Problem, fit: &Fit) -> Result<String, Failure> {
    let mut tree = problem.tree.clone();
    for estimate in fit.estimates.iter().filter(|e| e.interval.is_some()) {
        let written = estimate.parameter.write(&mut tree, estimate.value);
        written.map_err(Failure::work)?;
    }
    MachineFile::from_tree(&tree)
        .and_then(|file| file.to_yaml())
        .map_err(Failure::work)
}

fn calibration(fit: &Fit, settings: &FitSettings, seconds: f64) -> Value {
    let mut parameters = Map::new();
    let mut correlations = Map::new();
    for (i, estimate) in fit.estimates.iter().enumerate() {
        let [low, high] = estimate.interval.map_or([None, None], |i| i.map(Some));
        let path = &estimate.parameter.path;
        let content = json!({
            "value": estimate.value,
            "low": low,
            "high": high,
            "nominal": estimate.parameter.nominal,
            "identifiable": estimate.interval.is_some(),
        });
        parameters.insert(path.clone(), content);
        let others = fit.estimates.iter().enumerate().filter(|(j, _)| *j != i);
        let row: Map<String, Value> = others
            .map(|(j, other)| {
                (
                    other.parameter.path.clone(),
                    fit.correlations[(i, j)].into(),
                )
            })
            .collect();
        correlations.insert(path.clone(), row.into());
    }
    let runs: Map<String, Value> = fit
        .runs
        .iter()
        .map(|run| {
            let content = json!({
                "held_out": run.held_out,
                "nominal": run.nominal,
                "calibrated": run.calibrated,
            });
            (run.id.clone(), content)
        })
        .collect();
    json!({
        "optimiser": settings.optimiser.name(),
        "evaluations": fit.evaluations,
        "seconds": seconds,
        "complete": fit.complete,
        "parameters": parameters,
        "correlations": correlations,
        "fit": {
            "unit": "standard deviations of the synchronous mean's noise",
            "noise_floor": 1.0,
            "nominal": fit.misfit(false, |run| run.nominal),
            "calibrated": fit.misfit(false, |run| run.calibrated),
            "heldout_nominal": fit.misfit(true, |run| run.nominal),
            "heldout_calibrated": fit.misfit(true, |run| run.calibrated),
        },
        "runs": runs,
        "heldout_runs": settings.held_out,
    })
}

fn summary(fit: &Fit) {
    if !fit.complete {
        println!("stopped; the best so far:");
    }
    for estimate in &fit.estimates {
        let path = &estimate.parameter.path;
        match estimate.interval {
            Some([low, high]) => {
                println!("{path}: {:.4e} ({low:.4e} to {high:.4e})", estimate.value);
            }
            None => println!(
                "{path}: the recordings do not tell it; it stays {:.4e}",
                estimate.value
            ),
        }
    }
    for run in &fit.runs {
        let kind = if run.held_out { "predicted" } else { "fitted" };
        println!(
            "{} {kind}: {:.2} times its noise, {:.2} before",
            run.id, run.calibrated, run.nominal
        );
    }
}

fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let written = WholeFile::create(&path.with_extension("part"), path).and_then(|mut file| {
        file.write_all(content).map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
