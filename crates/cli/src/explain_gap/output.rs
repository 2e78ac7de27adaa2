//! What an explanation leaves: `gap.json`, `machine.yaml`, and a summary.

use crate::Failure;
use crate::calibrate::output::write_file;
use calibrate::fit::Estimate;
use gap::{Candidate, Effort, Explanation, Found, Tried};
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
    let tree = tree(explanation, |_| true)?;
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
    let numbered = explanation.found.iter().enumerate();
    let first = before.problem.tree["effects"]
        .as_array()
        .map_or(0, Vec::len);
    let effects: Vec<Value> = numbered
        .map(|(i, found)| effect((first + i, found), &explanation.estimates))
        .chain(
            explanation
                .chain
                .iter()
                .map(|found| effect((usize::MAX, found), &[])),
        )
        .collect();
    let runs: Map<String, Value> = (0..model.problem.runs.len())
        .map(|i| {
            let id = model.problem.runs[i].id.clone();
            let content = json!({
                "held_out": effort.held_out.contains(&id),
                "before": before.by_run[i],
                "after": model.by_run[i],
            });
            (id, content)
        })
        .collect();
    let results = json!({
        "verdict": explanation.verdict,
        "effects": effects,
        "gap": {
            "unit": "standard deviations of the noise",
            "noise_floor": 1.0,
            "nominal": explanation.nominal.fitted,
            "heldout_nominal": explanation.nominal.held_out,
            "before": before.fitted,
            "after": model.fitted,
            "heldout_before": before.held_out,
            "heldout_after": model.held_out,
        },
        "where": gap::places(&maps[0], PLACES),
        "scaling": gap::scaling(before, &maps[0]).map_err(Failure::work)?,
        "heldout_runs": effort.held_out,
        "next_recording": gap::next_recording(&explanation.found),
        "missing_force": explanation.missing_force,
        "refused": explanation.refused.iter().map(rival).collect::<Vec<_>>(),
        "seconds": seconds,
        "runs": runs,
        "maps": {"bands": gap::band_names(), "before": maps[0], "after": maps[1]},
    });
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&folder.join(RESULTS), text.as_bytes())?;
    Ok(results)
}

/// The explained machine file, with those findings about the measuring chain whose effect `keep`
/// names.
///
/// # Errors
/// A machine that is none.
pub fn tree(explanation: &Explanation, keep: impl Fn(&str) -> bool) -> Result<Value, Failure> {
    let model = &explanation.explained;
    let mut tree = model.problem.fitted(&model.x).map_err(Failure::work)?;
    for found in &explanation.chain {
        let Candidate { entry, place, .. } = &found.candidate;
        if keep(entry.name) {
            let place: Vec<(&str, &str)> = place.iter().map(|(k, w)| (*k, w.as_str())).collect();
            let effects = tree["effects"].take();
            let mut effects = effects.as_array().cloned().unwrap_or_default();
            effects.push(entry.item(&place, &found.values));
            tree["effects"] = effects.into();
        }
    }
    Ok(tree)
}

fn effect((index, found): (usize, &Found), estimates: &[Estimate]) -> Value {
    let entry = found.candidate.entry;
    let mut parameters = Map::new();
    let mut terms = Vec::new();
    for (i, parameter) in entry.parameters.iter().enumerate() {
        if parameter.absent.is_some() && found.candidate.fixed.iter().any(|(f, _)| *f == i) {
            // A term that the law does not have.
            continue;
        }
        let path = format!("effects.{index}.{}.{}", entry.name, parameter.key);
        let content = match estimates.iter().find(|e| e.parameter.path == path) {
            Some(estimate) => {
                let [low, high] = estimate.interval.map_or([None, None], |i| i.map(Some));
                json!({"value": estimate.value, "low": low, "high": high})
            }
            // An order is not searched but tried.
            None => {
                json!({"value": found.values[i], "low": found.values[i], "high": found.values[i]})
            }
        };
        terms.push((parameter.key, content["value"].as_f64().unwrap_or(f64::NAN)));
        parameters.insert(parameter.key.to_owned(), content);
    }
    json!({
        "effect": entry.name,
        "label": found.candidate.label(),
        "throw": found.candidate.throw(),
        "joint": found.candidate.joint(),
        "sentence": entry.sentence,
        "parameters": parameters,
        "expression": (entry.name == gap::empirical_force::NAME).then(|| gap::empirical_force::expression(terms)),
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
        if let Some(expression) = effect["expression"].as_str() {
            println!("  F = {expression}");
        }
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
