//! `crosshead explain-gap` on a bundle that is simulated here, with its sensors' noise: nothing is
//! hidden in it.

mod one_run;

use one_run::{bundle, crosshead, machine, said};
use serde_json::Value;
use std::fs;

#[test]
fn where_nothing_is_hidden_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let out = folder.path().join("explained");
    let machine = machine();
    let arguments = [
        "explain-gap",
        folder.path().to_str().unwrap(),
        "--machine",
        machine.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    let told = crosshead(&arguments);
    assert!(told.status.success(), "{}", said(&told));
    assert_eq!(said(&told), "");
    let text = fs::read_to_string(out.join("gap.json")).unwrap();
    let gap: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(gap["verdict"], "no-gap", "{text}");
    assert_eq!(gap["effects"], Value::Array(Vec::new()));
    assert!(gap["gap"]["after"].as_f64().unwrap() < 1.15);
    for file in [
        "machine.yaml",
        "report.html",
        "simulated/run01.parquet",
        "baseline/run01.parquet",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("nothing is missing"));
    // The explained machine has the sensors that recorded.
    let explained = input::machine_file::read(&out.join("machine.yaml")).unwrap();
    assert_eq!(explained.resolve().unwrap().sample_rate, Some(10_000.0));
    let sensor = &gap["noise"]["crosshead_acceleration_m_s2"];
    assert!(
        sensor["rms"].is_number() && sensor["resolution"].is_number(),
        "{sensor}"
    );

    let again = crosshead(&arguments);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("--overwrite"), "{}", said(&again));
}

#[test]
fn a_folder_without_recordings_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("explained");
    let told = crosshead(&[
        "explain-gap",
        folder.path().to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(told.status.code(), Some(2));
    assert!(said(&told).contains("recordings.yaml"), "{}", said(&told));
    assert!(!out.exists());
}
