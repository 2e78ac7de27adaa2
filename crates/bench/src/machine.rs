//! A machine of a test bench, and the conditions of its runs.

use crate::settings::{BenchMachine, HiddenEffects};
use calibrate::ClearJoint;
use input::bundle::Bundle;
use input::paths;
use input::yaml::Document;
use serde_json::{Map, Value};
use std::path::Path;

/// A machine and the runs that are recorded of it.
pub struct Machine {
    /// What it is called.
    pub name: String,
    /// Its section in a bundle: all that the workflow learns of it.
    pub section: Value,
    /// Its machine file, without effects, at the conditions of the first run where it has none.
    pub tree: Value,
    /// The runs.
    pub runs: Vec<RunConditions>,
    /// The joints that are clear in some run.
    pub joints: Vec<ClearJoint>,
    /// Whether the pressures are recorded.
    pub pressure: bool,
}

/// The conditions of a run.
pub struct RunConditions {
    /// Its name.
    pub id: String,
    /// What a bundle says of them.
    pub section: Map<String, Value>,
    /// The same as paths and values of the machine file.
    pub settings: Vec<(String, Value)>,
}

impl Machine {
    /// The machines of the settings in the file with the content `document`; paths start from the folder `base`.
    ///
    /// # Errors
    /// As [`Machine::open`], with the lines of mistakes.
    pub fn all(
        settings: &HiddenEffects,
        document: &Document,
        base: &Path,
    ) -> Result<Vec<Self>, input::Error> {
        let open = |(i, entry): (usize, &BenchMachine)| {
            Self::open(entry, base).map_err(|error| match error.place() {
                Some(_) => error,
                None => document.locate(error.under(format!("machines.{i}"))),
            })
        };
        settings.machines.iter().enumerate().map(open).collect()
    }

    /// The machine of an entry of the file; paths start from the folder `base`.
    ///
    /// # Errors
    /// An invalid bundle or machine section, or runs that it does not have; keys of mistakes in
    /// the entry are its own.
    pub fn open(entry: &BenchMachine, base: &Path) -> Result<Self, input::Error> {
        let folder = base.join(&entry.bundle);
        if !Bundle::is_at(&folder) {
            return Err(input::Error::clash(
                "bundle",
                "a folder with recordings.yaml",
            ));
        }
        let bundle = Bundle::read(&folder)?;
        let mut section = bundle.machine.clone();
        if let Value::Object(section) = &mut section {
            section.extend(entry.machine.clone());
        }
        let mut tree = input::from_bundle(&section).map_err(|error| {
            let key = error.key().split('.').next().unwrap_or_default();
            let own = entry.machine.contains_key(key);
            let error = error.under("machine");
            if own { error } else { bundle.locate(error) }
        })?;
        let ids: Vec<&str> = bundle.runs.iter().map(|run| run.id.as_str()).collect();
        for (i, id) in entry.runs.iter().flatten().enumerate() {
            if !ids.contains(&id.as_str()) {
                return Err(input::Error::unknown_name(format!("runs.{i}"), id, &ids));
            }
        }
        let mut runs = Vec::new();
        for (i, run) in bundle.runs.iter().enumerate() {
            if entry
                .runs
                .as_ref()
                .is_some_and(|runs| !runs.contains(&run.id))
            {
                continue;
            }
            let section = conditions(&run.section, entry);
            let settings = input::run_settings(&section.clone().into(), &tree)
                .map_err(|error| bundle.locate(error.under(format!("runs.{i}"))))?;
            runs.push(RunConditions {
                id: run.id.clone(),
                section,
                settings,
            });
        }
        let Some(first) = runs.first() else {
            return Err(input::Error::clash("runs", "one run or more"));
        };
        for (path, value) in &first.settings {
            paths::set(&mut tree, path, value.clone())?;
        }
        let of_runs = runs.iter().map(|run| &run.settings[..]);
        let joints = ClearJoint::in_runs(&tree, of_runs);
        let joints = joints.map_err(|error| input::Error::clash("machine", error))?;
        Ok(Self {
            name: entry.name.clone(),
            section,
            joints,
            tree,
            runs,
            pressure: entry.pressure.unwrap_or(true),
        })
    }

    /// The names of its throws; none for a machine of one.
    pub fn throws(&self) -> Vec<&str> {
        let throws = self.tree["throws"].as_array().into_iter().flatten();
        throws.filter_map(|throw| throw["name"].as_str()).collect()
    }

    /// Whether a cylinder has a chamber at the crank end.
    pub fn is_double_acting(&self) -> bool {
        let throws = self.tree["throws"].as_array().into_iter().flatten();
        let mut parts = throws.chain([&self.tree]);
        parts.any(|part| part["cylinder"]["crank_end"].is_object())
    }

    /// Its machine file at the conditions of a run.
    ///
    /// # Errors
    /// A path that the file does not have.
    pub fn at(&self, tree: &Value, run: &RunConditions) -> Result<Value, input::Error> {
        let mut tree = tree.clone();
        for (path, value) in &run.settings {
            paths::set(&mut tree, path, value.clone())?;
        }
        Ok(tree)
    }
}

/// The conditions in the section of a bundle's run, with the factors of the entry.
fn conditions(section: &Value, entry: &BenchMachine) -> Map<String, Value> {
    let speed = entry.speed_factor.map_or(1.0, |factor| factor.get());
    let clearance = entry.clearance_factor.map_or(1.0, |factor| factor.get());
    let listed = ["speed_rpm", "speed_reference_rpm", "load", "joints"];
    let mut conditions = Map::new();
    for key in listed {
        if let Some(value) = section.get(key) {
            let mut value = value.clone();
            if let Some(rpm) = value.as_f64() {
                value = (rpm * speed).into();
            } else {
                scale(&mut value, "clearance_m", clearance);
            }
            conditions.insert(key.to_owned(), value);
        }
    }
    conditions
}

/// Multiplies all numbers called `key`.
fn scale(tree: &mut Value, key: &str, factor: f64) {
    for (name, value) in tree.as_object_mut().into_iter().flatten() {
        match value.as_f64() {
            Some(number) if name == key => *value = (number * factor).into(),
            _ => scale(value, key, factor),
        }
    }
}
