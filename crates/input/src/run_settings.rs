//! The conditions of a bundle's run: what it sets in the machine file.

use crate::choice::{Ideal, Or};
use crate::error::{Error, Problem, shown};
use crate::paths;
use crate::quantity::{AboveZero, FromZero, Length, Number, Pressure, text};
use crate::reader;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};

/// Gas pressures of a throw, absolute.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Load {
    /// Suction pressure.
    suction_pressure_pa: Number<AboveZero>,
    /// Discharge pressure.
    discharge_pressure_pa: Number<AboveZero>,
}

/// The joints of a throw as the user believes them to be.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Joints {
    /// Joint between crank pin and connecting rod.
    #[serde(default)]
    big_end: Option<Joint>,
    /// Joint between crosshead pin and connecting rod.
    #[serde(default)]
    small_end: Option<Joint>,
    /// Joint between crosshead and guide.
    #[serde(default)]
    guide: Option<Joint>,
}

/// The word `ideal`, or a clearance.
type Joint = Or<Ideal, Clear>;

/// A joint with clearance.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Clear {
    /// Radial clearance.
    clearance_m: Number<FromZero>,
}

/// What an entry of a bundle's list of runs sets in `machine`, the tree of a machine file.
///
/// It sets the speed (for a free crank `speed_reference_rpm`), the pressures of each throw, and the
/// clearances of its joints. Paths and values are those of [`paths::set`]. Keys that the run leaves out
/// stay as the machine has them.
///
/// # Errors
/// The first value that cannot be, key that is unknown, or throw that the machine does not have;
/// keys are those of the run.
pub fn run_settings(run: &Value, machine: &Value) -> Result<Vec<(String, Value)>, Error> {
    let mut settings: Vec<(String, Value)> = Vec::new();
    if let Some(rpm) = speed(run, machine)? {
        settings.push(("speed".into(), json!(format!("{} rpm", rpm.get()))));
    }
    for place in of_throws(run, "load", machine)? {
        let load: Load = place.read()?;
        for (side, pressure) in [
            ("suction", load.suction_pressure_pa),
            ("discharge", load.discharge_pressure_pa),
        ] {
            let path = format!("{}cylinder.{side}", place.prefix);
            settings.push((path, text::<Pressure>(pressure)));
        }
    }
    for place in of_throws(run, "joints", machine)? {
        let joints: Joints = place.read()?;
        for (name, joint) in [
            ("big_end", joints.big_end),
            ("small_end", joints.small_end),
            ("guide", joints.guide),
        ] {
            let section = format!("{}joints.{name}", place.prefix);
            let clearance = match joint {
                None => continue,
                // A joint without a section is ideal already.
                Some(Or::Scalar(Ideal)) if !has_section(machine, &section)? => continue,
                Some(Or::Scalar(Ideal)) => json!("ideal"),
                Some(Or::Section(clear)) => text::<Length>(clear.clearance_m),
            };
            settings.push((format!("{section}.clearance"), clearance));
        }
    }
    Ok(settings)
}

/// The speed that the run sets, rpm.
fn speed(run: &Value, machine: &Value) -> Result<Option<Number<AboveZero>>, Error> {
    let free = machine["crank"]["drive"]["free"].is_object();
    let key = if free {
        "speed_reference_rpm"
    } else {
        "speed_rpm"
    };
    match run.get(key) {
        Some(value) => reader::read(value).map(Some).map_err(|e| e.under(key)),
        None if machine.get("speed").is_some() => Ok(None),
        None => {
            let reason = match free {
                true => "the speed at which the motor of the free crank gives its mean torque",
                false => "the speed of the crank",
            };
            let expected = Some(reason.to_owned());
            Err(Error::new(key, Problem::Missing { expected }))
        }
    }
}

/// What a run says about a throw.
struct OfThrow<'a> {
    /// What stands before the throw's paths in the machine file.
    prefix: String,
    /// Key in the run.
    key: String,
    value: &'a Value,
}

impl OfThrow<'_> {
    fn read<'de, T: Deserialize<'de>>(&'de self) -> Result<T, Error> {
        reader::read(self.value).map_err(|error| error.under(&self.key))
    }
}

/// What the run has at `key`, throw by throw.
fn of_throws<'a>(run: &'a Value, key: &str, machine: &Value) -> Result<Vec<OfThrow<'a>>, Error> {
    let (Some(value), throws) = (run.get(key), machine["throws"].as_array()) else {
        return Ok(Vec::new());
    };
    let Some(throws) = throws else {
        return Ok(vec![OfThrow {
            prefix: String::new(),
            key: key.to_owned(),
            value,
        }]);
    };
    let names: Vec<&str> = throws.iter().filter_map(|t| t["name"].as_str()).collect();
    let Value::Object(by_throw) = value else {
        let expected = format!("a section with the keys {}", names.join(", "));
        return Err(Error::unexpected(key, shown(value), expected));
    };
    let places = by_throw.iter().map(|(name, value)| {
        if !names.contains(&name.as_str()) {
            return Err(Error::unknown_key(name, &names).under(key));
        }
        Ok(OfThrow {
            prefix: format!("throws.{name}."),
            key: format!("{key}.{name}"),
            value,
        })
    });
    places.collect()
}

fn has_section(machine: &Value, path: &str) -> Result<bool, Error> {
    Ok(paths::get(machine, path)?.is_some_and(Value::is_object))
}
