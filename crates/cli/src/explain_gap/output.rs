//! What an explanation leaves: `gap.json`, `machine.yaml`, and a summary.

use crate::Failure;
use crate::calibrate::output::write_file;
use gap::{Candidate, Effort, Explanation, Found, Model, Tried};
use input::MachineFile;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Name of the explained machine.
pub const MACHINE: &str = "machine.yaml";
/// Name of the file of results.
pub const RESULTS: &str = "gap.json";
/// Most places in which the gap is told.
const PLACES: usize = 40;

/// Writes the explained machine, and last, as what makes the folder whole, the results, which it
/// gives back.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    folder: &Path,
    explanation: &Explanation,
    effort: &Effort,
    seconds: f64,
) -> Result<Value, Failure> {
    let model = &explanation.explained;
    let tree = model.problem.fitted(&model.x).map_err(Failure::work)?;
    let machine = MachineFile::from_tree(&tree)
        .and_then(|file| file.to_yaml())
        .map_err(Failure::work)?;
    write_file(&folder.join(MACHINE), machine.as_bytes())?;
    let before = &explanation.baseline;
    let maps = [before, model].map(gap::residual_maps);
    let [before_map, after_map] = maps;
    let maps = [
        before_map.map_err(Failure::work)?,
        after_map.map_err(Failure::work)?,
    ];
    let effects: Vec<Value> = explanation.found.iter().map(|f| effect(f, model)).collect();
    let results = json!({
        "verdict": explanation.verdict,
        "effects": effects,
        "gap": {
            "unit": "standard deviations of the noise",
            "noise_floor": 1.0,
            "before": before.fitted,
            "after": model.fitted,
            "heldout_before": before.held_out,
            "heldout_after": model.held_out,
        },
        "where": gap::places(&maps[0], PLACES),
        "heldout_runs": effort.held_out,
        "next_recording": Value::Null,
        "refused": explanation.refused.iter().map(rival).collect::<Vec<_>>(),
        "seconds": seconds,
        "maps": {"before": maps[0], "after": maps[1]},
    });
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&folder.join(RESULTS), text.as_bytes())?;
    Ok(results)
}

fn effect(found: &Found, model: &Model) -> Value {
    let entry = found.candidate.entry;
    let mut parameters = Map::new();
    for parameter in entry.parameters {
        let suffix = format!(".{}.{}", entry.name, parameter.key);
        let mut fitted = model.problem.parameters.iter().zip(&model.x);
        if let Some((fitted, x)) = fitted.find(|(p, _)| p.path.ends_with(&suffix)) {
            parameters.insert(parameter.key.to_owned(), json!({"value": fitted.value(*x)}));
        }
    }
    json!({
        "effect": entry.name,
        "throw": found.candidate.throw(),
        "joint": found.candidate.joint(),
        "sentence": entry.sentence,
        "parameters": parameters,
        "expression": Value::Null,
        "evidence": found.evidence,
        "rivals": found.rivals.iter().map(rival).collect::<Vec<_>>(),
    })
}

fn rival(tried: &Tried) -> Value {
    let Candidate { entry, .. } = &tried.candidate;
    json!({
        "effect": entry.name,
        "throw": tried.candidate.throw(),
        "joint": tried.candidate.joint(),
        "label": tried.candidate.label(),
        "evidence": tried.evidence,
    })
}

/// Prints what was found: the content of `gap.json`.
pub fn summary(results: &Value) {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    println!("{}", word(&results["verdict"]));
    for effect in results["effects"].as_array().into_iter().flatten() {
        println!("{}: {}", word(&effect["effect"]), word(&effect["sentence"]));
        for (key, parameter) in effect["parameters"].as_object().into_iter().flatten() {
            println!("  {key}: {:.4e}", number(&parameter["value"]));
        }
        for rival in effect["rivals"].as_array().into_iter().flatten() {
            println!(
                "  rival: {} {}",
                word(&rival["label"]),
                rival["evidence"]["misfit"]
            );
        }
    }
    let gap = &results["gap"];
    println!(
        "gap: {:.2} before, {:.2} after; of runs held out {:.2} before, {:.2} after; noise is 1",
        number(&gap["before"]),
        number(&gap["after"]),
        number(&gap["heldout_before"]),
        number(&gap["heldout_after"])
    );
    for rival in results["refused"].as_array().into_iter().flatten() {
        println!(
            "refused: {} {}",
            word(&rival["label"]),
            rival["evidence"]["misfit"]
        );
    }
}
