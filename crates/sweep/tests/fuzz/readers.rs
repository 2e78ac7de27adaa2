//! What is read, and what must hold for what is accepted; the answers are in words.

use crate::trial::corpus;
use input::bundle::Bundle;
use input::bundle_channel::meaning;
use input::yaml::{self, Document};
use input::{Error, MachineFile, paths};
use recordings::Manifest;
use serde_json::Value;
use std::path::Path;
use sweep::{Plan, Sweep};

fn answer(result: Result<String, Error>) -> Result<String, String> {
    result.map_err(|error| error.to_string())
}

/// A machine file. One that is accepted is written as it was read.
pub fn machine(text: &str) -> Result<String, String> {
    answer(try_machine(text))
}

fn try_machine(text: &str) -> Result<String, Error> {
    let machine = MachineFile::from_yaml(text, "machine.yaml")?;
    let again = MachineFile::from_yaml(&machine.to_yaml()?, "again.yaml");
    let again = again.expect("what is written of a machine is one");
    assert_eq!(again.to_tree(), machine.to_tree());
    let resolved = machine.resolve()?;
    Ok(format!(
        "{} throws, {} sensors",
        resolved.machine.throws.len(),
        resolved.sensors.len()
    ))
}

/// A sweep file that stands in the folder of the sweeps. The resolved sweep of one that is accepted
/// gives the same plan.
pub fn sweep(text: &str) -> Result<String, String> {
    answer(try_sweep(text))
}

fn try_sweep(text: &str) -> Result<String, Error> {
    let folder = corpus().join("sweep");
    let document = Document::parse(text, "sweep.yaml")?;
    let plan = Sweep::new(document, &folder)?.nominal()?;
    plan.estimate();
    plan.estimate_diagrams();
    let resolved = yaml::to_string(plan.sweep())?;
    let again = Plan::new(&Document::parse(&resolved, "again.yaml")?, &folder);
    assert_eq!(again.expect("a resolved sweep is one").id, plan.id);
    let _ = plan.check_size();
    let _ = plan.clone().with_shards(3);
    let case = plan.case(plan.cases() - 1);
    let found = case.map_or_else(|error| error.to_string(), |case| case.labels.fault);
    Ok(format!(
        "{} parameters, {} diagrams, {found}",
        plan.parameters.len(),
        plan.diagrams.len()
    ))
}

/// A bundle's file, and the machine and the channels of its runs.
pub fn bundle(text: &str) -> Result<String, String> {
    answer(try_bundle(text))
}

fn try_bundle(text: &str) -> Result<String, Error> {
    let bundle = Bundle::new(Path::new("."), Document::parse(text, "recordings.yaml")?)?;
    let tree = match &bundle.machine {
        Value::Null => Value::Null,
        machine => input::from_bundle(machine).map_err(|e| bundle.locate(e.under("machine")))?,
    };
    let throws = tree["throws"].as_array().into_iter().flatten();
    let throws: Vec<&str> = throws.filter_map(|throw| throw["name"].as_str()).collect();
    for (i, run) in bundle.runs.iter().enumerate() {
        for channel in &run.channels {
            meaning(channel, if throws.is_empty() { &[""] } else { &throws })?;
        }
        if !tree.is_null() {
            let key = format!("runs.{i}");
            let mut section = run.section.clone();
            if let Value::Object(section) = &mut section {
                // Told by the recording where the file does not say it.
                section.entry("speed_rpm").or_insert(500.into());
            }
            let settings = input::run_settings(&section, &tree);
            let mut tree = tree.clone();
            for (path, value) in settings.map_err(|e| bundle.locate(e.under(&key)))? {
                paths::set(&mut tree, &path, value)?;
            }
            MachineFile::from_tree(&tree)?.resolve()?;
        }
    }
    Ok(format!(
        "{} runs, {} throws",
        bundle.runs.len(),
        throws.len()
    ))
}

/// A manifest. One that is accepted is written as it was read.
pub fn manifest(text: &str) -> Result<String, String> {
    let path = Path::new("manifest.json");
    match Manifest::from_json(text, path) {
        Err(error) => Err(error.to_string()),
        Ok(manifest) => {
            let written = manifest.to_json().expect("a manifest can be written");
            assert_eq!(
                Manifest::from_json(&written, path).expect("a manifest"),
                manifest
            );
            Ok(format!(
                "{} files, {} failed",
                manifest.files.len(),
                manifest.failed.len()
            ))
        }
    }
}
