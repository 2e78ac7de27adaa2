//! A sweep file to fill in.

use super::schema;
use crate::labels::joints;
use input::template::{Commented, commented};
use input::{Error, Resolved, machine_file};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;

const HEAD: &str = "\
Which cases to simulate. `gen-dataset FILE` makes the dataset, `gen-dataset FILE --dry-run` says how large it becomes.
`crosshead check FILE` finds all mistakes at once, in the machine file, too.
Clearances are radial unless they say diametral: 0.1 mm diametral is 0.05 mm.";

/// A sweep file in `folder` for the machine in the file `path`, to fill in; it is right as it stands. Its faults are in the
/// joints that have a section in the machine file.
///
/// # Errors
/// A machine file that cannot be read, or has a mistake.
pub fn template(folder: &Path, path: &Path) -> Result<String, Error> {
    let machine = machine_file::read(path)?;
    let inside = path.strip_prefix(folder).map(Path::to_owned);
    let absolute = |_| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let named = inside.unwrap_or_else(absolute).display().to_string();
    of_machine(&named, &machine.resolve()?, machine.to_tree())
}

fn of_machine(path: &str, machine: &Resolved, tree: &Value) -> Result<String, Error> {
    let joints = joints(&machine.machine);
    let has_section = |path: &str| {
        let section = path.strip_suffix(".clearance").unwrap_or(path);
        let there = input::paths::get(tree, section);
        there.is_ok_and(|section| section.is_some_and(Value::is_object))
    };
    let bearings = joints.iter().filter(|joint| {
        let is_of_rod = joint.name.ends_with("big_end") || joint.name.ends_with("small_end");
        is_of_rod && has_section(&joint.clearance_path)
    });
    let mut sets = vec![json!([])];
    sets.extend(bearings.map(|joint| json!([joint.name])));
    let rpm = machine.speed * 30.0 / PI;
    let speeds = [0.8, 1.1].map(|share| format!("{} rpm", (share * rpm).round().max(1.0)));
    let mut axes = json!({});
    if sets.len() > 1 {
        axes["joints"] = sets.into();
        axes["clearance"] = json!({"log_uniform": ["0.1 mm", "0.3 mm"]});
    }
    axes["speed"] = json!({"uniform": speeds});
    let content = json!({
        "name": "first-dataset",
        "machine": path,
        "seed": 1,
        "run": {"revolutions": 8, "transient": 10, "chaos": false},
        "windows": {"count": 2, "revolutions": 4},
        "cases": [{"random": {"count": 64, "axes": axes}}],
        "splits": {"train": "70 %", "validation": "15 %", "test": "15 %"},
    });
    commented(&Commented {
        tree: &content,
        schema: &schema(),
        head: HEAD,
        note: &note,
        optional: &|_| true,
    })
}

fn note(path: &str) -> Option<String> {
    let words = match path {
        "cases.0.random.axes.joints" => {
            "Where the fault is: a list of sets of joints, each equally likely. The empty one is a healthy machine."
        }
        "cases.0.random.axes.clearance" => {
            "How large it is, radial. A clearance up to the normal_clearance of the machine file counts as healthy."
        }
        "cases.0.random.axes.speed" => {
            "Any path of the machine file may vary: cylinder.discharge, crosshead.mass, ..."
        }
        _ => return None,
    };
    Some(words.to_owned())
}
