//! What a calibration leaves: `calibration.json`, `machine.yaml`, and a summary.

use crate::Failure;
use ::calibrate::fit::{Fit, FitSettings};
use ::calibrate::transfer::Basis;
use ::calibrate::{Problem, Relation, Transfer};
use input::MachineFile;
use recordings::WholeFile;
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::Path;

/// Name of the calibrated machine.
pub const MACHINE: &str = "machine.yaml";
/// Name of the file of results.
pub const RESULTS: &str = "calibration.json";

/// What a calibration found.
pub struct Results<'a> {
    /// The fit.
    pub fit: &'a Fit,
    /// How it was made.
    pub settings: &'a FitSettings,
    /// How long it took.
    pub seconds: f64,
    /// The relation between clearances that it was made under.
    pub relation: Value,
    /// What every relation comes to.
    pub transfer: &'a Transfer,
}

/// Writes the calibrated machine, and last, as what makes the folder whole, the results.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, problem: &Problem, results: &Results) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    let machine = calibrated(problem, results.fit)?;
    write_file(&folder.join(MACHINE), machine.as_bytes())?;
    let text = serde_json::to_string_pretty(&calibration(results)).map_err(Failure::work)?;
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

fn calibration(results: &Results) -> Value {
    let Results { fit, settings, .. } = results;
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
        "seconds": results.seconds,
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
        "relation": results.relation,
        "relations": {
            "decision": results.transfer.decision,
            "compared": results.transfer.relations,
        },
        "predictions": results.transfer.predictions,
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

/// Prints how the relations between clearances compare.
pub fn relations(transfer: &Transfer) {
    let names = |relations: &[Relation]| {
        let names: Vec<&str> = relations.iter().map(|r| r.name()).collect();
        names.join(" or ")
    };
    if transfer.decision.runs == Basis::None {
        println!("relation between clearances: one clearance does not tell it");
        return;
    }
    for hypothesis in &transfer.relations {
        let predicted = hypothesis.held_out;
        println!(
            "relation {}: {:.2} times the noise fitted{}",
            hypothesis.relation.name(),
            hypothesis.fitted,
            predicted.map_or(String::new(), |p| format!(", {p:.2} predicted"))
        );
    }
    let left = names(&transfer.decision.relations);
    println!("relation between clearances: the recordings are for {left}");
}

fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let written = WholeFile::create(&path.with_extension("part"), path).and_then(|mut file| {
        file.write_all(content).map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
