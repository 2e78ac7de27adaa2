//! Where in a machine an effect can act, and which of these places the recordings show.

use crate::recorded::is_of_pressures;
use calibrate::Problem;
use input::effects::{Choice, Entry};
use serde_json::Value;

/// A place: keys of the effect's section and words.
pub(crate) type Place = Vec<(&'static str, String)>;

/// A place that is not tried one by one. An effect on a sensor is tried on that of the crosshead's
/// acceleration, the default, and on that of the pressure.
pub(crate) const MEASURE: &str = "measure";
pub(crate) const PRESSURE: &str = "cylinder_pressure";
/// A place at which an effect is tried everywhere and at each alone, where a cylinder has several.
pub(crate) const EITHER: &str = "end";

/// The bearings of the rod.
pub(crate) const BEARINGS: [&str; 2] = ["big_end", "small_end"];

/// The words of a place, each with its key.
pub(crate) fn words(choice: &Choice) -> Place {
    let word = |word: &&'static str| (choice.key, (*word).to_owned());
    choice.words.iter().map(word).collect()
}

/// Whether a joint has clearance in one of the runs.
pub(crate) fn is_clear(problem: &Problem, place: &[(&'static str, String)], joint: &str) -> bool {
    let throw = place.iter().find(|(key, _)| *key == "throw");
    let path = match throw {
        Some((_, throw)) => format!("throws.{throw}.joints.{joint}.clearance"),
        None => format!("joints.{joint}.clearance"),
    };
    let in_run = |settings: &[(String, Value)]| {
        settings
            .iter()
            .any(|(at, value)| at.ends_with(&path) && value != "ideal")
    };
    let nominal = input::paths::get(&problem.tree, &path)
        .ok()
        .flatten()
        .is_some_and(|value| value != "ideal");
    nominal || problem.runs.iter().any(|run| in_run(&run.settings))
}

pub(crate) fn throws(tree: &Value) -> Vec<String> {
    let throws = tree.get("throws").and_then(Value::as_array);
    let names = throws
        .into_iter()
        .flatten()
        .filter_map(|t| t["name"].as_str());
    names.map(str::to_owned).collect()
}

/// Whether a cylinder of the machine has a second chamber.
pub(crate) fn has_crank_end(tree: &Value) -> bool {
    let has = |tree: &Value| tree["cylinder"]["crank_end"].is_object();
    let throws = tree.get("throws").and_then(Value::as_array);
    has(tree) || throws.into_iter().flatten().any(has)
}

/// Whether the recordings distinguish one end of a cylinder from the other. Accelerations do, and so do pressures at
/// the ends where they were recorded.
pub(crate) fn distinguishes_ends(problem: &Problem) -> bool {
    if !is_of_pressures(problem) {
        return true;
    }
    let columns = problem.runs.iter().flat_map(|run| &run.channels);
    let mut pressures = columns.map(|channel| channel.column.as_str());
    let Some(first) = pressures.next() else {
        return true;
    };
    pressures.any(|other| other.contains("crank_end") != first.contains("crank_end"))
}

/// How many recordings of chambers at a place there are; none where no pressure was recorded.
pub(crate) fn recorded(problem: &Problem, place: &[(&'static str, String)]) -> Option<usize> {
    let columns = problem.runs.iter().flat_map(|run| &run.channels);
    let columns = columns.map(|channel| channel.column.as_str());
    let pressures = columns.filter(|column| column.contains("cylinder_pressure"));
    let here = |column: &str| {
        place.iter().all(|(key, word)| match *key {
            EITHER => column.contains("crank_end") == (word == "crank"),
            "throw" => column.starts_with(&format!("{word}.")),
            _ => true,
        })
    };
    let all: Vec<bool> = pressures.map(here).collect();
    (!all.is_empty()).then(|| all.iter().filter(|here| **here).count())
}

/// The places where an effect can act. Without a throw of its own an effect acts at all of them;
/// a joint must be one.
pub(crate) fn places(entry: &Entry, throws: &[String], both_ends: bool) -> Vec<Place> {
    let mut places: Vec<Place> = vec![Vec::new()];
    for choice in entry.places.iter().filter(|c| c.key != EITHER || both_ends) {
        let words: Vec<String> = match choice.key {
            "throw" => throws.to_vec(),
            MEASURE => vec![PRESSURE.to_owned()],
            _ => choice.words.iter().map(|word| (*word).to_owned()).collect(),
        };
        if words.is_empty() {
            continue;
        }
        let everywhere = match choice.key {
            EITHER | MEASURE => places.clone(),
            _ => Vec::new(),
        };
        let each = places.iter().flat_map(|place| {
            words.iter().map(move |word| {
                let mut place = place.clone();
                place.push((choice.key, word.clone()));
                place
            })
        });
        places = everywhere.into_iter().chain(each).collect();
    }
    places
}
