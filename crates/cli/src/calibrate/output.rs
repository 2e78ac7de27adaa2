//! What a calibration leaves: `calibration.json`, `machine.yaml`, and a summary.

use crate::Failure;
use ::calibrate::Problem;
use ::calibrate::fit::{Fit, FitSettings};
use input::MachineFile;
use recordings::WholeFile;
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::Path;

/// Name of the calibrated machine.
pub const MACHINE: &str = "machine.yaml";
/// Name of the file of results.
pub const RESULTS: &str = "calibration.json";

/// Writes the calibrated machine, and last, as what makes the folder whole, the results.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    folder: &Path,
    problem: &Problem,
    fit: &Fit,
    settings: &FitSettings,
    seconds: f64,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    let machine = calibrated(problem, fit)?;
    write_file(&folder.join(MACHINE), machine.as_bytes())?;
    let results = calibration(fit, settings, seconds);
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&folder.join(RESULTS), text.as_bytes())
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

/// Prints what was found.
pub fn summary(fit: &Fit) {
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

fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let written = WholeFile::create(&path.with_extension("part"), path).and_then(|mut file| {
        file.write_all(content).map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
