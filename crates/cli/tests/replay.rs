//! `crosshead replay` on a bundle that is simulated here, with its sensors' noise.

use recordings::formats::parquet::read_table;
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
    let made = crosshead(&[
        "simulate",
        machine().to_str().unwrap(),
        "--set",
        "joints.big_end.clearance=0.1 mm",
        "--revolutions",
        "12",
        "--transient",
        "30",
        "--tolerance",
        "1e-8",
        "--out",
        folder.to_str().unwrap(),
    ]);
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
fn a_bundle_is_replayed_to_within_its_noise() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let out = folder.path().join("replayed");
    let machine = machine();
    let arguments = |more: &[&'static str]| {
        let mut all = vec!["replay", folder.path().to_str().unwrap(), "--out"];
        all.push(out.to_str().unwrap());
        all.extend(more);
        crosshead(&all)
    };
    let without = arguments(&[]);
    assert_eq!(without.status.code(), Some(2));
    assert!(said(&without).contains("--machine"), "{without:?}");
    assert!(!out.exists());
    let with_machine = |more: &[&str]| {
        let mut all = vec!["replay", folder.path().to_str().unwrap()];
        all.extend(["--machine", machine.to_str().unwrap()]);
        all.extend(["--out", out.to_str().unwrap()]);
        all.extend(more);
        crosshead(&all)
    };
    let unknown = with_machine(&["--leave-out", "run1"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(said(&unknown).contains("run01"), "{unknown:?}");

    let replayed = with_machine(&[]);
    assert!(replayed.status.success(), "{replayed:?}");
    let recording = read_table(&folder.path().join("signals.parquet")).unwrap();
    let replay = read_table(&out.join("run01.parquet")).unwrap();
    let names: Vec<&str> = replay
        .schema()
        .columns()
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    let listed = [
        "t_s",
        "crank_angle_rad",
        "crosshead_acceleration_m_s2",
        "cylinder_pressure_pa",
    ];
    assert_eq!(names, listed);
    assert_eq!(replay.rows(), recording.rows());
    let times = |table: &recordings::Table| table.values::<f64>("t_s").unwrap().to_vec();
    for (a, b) in times(&replay).iter().zip(times(&recording)) {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-9);
    }
    let results = fs::read_to_string(out.join("replay.json")).unwrap();
    let results: Value = serde_json::from_str(&results).unwrap();
    let run = &results["runs"]["run01"];
    let misfit = run["misfit"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&misfit), "{misfit}");
    let acceleration = &run["channels"]["crosshead_acceleration_m_s2"];
    let ratio = acceleration["difference"].as_f64().unwrap()
        / acceleration["noise_floor"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&ratio), "{ratio}");

    let again = with_machine(&[]);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("--overwrite"), "{again:?}");
    let bytes = fs::read(out.join("run01.parquet")).unwrap();
    assert!(with_machine(&["--overwrite"]).status.success());
    assert!(fs::read(out.join("run01.parquet")).unwrap() == bytes);
}
