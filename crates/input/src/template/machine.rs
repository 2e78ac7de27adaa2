//! A machine file to fill in.

use super::comments::{Commented, commented};
use crate::error::Error;
use crate::machine_file::synonyms::{Meaning, SYNONYMS};
use crate::machine_file::{MachineFile, canonical_key};
use crate::quantity::{Length, Positive};
use crate::schema::MACHINE;
use crate::tree::find;
use serde_json::{Map, Value, json};
use simulate::sensors::SENSORS;

/// The machine whose values stand in a file where none is named.
const EXAMPLE: &str = include_str!("../../../../data/machines/single-stage.yaml");

/// What a machine file to fill in is asked to have.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked<'a> {
    /// The machine whose values stand in it.
    pub like: Option<&'a MachineFile>,
    /// Number of throws; that of the other machine where it is left out.
    pub throws: Option<usize>,
    /// Whether gas works on both sides of the pistons.
    pub double_acting: bool,
}

/// Above the file.
const HEAD: &str = "\
A machine to fill in. Every value is one of an example: replace those that your data sheet states.
`crosshead check FILE` finds all mistakes at once. Values carry units: mm, in, kg, lb, MPa, bar, psi, rpm, ...
Pressures are absolute; 20 barg or 300 psig need the key ambient_pressure.
Clearances are radial unless they say diametral: 0.1 mm diametral is 0.05 mm.
A radius may be stated as the diameter under its usual name: stroke, bore, rod_diameter, crank_pin_diameter.";

/// A machine file to fill in; it is right as it stands.
///
/// # Errors
/// A machine to be like that cannot be written as YAML.
pub fn machine(asked: &Asked) -> Result<String, Error> {
    let own;
    let like = match asked.like {
        Some(like) => like,
        None => {
            own = MachineFile::from_yaml(EXAMPLE, "single-stage.yaml")?;
            &own
        }
    };
    let mut tree = like.to_tree().clone();
    let throws = tree["throws"].as_array().map(Vec::len);
    match (asked.throws, throws) {
        (Some(1), None) | (None, _) => {}
        (Some(number), _) if Some(number) == throws => {}
        (Some(number), _) => set_throws(&mut tree, number),
    }
    if asked.double_acting {
        make_double_acting(&mut tree);
    }
    commented(&Commented {
        tree: &tree,
        schema: &MACHINE,
        head: HEAD,
        note: &note,
        optional: &|key| !is_of_each_throw(&tree, key),
    })
}

/// Whether every throw has the key of its own, so that nothing of it stands at the top.
fn is_of_each_throw(tree: &Value, key: &str) -> bool {
    let throws = tree["throws"].as_array();
    throws.is_some_and(|throws| throws.iter().all(|throw| find(throw, key).is_some()))
}

/// Names that data sheets have for the key at `path`.
fn note(path: &str) -> Option<String> {
    let key = canonical_key(path);
    let names = |of: &[Meaning]| {
        let names = SYNONYMS
            .iter()
            .filter(|s| s.key == key && of.contains(&s.meaning));
        names.map(|s| s.name).collect::<Vec<_>>()
    };
    let mut words = Vec::new();
    for (meaning, before, after) in [
        (Meaning::Same, "Also: ", "."),
        (
            Meaning::Half,
            "Or twice this, as data sheets have it: ",
            ".",
        ),
        (Meaning::Rpm, "Or a plain number: ", "."),
        (Meaning::OfStroke, "Or in % of the swept volume: ", "."),
    ] {
        let names = names(&[meaning]);
        if !names.is_empty() {
            words.push(format!("{before}{}{after}", names.join(", ")));
        }
    }
    (!words.is_empty()).then(|| words.join(" "))
}

/// Gives the machine so many throws: the sections of its only throw, or of the first, hold for all of them.
fn set_throws(tree: &mut Value, number: usize) {
    let old = tree["throws"].take();
    let first = old.get(0).cloned().unwrap_or_default();
    if let (Value::Object(top), Value::Object(first)) = (&mut *tree, &first) {
        for (key, value) in first {
            match key.as_str() {
                "name" | "direction" | "crank_pin_angle" | "crank_radius" => {}
                key => overlay(top.entry(key).or_insert(json!({})), value),
            }
        }
    }
    let names: Vec<String> = (1..=number).map(|i| format!("throw{i}")).collect();
    let pairs = number.div_ceil(2) as f64;
    let throws = names.iter().enumerate().map(|(i, name)| {
        // Opposed pairs, spread over half a turn.
        let angle = 180.0 * ((i / 2) as f64 / pairs + (i % 2) as f64);
        let direction = if i % 2 == 0 { "forward" } else { "opposed" };
        let angle = format!("{} deg", angle.round());
        json!({"name": name, "direction": direction, "crank_pin_angle": angle})
    });
    let throws: Value = throws.collect();
    let sensors = sensors(
        &tree["sensors"],
        &old,
        if number > 1 { &names } else { &[] },
    );
    if let Value::Object(top) = tree {
        top.shift_remove("throws");
        if number > 1 {
            top.insert("throws".to_owned(), throws);
        }
        top.insert("sensors".to_owned(), sensors);
        // They may name throws that are no longer there.
        top.insert("effects".to_owned(), json!([]));
    }
}

/// `own` on top of what stands there.
fn overlay(below: &mut Value, own: &Value) {
    match (below, own) {
        (Value::Object(below), Value::Object(own)) => {
            for (key, value) in own {
                overlay(below.entry(key).or_insert(Value::Null), value);
            }
        }
        (below, own) => *below = own.clone(),
    }
}

/// The sensors of the first throw on every throw, and those of the whole machine.
fn sensors(sensors: &Value, old: &Value, names: &[String]) -> Value {
    let first = old[0]["name"].as_str();
    let mut all = Vec::new();
    for sensor in sensors.as_array().into_iter().flatten() {
        let measure = sensor["measure"].as_str().unwrap_or_default();
        let entry = SENSORS.iter().find(|entry| entry.name == measure);
        if !entry.is_some_and(|entry| entry.is_of_throw()) {
            all.push(sensor.clone());
        } else if sensor["throw"].as_str() == first {
            let mut sensor = sensor.as_object().cloned().unwrap_or_default();
            sensor.shift_remove("throw");
            match names {
                [] => all.push(sensor.into()),
                names => all.extend(names.iter().map(|name| on_throw(&sensor, name))),
            }
        }
    }
    all.into()
}

fn on_throw(sensor: &Map<String, Value>, name: &str) -> Value {
    let mut placed = Map::new();
    for (key, value) in sensor {
        placed.insert(key.clone(), value.clone());
        if key == "measure" {
            placed.insert("throw".to_owned(), name.into());
        }
    }
    placed.into()
}

/// Gives every cylinder a second chamber: a rod of a third of the piston, and the gap of the head end.
fn make_double_acting(tree: &mut Value) {
    let throws = tree["throws"].as_array().map_or(0, Vec::len);
    let places: Vec<String> = match throws {
        0 => vec![String::new()],
        throws => (0..throws).map(|i| format!("throws.{i}.")).collect(),
    };
    for place in places {
        let stated = |key: &str| {
            let own = find(tree, &format!("{place}cylinder.{key}"));
            let value = own.or_else(|| find(tree, &format!("cylinder.{key}")))?;
            Some(value.clone())
        };
        let (radius, gap) = (stated("piston_radius"), stated("head_clearance"));
        if stated("crank_end.rod_radius").is_some() && stated("crank_end.clearance").is_some() {
            continue;
        }
        let own = find(tree, &format!("{place}cylinder.piston_radius")).is_some();
        let place = if own { place.as_str() } else { "" };
        let radius = radius.as_ref().and_then(Value::as_str).unwrap_or_default();
        let radius = Positive::<Length>::parse(radius).map_or(0.05, |radius| radius.si());
        let end = json!({
            "rod_radius": format!("{} mm", (radius * 1e3 / 3.0).ceil()),
            "clearance": gap.unwrap_or("20 mm".into()),
        });
        crate::tree::put(tree, &format!("{place}cylinder.crank_end"), end);
    }
}
