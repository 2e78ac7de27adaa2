//! The page of an explanation, from what `crosshead explain-gap` has written.

use super::calibration::{machine_name, with_curves};
use crate::Failure;
use crate::explain_gap::output::{MACHINE, RESULTS};
use ::report::calibration_page::{Misfit, Run};
use ::report::gap_page::{Effect, Force, GapPage, Map, Parameter, Rival, Scaling, Step};
use input::effects::entry;
use serde_json::Value;
use std::path::Path;

/// Whether an explanation has been written into `folder`.
pub(crate) fn is_at(folder: &Path) -> bool {
    folder.join(RESULTS).is_file()
}

/// What the page of the explanation in `folder` tells.
///
/// # Errors
/// A file that cannot be read, or is none that an explanation writes.
pub(crate) fn page(folder: &Path) -> Result<GapPage, Failure> {
    let path = folder.join(RESULTS);
    let results = Results::read(&path)?;
    let machine = input::machine_file::read(&folder.join(MACHINE))?;
    let content = &results.content;
    let tried = |value: &Value| -> Vec<(String, f64)> {
        let each = list(value);
        each.iter()
            .map(|t| (text(&t["label"]), number(&t["evidence"]["misfit"][1])))
            .collect()
    };
    let effects = list(&content["effects"]);
    let gap = &content["gap"];
    let step = |content: &Value| Step {
        label: text(&content["label"]),
        fitted: number(&content["fitted"]),
        held_out: content["held_out"].as_f64(),
    };
    let effect = |content: &Value| Effect {
        label: text(&content["label"]),
        sentence: text(&content["sentence"]),
        expression: text(&content["expression"]),
        parameters: parameters(content),
        rivals: list(&content["rivals"]).iter().map(rival).collect(),
    };
    Ok(GapPage {
        name: machine_name(machine.to_tree()),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        verdict: text(&content["verdict"]),
        gap: [
            results.number(gap, "gap.before", "before")?,
            results.number(gap, "gap.after", "after")?,
        ],
        pressure_rms_pa: {
            let rms = ["before", "after"].map(|key| gap["pressure_rms_pa"][key].as_f64());
            rms[0].zip(rms[1]).map(|(before, after)| [before, after])
        },
        notes: list(&content["notes"]).iter().map(text).collect(),
        steps: list(&content["steps"]).iter().map(step).collect(),
        effects: effects.iter().map(effect).collect(),
        refused: tried(&content["refused"]),
        forces: list(&content["missing_force"]).iter().map(force).collect(),
        maps: maps(&content["maps"]),
        scaling: list(&content["scaling"]).iter().map(scaling).collect(),
        runs: with_curves(folder, results.runs()?)?,
        next_recording: text(&content["next_recording"]),
    })
}

/// `gap.json`.
struct Results<'a> {
    path: &'a Path,
    content: Value,
}

impl<'a> Results<'a> {
    fn read(path: &'a Path) -> Result<Self, Failure> {
        let wrong = |reason: String| Failure::input(format!("{}: {reason}", path.display()));
        let text = files::read_text(path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        let content = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        Ok(Self { path, content })
    }

    fn wrong(&self, key: &str, expected: &str) -> Failure {
        Failure::input(format!(
            "{}: {key}: expected {expected}; this is no result of this program",
            self.path.display()
        ))
    }

    fn number(&self, section: &Value, place: &str, key: &str) -> Result<f64, Failure> {
        section[key]
            .as_f64()
            .ok_or_else(|| self.wrong(place, "a number"))
    }

    fn runs(&self) -> Result<Vec<Run>, Failure> {
        let runs = self.content["runs"].as_object();
        let runs = runs.ok_or_else(|| self.wrong("runs", "a section"))?;
        let run = |(id, content): (&String, &Value)| {
            let number = |key: &str| self.number(content, &format!("runs.{id}.{key}"), key);
            Ok(Run {
                held_out: content["held_out"] == true,
                misfit: Misfit {
                    before: number("before")?,
                    after: number("after")?,
                },
                channels: Vec::new(),
                id: id.clone(),
            })
        };
        runs.iter().map(run).collect()
    }
}

fn rival(content: &Value) -> Rival {
    Rival {
        label: text(&content["label"]),
        leaves: number(&content["leaves"]),
        explains: number(&content["explains_of_effect"]),
        correlation: content["correlation"].as_f64(),
    }
}

fn force(content: &Value) -> Force {
    let label = format!("{} {}", text(&content["run"]), text(&content["throw"]));
    let force = list(&content["force"]);
    Force {
        label: label.trim().to_owned(),
        force: force.iter().map(number).collect(),
    }
}

fn parameters(effect: &Value) -> Vec<Parameter> {
    let name = text(&effect["effect"]);
    let of = |(key, content): (&String, &Value)| {
        let known = entry(&name).and_then(|entry| entry.parameter(key));
        let ends = content["low"].as_f64().zip(content["high"].as_f64());
        Parameter {
            key: key.clone(),
            unit: known.map_or(String::new(), |p| p.unit.to_owned()),
            value: number(&content["value"]),
            interval: ends.map(|(low, high)| [low, high]),
        }
    };
    effect["parameters"]
        .as_object()
        .into_iter()
        .flatten()
        .map(of)
        .collect()
}

fn scaling(content: &Value) -> Scaling {
    let exponents = list(&content["exponents"]);
    let of = |e: &Value| {
        let error = e["standard_error"].as_f64();
        (text(&e["with"]), number(&e["exponent"]), error)
    };
    Scaling {
        channel: text(&content["channel"]),
        exponents: exponents.iter().map(of).collect(),
    }
}

/// The maps before, each beside the one after.
fn maps(content: &Value) -> Vec<Map> {
    let bands: Vec<String> = list(&content["bands"]).iter().map(text).collect();
    let rows = |map: &Value| -> Vec<Vec<f64>> {
        let rows = list(&map["excess"]);
        rows.iter()
            .map(|row| list(row).iter().map(number).collect())
            .collect()
    };
    let [before, after] = ["before", "after"].map(|key| list(&content[key]));
    let both = before.iter().zip(&after);
    both.map(|(before, after)| {
        let excess = rows(before);
        Map {
            run: text(&before["run"]),
            channel: text(&before["channel"]),
            bands: bands.iter().take(excess.len()).cloned().collect(),
            before: excess,
            after: rows(after),
        }
    })
    .collect()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn list(value: &Value) -> Vec<Value> {
    value.as_array().cloned().unwrap_or_default()
}
