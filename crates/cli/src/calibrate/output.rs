//! What a calibration leaves: `calibration.json`, `machine.yaml`, and a summary.

use super::sensors::{self, Fitted, Sensors};
use super::{Task, gas, relation};
use crate::Failure;
use ::calibrate::fit::{Estimate, Fit, FitSettings};
use ::calibrate::parameter::Scale;
use ::calibrate::{Corrected, Correction, Problem, Transfer};
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
    /// What was looked for in the data sheet; none where no more than noise is left at once.
    pub corrected: Option<&'a Corrected>,
    /// What tells its inputs from others.
    pub fingerprint: &'a str,
    /// Evaluations of the model, those before an interruption included.
    pub evaluations: u64,
}

/// Writes the calibrated machine, and last, as what makes the folder whole, the results, which it
/// gives back.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, task: &Task, found: &Found) -> Result<Value, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    let sensors = Sensors::of(&Fitted {
        problem: &task.problem,
        x: &found.fit.coordinates(),
        misfits: found.fit.runs.iter().map(|run| run.calibrated).collect(),
        runs: &task.runs,
        encoded: &task.encoded,
    })?;
    let machine = calibrated(&task.problem, found.fit, &sensors)?;
    write_file(&folder.join(MACHINE), machine.as_bytes())?;
    let mut results = calibration(found, &task.settings);
    results["relation"] = relation::stated(&task.problem)?;
    results["noise"] = sensors.results()?;
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

/// What is known of a parameter. Where the model does not explain the recordings (`adequate` is false), it
/// has no interval.
pub(crate) fn told(estimate: &Estimate, adequate: bool) -> Value {
    let interval = estimate.interval.filter(|_| adequate);
    let [low, high] = interval.map_or([None, None], |i| i.map(Some));
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
        parameters.insert(path.clone(), told(estimate, fit.model_is_adequate()));
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
        // No time of this computer: the same inputs give the same bytes.
        "seconds": null,
        "complete": fit.complete,
        "model_is_adequate": fit.model_is_adequate(),
        "fingerprint": found.fingerprint,
        "parameters": parameters,
        "correlations": correlations,
        "corrections": found.corrected.map_or_else(Vec::new, corrections),
        "corrections_tried": found.corrected.map(|corrected| {
            let tried = corrected.tried.iter();
            tried.map(|(path, misfit)| json!({"path": path, "misfit": misfit})).collect::<Vec<_>>()
        }),
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

/// The values of the data sheet that would explain the recordings, the most probable first.
fn corrections(corrected: &Corrected) -> Vec<Value> {
    let of = |(i, correction): (usize, &Correction)| {
        let Estimate {
            parameter,
            value,
            interval,
        } = &correction.estimate;
        let [low, high] = interval.map_or([None, None], |i| i.map(Some));
        json!({
            "path": parameter.path,
            "value": value,
            "low": low,
            "high": high,
            "nominal": correction.stated.then_some(parameter.nominal),
            "probability": correction.probability,
            "misfit": correction.misfit,
            "unit": parameter.dimension.map_or(String::new(), |unit| unit.to_string()),
            "applied": corrected.applied && i == 0,
        })
    };
    corrected.corrections.iter().enumerate().map(of).collect()
}

/// Prints what was found: the content of `calibration.json`.
///
/// # Errors
/// Content that this program has not written.
pub fn summary(results: &Value) -> Result<(), Failure> {
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
            _ if estimate["identifiable"] == true => {
                println!("{path}: {value:.4e} (no interval: the model is wrong)");
            }
            _ => println!("{path}: not identifiable from the recordings; it stays {value:.4e}"),
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
    summary_of_corrections(results);
    if results["model_is_adequate"] == false {
        let held_out = results["fit"]["heldout_calibrated"].as_f64();
        println!(
            "the model is wrong: it leaves {:.2} times the noise{}; above 1.5 no interval is known, and no value \
             is to be relied on",
            number(&results["fit"]["calibrated"]),
            held_out.map_or(String::new(), |misfit| format!(", {misfit:.2} predicted"))
        );
    }
    gas::summary(&results["gas"]);
    sensors::summary(&sensors::read(&results["noise"]).map_err(Failure::work)?);
    relations(&results["relations"]);
    Ok(())
}

/// Prints which values of the data sheet were looked at because the model was wrong, and what came of it.
fn summary_of_corrections(results: &Value) {
    let Some(tried) = results["corrections_tried"].as_array() else {
        return;
    };
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let path = |value: &Value| value["path"].as_str().unwrap_or_default().to_owned();
    let corrections = results["corrections"].as_array();
    let corrections = corrections.map_or(&[][..], Vec::as_slice);
    for correction in corrections {
        let stated = match correction["nominal"].as_f64() {
            Some(nominal) => format!("in place of the stated {nominal:.5e}"),
            None => "which nobody has stated".to_owned(),
        };
        let end = match correction["applied"] == true {
            true => "; machine.yaml has it",
            false => "",
        };
        println!(
            "data sheet: {} = {:.5e} ({:.5e} to {:.5e}), {stated}, explains the recordings ({:.2} times the noise, \
             probability {:.2}){end}",
            path(correction),
            number(&correction["value"]),
            number(&correction["low"]),
            number(&correction["high"]),
            number(&correction["misfit"]),
            number(&correction["probability"]),
        );
    }
    if corrections.len() > 1 && corrections.iter().all(|c| c["applied"] != true) {
        println!("data sheet: these are not told apart, and none is corrected: measure them");
    }
    if let (true, Some(nearest)) = (corrections.is_empty(), tried.first()) {
        println!(
            "data sheet: no single value of it explains the recordings; {} comes nearest, to {:.2} times the noise",
            path(nearest),
            number(&nearest["misfit"])
        );
    }
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
