//! A `recordings.yaml` to fill in.

use super::comments::{Commented, commented};
use crate::bundle_channel;
use crate::error::Error;
use crate::schema::{BUNDLE_FORMAT, bundle_schema};
use serde_json::{Value, json};
use std::path::Path;

const HEAD: &str = "\
The recordings of a machine: fill in one entry of `runs` for each run, and save this as recordings.yaml beside the files.
Files are CSV, WAV, MAT, HDF5, Parquet or MCAP. A run recorded in several has `files: [acceleration.csv, pressure.csv]` in the \
place of `file`, and each channel its `file`. Columns, units, rates and speeds are those of the files that were \
beside this one, where they say them. All other numbers are examples to be replaced, and each `name` is a guess.
`crosshead check FOLDER` finds all mistakes at once.
The machine's values stand in a file of their own (--machine), or here in a section `machine` with the keys of one.";

/// What is known of a file of recordings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Name of the file.
    pub file: String,
    /// Its columns but that of time, each with its unit, if it says one.
    pub columns: Vec<(String, Option<String>)>,
    /// Samples per second, if it says so.
    pub sample_rate_hz: Option<f64>,
    /// Speed of the crank, rpm, if it says so.
    pub speed_rpm: Option<f64>,
}

/// A `recordings.yaml` to fill in, with a run for each of `recorded`.
///
/// # Errors
/// None in practice: the content can be written as YAML.
pub fn bundle(recorded: &[Recorded]) -> Result<String, Error> {
    let example = [Recorded {
        file: "run01.csv".into(),
        ..Recorded::default()
    }];
    let recorded = if recorded.is_empty() {
        &example
    } else {
        recorded
    };
    let runs: Vec<Value> = recorded.iter().map(run).collect();
    let tree = json!({"format": BUNDLE_FORMAT, "runs": runs});
    commented(&Commented {
        tree: &tree,
        schema: &bundle_schema(),
        head: HEAD,
        note: &note,
        optional: &|_| false,
    })
}

fn run(recorded: &Recorded) -> Value {
    let file = &recorded.file;
    let id = Path::new(file)
        .file_stem()
        .map_or(file.into(), |stem| stem.to_string_lossy());
    let channels = match recorded.columns.is_empty() {
        true => json!([
            {"name": "time", "column": "t_s", "unit": "s"},
            {"name": "crank angle", "column": "crank_angle_rad", "unit": "rad"},
            {"name": "crosshead acceleration", "column": "crosshead_acceleration_m_s2", "unit": "m/s2"},
            {"name": "cylinder pressure", "column": "cylinder_pressure_pa", "unit": "Pa"},
        ]),
        false => channels(&recorded.columns),
    };
    json!({
        "id": id,
        "file": file,
        "speed_rpm": recorded.speed_rpm.unwrap_or(500.0),
        "load": {"suction_pressure_pa": 105_000.0, "discharge_pressure_pa": 393_000.0},
        "joints": {"big_end": {"clearance_m": 5e-5}, "small_end": {"clearance_m": 5e-5}},
        "sample_rate_hz": recorded.sample_rate_hz.unwrap_or(20_000.0),
        "channels": channels,
    })
}

/// The columns of a file, each called what its name or its unit suggests. Of several whose unit suggests the same, the
/// first is called so, and the others keep the names of their columns, which stand for nothing.
fn channels(columns: &[(String, Option<String>)]) -> Value {
    let mut suggested = Vec::new();
    let channels = columns.iter().map(|(column, unit)| {
        let unit = unit.as_deref().unwrap_or_default();
        let name = bundle_channel::suggested_name(column, unit);
        let name = name.filter(|name| !suggested.contains(name));
        suggested.extend(name.clone());
        let name = name.unwrap_or_else(|| column.clone());
        let mut channel = json!({"name": name, "column": column, "unit": unit});
        if let Some(ambient) = bundle_channel::ambient_pressure(unit) {
            channel["offset"] = ambient.into();
        }
        channel
    });
    channels.collect()
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
            "`name` says what a column is; one of another name, and one that is left out, is not used. One of acceleration and pressure is needed. Of a machine with \
             several throws the name begins with that of the throw: `throw1 cylinder pressure`. A gauge pressure (barg, \
             psig) needs `offset`, the ambient pressure in the same unit. A pulse once per revolution is a channel \
             `tacho`."
        }
        _ => return None,
    };
    Some(words.to_owned())
}
