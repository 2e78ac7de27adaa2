//! A `recordings.yaml` to fill in.

use super::comments::{Commented, commented};
use crate::error::Error;
use crate::schema::{BUNDLE_FORMAT, bundle_schema};
use serde_json::{Value, json};
use std::path::Path;

const HEAD: &str = "\
The recordings of a machine: fill in one entry of `runs` for each run, and save this as recordings.yaml beside the files.
Files are CSV, WAV, MAT, HDF5, Parquet or MCAP. A run recorded in several has `files: [acceleration.csv, pressure.csv]` in the \
place of `file`, and each channel its `file`.
`crosshead check FOLDER` finds all mistakes at once.
The machine's values stand in a file of their own (--machine), or here in a section `machine` with the keys of one.";

/// A `recordings.yaml` to fill in, with a run for each of `files`.
///
/// # Errors
/// None in practice: the content can be written as YAML.
pub fn bundle(files: &[String]) -> Result<String, Error> {
    let example = ["run01.csv".to_owned()];
    let files = if files.is_empty() { &example } else { files };
    let runs: Vec<Value> = files.iter().map(|file| run(file)).collect();
    let tree = json!({"format": BUNDLE_FORMAT, "runs": runs});
    commented(&Commented {
        tree: &tree,
        schema: &bundle_schema(),
        head: HEAD,
        note: &note,
        optional: &|_| false,
    })
}

/// The recordings in `folder`, in the order of their names.
pub fn recordings_in(folder: &Path) -> Vec<String> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let is_recording = |name: &String| {
        let ending = Path::new(name).extension();
        ending.is_some_and(|ending| ending == "csv" || ending == "parquet")
    };
    let mut names: Vec<String> = names.filter(is_recording).collect();
    names.sort();
    names
}

fn run(file: &str) -> Value {
    let id = Path::new(file)
        .file_stem()
        .map_or(file.into(), |stem| stem.to_string_lossy());
    json!({
        "id": id,
        "file": file,
        "speed_rpm": 500,
        "load": {"suction_pressure_pa": 105_000.0, "discharge_pressure_pa": 393_000.0},
        "joints": {"big_end": {"clearance_m": 5e-5}, "small_end": {"clearance_m": 5e-5}},
        "sample_rate_hz": 20_000.0,
        "channels": [
            {"name": "time", "column": "t_s", "unit": "s"},
            {"name": "crank angle", "column": "crank_angle_rad", "unit": "rad"},
            {"name": "crosshead acceleration", "column": "crosshead_acceleration_m_s2", "unit": "m/s2"},
            {"name": "cylinder pressure", "column": "cylinder_pressure_pa", "unit": "Pa"},
        ],
    })
}

fn note(path: &str) -> Option<String> {
    let words = match path {
        "runs.0.load" => {
            "Absolute pressures in the suction and the discharge line during the run, Pa. Of a machine with several \
             throws: a section of these for each throw, by its name."
        }
        "runs.0.channels.0.column" => {
            "As the first line of the file has it, with or without its unit in brackets."
        }
        "runs.0.joints" => {
            "What you believe: half the difference of the diameters, m. A joint that is left out is as the machine \
             has it."
        }
        "runs.0.channels" => {
            "Columns that are left out are not used. One of acceleration and pressure is needed. Of a machine with \
             several throws the name begins with that of the throw: `throw1 cylinder pressure`. A gauge pressure (barg, \
             psig) needs `offset`, the ambient pressure in the same unit. A pulse once per revolution is a channel \
             `tacho`."
        }
        _ => return None,
    };
    Some(words.to_owned())
}
