//! Broken files of every kind that people and programs hand in: no reader panics, none takes long, and
//! what is accepted is written as it was read.
//!
//! `CROSSHEAD_FUZZ=10000000` for a long trial of so many files in all, `CROSSHEAD_FUZZ_SEED=2` for
//! other ones; `tests/fuzz/run` does both. Files that are kept are those of `tests/fuzz/corpus`.

mod mutate;
mod random;
mod readers;
mod records;
mod trial;

use serde_json::Value;
use trial::{executions, seeds, trial};

/// The keys and names that a JSON Schema knows.
fn words(schema: &Value) -> Vec<String> {
    let mut words = Vec::new();
    match schema {
        Value::Object(section) => {
            let keys = section.get("properties").and_then(Value::as_object);
            words.extend(keys.into_iter().flat_map(|keys| keys.keys().cloned()));
            words.extend(section.values().flat_map(self::words));
        }
        Value::Array(items) => words.extend(items.iter().flat_map(self::words)),
        Value::String(text) if text.len() < 24 => words.push(text.clone()),
        _ => {}
    }
    words.sort();
    words.dedup();
    words
}

#[test]
fn machine_files() {
    let words = words(&input::schema::machine_schema());
    trial(
        "machine",
        seeds("machine"),
        words,
        executions(500, 200),
        readers::machine,
    );
}

#[test]
fn sweep_files() {
    let mut words = words(&sweep::sweep_file::schema());
    words.extend(
        [
            "joints",
            "clearance",
            "load",
            "speed",
            "big_end",
            "small_end",
            "ideal",
        ]
        .map(String::from),
    );
    words.extend(
        [
            "joints.big_end.clearance",
            "cylinder.suction",
            "sensors.0.range",
        ]
        .map(String::from),
    );
    trial(
        "sweep",
        seeds("sweep"),
        words,
        executions(500, 200),
        readers::sweep,
    );
}

#[test]
fn bundles() {
    let words = words(&input::schema::bundle_schema());
    trial(
        "bundle",
        seeds("bundle"),
        words,
        executions(500, 200),
        readers::bundle,
    );
}

#[test]
fn manifests() {
    trial(
        "manifest",
        seeds("manifest"),
        Vec::new(),
        executions(5000, 399),
        readers::manifest,
    );
}

#[test]
fn records_of_a_dataset() {
    records::records(executions(100, 1));
}
