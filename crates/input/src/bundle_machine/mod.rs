//! The machine section of a bundle (`recordings.yaml`) becomes the tree of a machine file.
//!
//! Programs write bundles, so their values are SI with the unit at the end of the key. A person may write the keys of
//! a machine file in their place (`stroke: 150 mm`, `rod: {length: 600 mm}`), all of them, with units. Beyond the
//! values that the format prescribes a user may add, for each throw or for all:
//!
//! - `contact_relation` (as `relation` in a machine file) and `contact_at_clearance_m`: how contact
//!   parameters follow the clearance, and at which one those of the bundle hold;
//! - `normal_clearance_m`: up to which clearance a joint is healthy;
//! - `{big_end: .., small_end: ..}` in place of one value wherever the two ends share a value.
//!
//! An end without a journal radius is ideal, as main bearing and guide always are. Clearances,
//! speed and pressures are those of a run: see [`run_settings`](crate::run_settings()).

mod throw_values;

use crate::error::{Error, join, shown};
use crate::quantity::{
    AboveZero, Acceleration, Any, FromZero, Inertia, Length, Number, Torque, TorqueSlope, text,
};
use crate::{machine_file, reader, schema};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::sync::LazyLock;
use throw_values::{ThrowValues, needed};

/// What a bundle says about the machine as a whole.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Whole {
    /// Name of the machine.
    #[serde(default)]
    name: Option<String>,
    /// What kind of machine it is, in words.
    #[serde(default, rename = "type")]
    _kind: Option<String>,
    /// Acceleration of gravity; 9.81 where it is left out.
    #[serde(default)]
    gravity_m_s2: Option<Number<FromZero>>,
    /// What turns the crank; a given speed where it is left out.
    #[serde(default)]
    crank: Option<Crank>,
    /// The throws of a machine with several cylinders. What stands one level up holds for all.
    #[serde(default)]
    #[schemars(with = "Option<Vec<ThrowValues>>")]
    throws: Option<Vec<Value>>,
}

/// What turns the crank.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Crank {
    /// Whether the speed is given or follows from the torques.
    driven: Driven,
    /// Moment of inertia of crankshaft, flywheel and rotor; of a free crank.
    #[serde(default)]
    inertia_kg_m2: Option<Number<AboveZero>>,
    /// Torque of the motor at the reference speed of a run; of a free crank.
    #[serde(default)]
    mean_torque_n_m: Option<Number<Any>>,
    /// Torque that the motor adds for every rad/s that the crank falls behind; of a free crank.
    #[serde(default)]
    torque_slope_n_m_s: Option<Number<FromZero>>,
    /// Where the reference speed stands, in words.
    #[serde(default, rename = "reference_speed")]
    _reference_speed: Option<String>,
}

/// How the crank is driven.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Driven {
    /// At the speed of the run.
    Given,
    /// By a motor, against the torque of the throws.
    Free,
}

/// The keys of a machine section: of the whole, and of a throw.
static KEYS: LazyLock<[Vec<String>; 2]> = LazyLock::new(|| {
    [
        schema::generate::<Whole>(),
        schema::generate::<ThrowValues>(),
    ]
    .map(|schema| {
        let keys = schema["properties"].as_object().into_iter().flatten();
        keys.map(|(key, _)| key.clone()).collect()
    })
});

/// The tree of a machine file with what the machine section `machine` of a bundle says.
///
/// [`MachineFile::from_tree`](crate::MachineFile::from_tree) reads it once the speed, the pressures and
/// the clearances of a run are set in it ([`run_settings`](crate::run_settings())).
///
/// Its sensors are those of a bundle, without noise: acceleration of each crosshead, pressure at
/// each head end, crank angle.
///
/// # Errors
/// The first key that is unknown or missing, or value that cannot be; keys are those of the
/// section.
pub fn from_bundle(machine: &Value) -> Result<Value, Error> {
    let Value::Object(section) = machine else {
        let expected = "a section with the machine's values";
        return Err(Error::unexpected("", shown(machine), expected));
    };
    if machine_file::is_machine_file(section) {
        return of_machine_file(machine);
    }
    let [whole, shared] = split(section)?;
    let whole: Whole = reader::read(&Value::Object(whole))?;
    let throws = match &whole.throws {
        None => vec![Throw::only(shared)?],
        Some(throws) if throws.is_empty() => {
            return Err(Error::unexpected(
                "throws",
                "an empty list",
                "at least one throw",
            ));
        }
        Some(throws) => {
            let throws = throws.iter().enumerate();
            let read = throws.map(|(i, own)| Throw::of_several(&shared, own, i));
            read.collect::<Result<_, _>>()?
        }
    };
    let several = whole.throws.is_some();
    let mut tree = Map::new();
    tree.insert("name".into(), whole.name.unwrap_or("machine".into()).into());
    if let Some(size) = whole.gravity_m_s2 {
        let gravity = json!({"acceleration": text::<Acceleration>(size)});
        tree.insert("gravity".into(), gravity);
    }
    tree.insert("crank".into(), crank(&whole.crank, throws[0].radius)?);
    let names = throws.iter().map(|throw| throw.name.as_str());
    tree.insert("sensors".into(), sensors(names, several));
    if several {
        let list: Vec<Value> = throws.into_iter().map(|t| t.sections.into()).collect();
        tree.insert("throws".into(), list.into());
    } else {
        tree.extend(throws.into_iter().flat_map(|throw| throw.sections));
    }
    Ok(Value::Object(tree))
}

/// The tree of a machine section that has the keys of a machine file: all of them may stand there.
fn of_machine_file(machine: &Value) -> Result<Value, Error> {
    let mut tree = machine_file::canonical(machine)?;
    let throws = tree["throws"].as_array().map(|throws| {
        let names = throws
            .iter()
            .map(|throw| throw["name"].as_str().unwrap_or_default());
        names.map(str::to_owned).collect::<Vec<String>>()
    });
    if let Value::Object(section) = &mut tree {
        section.shift_remove("type");
        section.entry("name").or_insert("machine".into());
        let none = [String::new()];
        let names = throws.as_deref().unwrap_or(&none);
        let sensors = sensors(names.iter().map(String::as_str), throws.is_some());
        section.entry("sensors").or_insert(sensors);
    }
    Ok(tree)
}

/// What holds for the machine, and what for its throws.
fn split(section: &Map<String, Value>) -> Result<[Map<String, Value>; 2], Error> {
    let mut parts = [Map::new(), Map::new()];
    for (key, value) in section {
        let Some(part) = KEYS.iter().position(|keys| keys.contains(key)) else {
            let [whole, throw] = &*KEYS;
            let others = throw.iter().filter(|key| !whole.contains(key));
            let known: Vec<&str> = whole.iter().chain(others).map(String::as_str).collect();
            return Err(Error::unknown_key(key, &known));
        };
        parts[part].insert(key.clone(), value.clone());
    }
    Ok(parts)
}

/// A throw on its way into the tree.
struct Throw {
    name: String,
    radius: Number<AboveZero>,
    /// Its sections; in a list of throws also what distinguishes it from the others.
    sections: Map<String, Value>,
}

impl Throw {
    fn only(values: Map<String, Value>) -> Result<Self, Error> {
        Self::read(values, ThrowValues::sections)
    }

    /// Throw `index` of several: its `own` values over those that all have.
    fn of_several(shared: &Map<String, Value>, own: &Value, index: usize) -> Result<Self, Error> {
        let at = format!("throws.{index}");
        let Value::Object(own) = own else {
            let expected = "a section with a throw's values";
            return Err(Error::unexpected(at, shown(own), expected));
        };
        if !own.contains_key("name") {
            return Err(Error::missing(join(&at, "name")));
        }
        let mut values = shared.clone();
        values.extend(own.clone());
        Self::read(values, ThrowValues::entry).map_err(|error| {
            let key = error.key().split('.').next().unwrap_or_default();
            let elsewhere = shared.contains_key(key) && !own.contains_key(key);
            if elsewhere { error } else { error.under(at) }
        })
    }

    fn read(
        values: Map<String, Value>,
        sections: impl Fn(&ThrowValues) -> Result<Map<String, Value>, Error>,
    ) -> Result<Self, Error> {
        let values: ThrowValues = reader::read(&Value::Object(values))?;
        Ok(Self {
            radius: values.crank_radius()?,
            sections: sections(&values)?,
            name: values.name.unwrap_or_default(),
        })
    }
}

fn crank(crank: &Option<Crank>, radius: Number<AboveZero>) -> Result<Value, Error> {
    let drive = match crank {
        Some(crank) if crank.driven == Driven::Free => {
            let inertia = needed(crank.inertia_kg_m2, "crank.inertia_kg_m2")?;
            let mean_torque = needed(crank.mean_torque_n_m, "crank.mean_torque_n_m")?;
            let slope = needed(crank.torque_slope_n_m_s, "crank.torque_slope_n_m_s")?;
            json!({"free": {
                "inertia": text::<Inertia>(inertia),
                "mean_torque": text::<Torque>(mean_torque),
                "slope": text::<TorqueSlope>(slope),
            }})
        }
        _ => json!("given"),
    };
    Ok(json!({"radius": text::<Length>(radius), "drive": drive}))
}

fn sensors<'a>(throws: impl Iterator<Item = &'a str> + Clone, several: bool) -> Value {
    let on = |measure: &str| {
        let sensors = throws.clone().map(|throw| match several {
            true => json!({"measure": measure, "throw": throw}),
            false => json!({"measure": measure}),
        });
        sensors.collect::<Vec<Value>>()
    };
    let mut sensors = on("crosshead_acceleration");
    sensors.extend(on("cylinder_pressure"));
    sensors.push(json!({"measure": "crank_angle"}));
    sensors.into()
}

/// The schema of a machine section.
pub(crate) fn machine_schema() -> Value {
    let mut whole = schema::generate::<Whole>();
    let throw = schema::generate::<ThrowValues>();
    for part in ["properties", "$defs"] {
        if let (Some(whole), Value::Object(throw)) = (whole[part].as_object_mut(), &throw[part]) {
            for (key, value) in throw.iter().filter(|(key, _)| *key != "ThrowValues") {
                whole.entry(key).or_insert(value.clone());
            }
        }
    }
    whole["if"] = json!({"required": ["throws"]});
    whole["else"] = json!({"required": throw["required"]});
    whole["$defs"]["ThrowValues"]["required"] = json!(["name"]);
    whole
}
