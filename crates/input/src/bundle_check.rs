//! Everything that can be wrong in a `recordings.yaml`, before any recording is read.

use crate::bundle::Bundle;
use crate::bundle_machine::from_bundle;
use crate::error::Error;
use crate::machine_file::MachineFile;
use crate::paths;
use crate::run_settings::run_settings;
use crate::schema::bundle_schema;
use crate::yaml::Document;
use serde_json::Value;
use std::path::Path;

/// Checks the bundle in `folder` whose `recordings.yaml` has the content `document`: its machine section at the
/// conditions of each run, the channels, and where the recordings are.
///
/// # Errors
/// All mistakes, with their lines.
pub fn check(folder: &Path, document: &Document) -> Result<(), Error> {
    document.collect(bundle_schema, |tree| {
        let bundle = Bundle::new(folder, Document::from_tree(tree.clone()))?;
        let machine = match &bundle.machine {
            Value::Null => None,
            section => Some(from_bundle(section).map_err(|e| e.under("machine"))?),
        };
        for (i, run) in bundle.runs.iter().enumerate() {
            let key = format!("runs.{i}");
            if let Some(machine) = &machine {
                at_run(machine, &run.section, &key)?;
            }
            bundle.meanings(i, machine.as_ref().unwrap_or(&Value::Null))?;
            bundle.path_of(run)?;
        }
        Ok(())
    })
}

/// The machine at the conditions of the run at `key`.
fn at_run(machine: &Value, run: &Value, key: &str) -> Result<(), Error> {
    let settings = run_settings(run, machine).map_err(|e| e.under(key))?;
    let mut conditions = machine.clone();
    for (path, value) in &settings {
        paths::set(&mut conditions, path, value.clone()).map_err(|e| e.under(key))?;
    }
    let resolved = MachineFile::from_tree(&conditions).and_then(|file| file.resolve());
    let is_set = |key: &str| settings.iter().any(|(path, _)| path == key);
    resolved
        .map(|_| ())
        .map_err(|error| match is_set(error.key()) {
            true => error.under(key),
            false => error.under("machine"),
        })
}
