//! `crosshead explain-gap` on a bundle that is simulated here, with its sensors' noise: nothing is
//! hidden in it.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn crosshead(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_crosshead");
    Command::new(program).args(arguments).output().unwrap()
}

fn machine() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml")
}

/// A bundle of one run, without a machine section.
fn bundle(folder: &Path) {
    let machine = machine();
    let simulated = [
        "simulate",
        machine.to_str().unwrap(),
        "--set",
        "joints.big_end.clearance=0.1 mm",
        "--revolutions",
        "12",
        "--transient",
        "30",
        "--out",
        folder.to_str().unwrap(),
    ];
    let made = crosshead(&simulated);
    assert!(made.status.success(), "{made:?}");
    let list = "
runs:
- id: run01
  file: signals.parquet
  speed_rpm: 500
  joints: {big_end: {clearance_m: 0.0001}, small_end: ideal}
  sample_rate_hz: 10000.0
  channels:
  - {name: time, column: t_s, unit: s}
  - {name: crank angle, column: crank_angle_rad, unit: rad}
  - {name: acceleration, column: crosshead_acceleration_m_s2, unit: m/s2}
  - {name: pressure, column: cylinder_pressure_pa, unit: Pa}
";
    fs::write(folder.join("recordings.yaml"), list).unwrap();
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

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
