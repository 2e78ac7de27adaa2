//! `crosshead explain-gap` on a bundle that is simulated here, with its sensors' noise: nothing is
//! hidden in it.

use crate::one_run;

use one_run::{bundle, crosshead, machine, said};
use serde_json::Value;
use std::fs;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

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
        "--quiet",
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
    assert!(page.contains("no effect is missing"));
    // The explained machine has the sensors that recorded.
    let explained = input::machine_file::read(&out.join("machine.yaml")).unwrap();
    assert_eq!(explained.resolve().unwrap().sample_rate, Some(10_000.0));
    let sensor = &gap["noise"]["crosshead_acceleration_m_s2"];
    assert!(
        sensor["rms"].is_number() && sensor["resolution"].is_number(),
        "{sensor}"
    );

    // Killed, and called again: the same bytes.
    let other = folder.path().join("again");
    let mut arguments_of_other = arguments;
    arguments_of_other[5] = other.to_str().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .args(arguments_of_other)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let journal = other.join("finished.jsonl");
    let size = || fs::metadata(&journal).map_or(0, |m| m.len());
    while size() == 0 && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(5));
    }
    let second = crosshead(&arguments_of_other);
    assert_eq!(second.status.code(), Some(1), "{}", said(&second));
    assert!(said(&second).contains("another process is at work"));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!other.join("gap.json").exists());
    let resumed = crosshead(&arguments_of_other);
    assert!(resumed.status.success(), "{}", said(&resumed));
    for file in ["gap.json", "machine.yaml", "report.html"] {
        let [whole, resumed] = [&out, &other].map(|folder| fs::read(folder.join(file)).unwrap());
        assert!(whole == resumed, "{file}");
    }

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
