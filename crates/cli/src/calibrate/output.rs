//! What a calibration leaves: `calibration.json`, `machine.yaml`, and a summary.

use super::sensors::{self, Sensors};
use super::{Task, gas, relation};
use crate::Failure;
use ::calibrate::fit::{Estimate, Fit, FitSettings};
use ::calibrate::parameter::Scale;
use ::calibrate::{Problem, Transfer};
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
pub struct Found<'a> {
    /// The fit.
    pub fit: &'a Fit,
    /// What it comes to at other clearances; none where the search was stopped.
    pub transfer: Option<&'a Transfer>,
    /// What tells its inputs from others.
    pub fingerprint: &'a str,
    /// Evaluations of the model, those before an interruption included.
    pub evaluations: u64,
    /// How long they took.
    pub seconds: f64,
}

/// Writes the calibrated machine, and last, as what makes the folder whole, the results, which it
/// gives back.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, task: &Task, found: &Found) -> Result<Value, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    let sensors = Sensors::of(task, found.fit)?;
    let machine = calibrated(&task.problem, found.fit, &sensors)?;
    write_file(&folder.join(MACHINE), machine.as_bytes())?;
    let mut results = calibration(found, &task.settings);
    results["relation"] = relation::stated(&task.problem)?;
    results["noise"] = sensors.results();
    // Where the gas was not fitted it tells nothing new.
    let mut fitted = found.fit.estimates.iter().map(|e| &e.parameter.path);
    if fitted.any(|path| path.contains("cylinder.")) {
        let gaps = gas::gaps(task, found.fit)?;
        results["gas"] = gas::results(&gaps);
        gas::write(folder, &gaps)?;
    }
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&folder.join(RESULTS), text.as_bytes())?;
    Ok(results)
}

/// The machine file with what was found, as YAML.
fn calibrated(problem: &Problem, fit: &Fit, sensors: &Sensors) -> Result<String, Failure> {
    let mut tree = problem.tree.clone();
    for estimate in fit.estimates.iter().filter(|e| e.interval.is_some()) {
        let written = estimate.parameter.write(&mut tree, estimate.value);
        written.map_err(Failure::work)?;
    }
    sensors.write(&mut tree)?;
    MachineFile::from_tree(&tree)
        .and_then(|file| file.to_yaml())
        .map_err(Failure::work)
}

/// What is known of a parameter.
pub(crate) fn told(estimate: &Estimate) -> Value {
    let [low, high] = estimate.interval.map_or([None, None], |i| i.map(Some));
    json!({
        "value": estimate.value,
        "low": low,
        "high": high,
        "nominal": estimate.parameter.nominal,
        "identifiable": estimate.interval.is_some(),
        "at_bound": estimate.at_bound(),
        "bounds": estimate.parameter.bounds,
        "logarithmic": estimate.parameter.scale == Scale::Logarithmic,
    })
}

fn calibration(found: &Found, settings: &FitSettings) -> Value {
    let fit = found.fit;
    let mut parameters = Map::new();
    let mut correlations = Map::new();
    for (i, estimate) in fit.estimates.iter().enumerate() {
        let path = &estimate.parameter.path;
        parameters.insert(path.clone(), told(estimate));
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
        "evaluations": found.evaluations,
        "seconds": found.seconds,
        "complete": fit.complete,
        "fingerprint": found.fingerprint,
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
        "relation": Value::Null,
        "relations": found.transfer.map(|transfer| json!({
            "decision": transfer.decision,
            "compared": transfer.relations,
        })),
        "predictions": found.transfer.map(|transfer| &transfer.predictions),
    })
}

/// Prints what was found: the content of `calibration.json`.
pub fn summary(results: &Value) {
    if results["complete"] == false {
        println!("stopped; the best so far:");
    }
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    for (path, estimate) in results["parameters"].as_object().into_iter().flatten() {
        let value = number(&estimate["value"]);
        match [&estimate["low"], &estimate["high"]].map(Value::as_f64) {
            [Some(low), Some(high)] => {
                let stuck = match estimate["at_bound"] == true {
                    true => ": at its bound, and the recordings ask for more",
                    false => "",
                };
                println!("{path}: {value:.4e} ({low:.4e} to {high:.4e}){stuck}");
            }
            _ => println!("{path}: the recordings do not tell it; it stays {value:.4e}"),
        }
    }
    for (id, run) in results["runs"].as_object().into_iter().flatten() {
        let kind = match run["held_out"] == true {
            true => "predicted",
            false => "fitted",
        };
        println!(
            "{id} {kind}: {:.2} times its noise, {:.2} before",
            number(&run["calibrated"]),
            number(&run["nominal"])
        );
    }
    gas::summary(&results["gas"]);
    sensors::summary(&results["noise"]);
    relations(&results["relations"]);
}

/// Prints how the relations between clearances compare, where the recordings tell them apart.
fn relations(results: &Value) {
    let decided = results["decision"]["relations"].as_array();
    let Some(decided) = decided.filter(|relations| !relations.is_empty()) else {
        return;
    };
    for compared in results["compared"].as_array().into_iter().flatten() {
        let held_out = compared["held_out"].as_f64();
        println!(
            "relation {}: {:.2} times the noise fitted{}",
            compared["relation"].as_str().unwrap_or_default(),
            compared["fitted"].as_f64().unwrap_or(f64::NAN),
            held_out.map_or(String::new(), |misfit| format!(", {misfit:.2} predicted"))
        );
    }
    let decided: Vec<&str> = decided.iter().filter_map(Value::as_str).collect();
    println!(
        "relation that the recordings are for: {}",
        decided.join(" or ")
    );
}

/// Writes a file that appears whole or not at all.
///
/// # Errors
/// Where it cannot be written.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let written = WholeFile::create(&path.with_extension("part"), path).and_then(|mut file| {
        file.write_all(content).map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
