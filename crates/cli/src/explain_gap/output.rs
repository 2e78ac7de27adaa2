//! What an explanation leaves: `gap.json`, `machine.yaml`, and a summary.

use super::words;
use crate::Failure;
use crate::calibrate::summary;
use crate::output::write_file;
use calibrate::fit::Estimate;
use calibrate::pressure_gap::PressureGap;
use calibrate::recorded_sensor::RecordedSensor;
use calibrate::results;
use calibrate::sensors::Sensors;
use gap::{Candidate, Effort, Explanation, Found, Tried};
use input::MachineFile;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
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
    gas: &[PressureGap],
    sensors: &Sensors,
) -> Result<Value, Failure> {
    let model = &explanation.explained;
    let mut tree = tree(explanation, |_| true)?;
    sensors.write(&mut tree).map_err(Failure::work)?;
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
    let found = &explanation.found;
    let numbered = found.iter().enumerate().flat_map(|(i, f)| {
        let first = gap::first_item(&before.problem, found, i);
        effect(f, Some(first), &explanation.estimates)
    });
    let chain = explanation.chain.iter().flat_map(|f| effect(f, None, &[]));
    let effects: Vec<Value> = numbered.chain(chain).collect();
    let runs: Map<String, Value> = (0..model.problem.runs.len())
        .map(|i| {
            let id = model.problem.runs[i].id.clone();
            let rms = |which: usize| {
                let own: Vec<&PressureGap> = gas.iter().filter(|gap| gap.run == id).collect();
                pressure_rms(&own, which)
            };
            let content = json!({
                "held_out": effort.held_out.contains(&id),
                "before": before.by_run[i],
                "after": model.by_run[i],
                "pressure_rms_pa": {"before": rms(0), "after": rms(1)},
            });
            (id, content)
        })
        .collect();
    let all: Vec<&PressureGap> = gas.iter().collect();
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
            "pressure_rms_pa": {
                "before": pressure_rms(&all, 0),
                "after": pressure_rms(&all, 1),
            },
        },
        "steps": explanation.steps,
        "notes": words::notes(explanation, effort, gas),
        "parameters": parameters(explanation),
        "where": gap::places(&maps[0], PLACES),
        "scaling": gap::scaling(before, &maps[0]).map_err(Failure::work)?,
        "heldout_runs": effort.held_out,
        "next_recording": explanation.next_recording,
        "missing_force": explanation.missing_force,
        "refused": explanation.refused.iter().map(|tried| rival(tried, None)).collect::<Vec<_>>(),
        "noise": sensors.by_column,
        "cost": effort.journal.spent(),
        // No time of this computer: the same inputs give the same bytes.
        "seconds": null,
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

/// Root mean square of simulated less recorded pressure over channels, Pa: before (0) or after (1);
/// none without a channel.
fn pressure_rms(gaps: &[&PressureGap], which: usize) -> Option<f64> {
    let squares = gaps.iter().map(|gap| gap.rms()[which].powi(2));
    (!gaps.is_empty()).then(|| (squares.sum::<f64>() / gaps.len() as f64).sqrt())
}

fn by_name(values: &[(String, f64)]) -> Value {
    let values = values
        .iter()
        .map(|(name, value)| (name.clone(), json!(value)));
    values.collect::<Map<_, _>>().into()
}

/// What was fitted with what is known of it, the parameters of effects included.
fn parameters(explanation: &Explanation) -> Value {
    let of = |estimate: &Estimate| {
        let found = results::Estimate::of(estimate, true);
        (estimate.parameter.path.clone(), json!(found))
    };
    let all = explanation.estimates.iter().map(of);
    all.collect::<Map<_, _>>().into()
}

/// An effect, once for each item of the machine file's list; `first` is the index of its first one
/// there.
fn effect(found: &Found, first: Option<usize>, estimates: &[Estimate]) -> Vec<Value> {
    let items = found.candidate.items().into_iter().enumerate();
    let items = items.map(|(i, (item, value))| {
        let index = first.map(|first| first + i);
        of_item(&item, index, &found.values[value..], found, estimates)
    });
    items.collect()
}

fn of_item(
    item: &Candidate,
    index: Option<usize>,
    values: &[f64],
    found: &Found,
    estimates: &[Estimate],
) -> Value {
    let entry = item.entry;
    let mut parameters = Map::new();
    let mut terms = Vec::new();
    let mut sentence = entry.sentence.to_owned();
    for (i, (parameter, value)) in entry.parameters.iter().zip(values).enumerate() {
        if parameter.absent.is_some() && item.fixed.iter().any(|(f, _)| *f == i) {
            // A term that the law does not have.
            continue;
        }
        let path = index.map(|index| format!("effects.{index}.{}.{}", entry.name, parameter.key));
        let estimate = estimates
            .iter()
            .find(|e| Some(&e.parameter.path) == path.as_ref());
        let content = match estimate {
            Some(estimate) => {
                let [low, high] = estimate.interval.map_or([None, None], |i| i.map(Some));
                json!({"value": estimate.value, "low": low, "high": high})
            }
            // An order is not searched but tried.
            None => json!({"value": value, "low": value, "high": value}),
        };
        terms.push((parameter.key, content["value"].as_f64().unwrap_or(f64::NAN)));
        if let Some(closes) = words::closing(item, parameter.key, content["value"].as_f64()) {
            sentence.push_str(&closes);
        }
        parameters.insert(parameter.key.to_owned(), content);
    }
    json!({
        "effect": entry.name,
        "label": item.label(),
        "throw": item.throw(),
        "joint": item.joint(),
        "end": item.end(),
        "sentence": sentence,
        "parameters": parameters,
        "expression": (entry.name == gap::empirical_force::NAME).then(|| gap::empirical_force::expression(terms)),
        "evidence": found.evidence,
        "pressure_rms_pa": by_name(&found.pressure_rms),
        "rivals": found.rivals.iter().map(|tried| rival(tried, Some(found))).collect::<Vec<_>>(),
    })
}

/// A candidate that was not added; a rival of the effect `found`, where it is one.
fn rival(tried: &Tried, found: Option<&Found>) -> Value {
    let Candidate { entry, .. } = &tried.candidate;
    json!({
        "effect": entry.name,
        "throw": tried.candidate.throw(),
        "joint": tried.candidate.joint(),
        "end": tried.candidate.end(),
        "label": tried.candidate.label(),
        "evidence": tried.evidence,
        "correlation": tried.likeness.map(|likeness| likeness.correlation),
        "leaves": tried.leaves(),
        "explains_of_effect": found.map(|found| tried.explains(&found.evidence)),
        "fitted": tried.model.is_some(),
    })
}

/// Prints what was found: the content of `gap.json`.
///
/// # Errors
/// Content that this program has not written.
pub fn summary(results: &Value) -> Result<(), Failure> {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    println!("{}", word(&results["verdict"]));
    for effect in results["effects"].as_array().into_iter().flatten() {
        println!("{}: {}", word(&effect["label"]), word(&effect["sentence"]));
        if let Some(expression) = effect["expression"].as_str() {
            println!("  F = {expression}");
        }
        for (key, parameter) in effect["parameters"].as_object().into_iter().flatten() {
            println!("  {key}: {:.4e}", number(&parameter["value"]));
        }
        for rival in effect["rivals"].as_array().into_iter().flatten() {
            println!(
                "  rival: {}, {}",
                word(&rival["label"]),
                words::rival(rival)
            );
        }
    }
    let gap = &results["gap"];
    let held_out = match gap["heldout_after"].is_number() {
        true => format!(
            "; of runs held out {:.2} before, {:.2} after",
            number(&gap["heldout_before"]),
            number(&gap["heldout_after"])
        ),
        false => String::new(),
    };
    println!(
        "gap: {:.2} before, {:.2} after{held_out}; noise is 1",
        number(&gap["before"]),
        number(&gap["after"])
    );
    for (run, content) in results["runs"].as_object().into_iter().flatten() {
        let rms = ["before", "after"].map(|key| content["pressure_rms_pa"][key].as_f64());
        if let [Some(before), Some(after)] = rms.map(|rms| rms.map(|pa| pa / 1e3)) {
            println!(
                "{run}: {before:.1} kPa RMS from the recorded pressure before, {after:.1} after"
            );
        }
    }
    for note in results["notes"].as_array().into_iter().flatten() {
        println!("{}", word(note));
    }
    for rival in results["refused"].as_array().into_iter().flatten() {
        println!(
            "refused: {} {}",
            word(&rival["label"]),
            rival["evidence"]["misfit"]
        );
    }
    let noise: Result<BTreeMap<String, RecordedSensor>, _> =
        Deserialize::deserialize(&results["noise"]);
    summary::sensors(&noise.map_err(Failure::work)?);
    Ok(())
}
