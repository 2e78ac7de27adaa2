//! Broken files of every kind that people and programs hand in: no reader panics, none takes long, and
//! what is accepted is written as it was read.
//!
//! `CROSSHEAD_FUZZ=10000000` for a long trial of so many files that people write in all, and a tenth as many of
//! each format of recordings; `CROSSHEAD_FUZZ_SEED=2` for other ones; `tests/fuzz/run` does both. Files that are kept are those of `tests/fuzz/corpus`.

mod mutate;
mod parts;
mod random;
mod readers;
mod recordings;
mod records;
mod trial;

use mutate::Mutator;
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

/// A reader of text as one of files; broken texts are text.
fn text(
    read: fn(&str) -> Result<String, String>,
) -> impl FnMut(&[u8]) -> Result<String, String> + Send {
    move |file| read(&String::from_utf8_lossy(file))
}

#[test]
fn machine_files() {
    let words = words(&input::schema::machine_schema());
    trial(
        "machine",
        seeds("machine"),
        Mutator::new(words),
        executions(500, 200),
        text(readers::machine),
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
        Mutator::new(words),
        executions(500, 200),
        text(readers::sweep),
    );
}

#[test]
fn bundles() {
    let words = words(&input::schema::bundle_schema());
    trial(
        "bundle",
        seeds("bundle"),
        Mutator::new(words),
        executions(200, 200),
        text(readers::bundle),
    );
}

#[test]
fn manifests() {
    trial(
        "manifest",
        seeds("manifest"),
        Mutator::new(Vec::new()),
        executions(5000, 399),
        text(readers::manifest),
    );
}

#[test]
fn csv() {
    recordings::recordings("csv", parts::lines);
}

#[test]
fn wav() {
    recordings::recordings("wav", parts::riff);
}

#[test]
fn mat() {
    recordings::recordings("mat", parts::mat);
}

#[test]
fn hdf5() {
    recordings::recordings("hdf5", parts::hdf5);
}

#[test]
fn mcap() {
    recordings::recordings("mcap", parts::mcap);
}

#[test]
fn parquet() {
    recordings::recordings("parquet", parts::parquet);
}

#[test]
fn records_of_a_dataset() {
    records::records(executions(100, 1));
}
