//! How a calibration ends: killed, stopped, or with a model that is wrong.

use super::example_run::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Begins a calibration, and waits until it has evaluated something.
fn begun(folder: &Path, out: &str) -> std::process::Child {
    let mut child = Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .current_dir(folder)
        .args(["calibrate", "bundle", "--out", out])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let checkpoint = folder.join(out).join("checkpoint.bin");
    let size = || fs::metadata(&checkpoint).map_or(0, |m| m.len());
    while size() < 100_000 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

fn results(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("calibration.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// All files of a folder.
fn files(folder: &Path) -> BTreeMap<OsString, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|entry| (entry.file_name(), fs::read(entry.path()).unwrap()))
        .collect()
}

#[test]
fn a_calibration_that_was_killed_or_ended_goes_on_to_the_same_results() {
    let folder = written(&plain());
    let at = |name: &str| folder.path().join(name);
    let mut killed = begun(folder.path(), "killed");
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(at("killed/checkpoint.bin").is_file() && !at("killed/calibration.json").exists());
    let (status, message) = calibrate(folder.path(), &["bundle", "--out", "killed"]);
    assert_eq!(status, 2);
    assert!(
        message.contains("was interrupted: --resume goes on"),
        "{message}"
    );

    let ended = begun(folder.path(), "ended");
    let (status, message) = calibrate(folder.path(), &["bundle", "--out", "ended", "--resume"]);
    assert_eq!(status, 1);
    assert!(message.contains("another process is at work"), "{message}");
    let kill = Command::new("kill").arg(ended.id().to_string()).status();
    assert!(kill.unwrap().success());
    let output = ended.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("stopped before the end"), "{message}");
    assert_eq!(results(&at("ended"))["complete"], false);

    calibrate(folder.path(), &["bundle", "--out", "whole"]);
    for out in ["killed", "ended"] {
        let (status, message) = calibrate(folder.path(), &["bundle", "--out", out, "--resume"]);
        assert_eq!(status, 0, "{message}");
        assert!(files(&at(out)) == files(&at("whole")), "{out}");
        assert!(!at(out).join("checkpoint.bin").exists());
    }
}

#[test]
fn a_wrong_model_has_no_intervals_and_the_wrong_value_is_named() {
    let columns = plain();
    let wrong = yaml(&columns).replace("crosshead_mass_kg: 18.0", "crosshead_mass_kg: 18.54");
    let folder = write(&wrong, &csv(&columns));
    let program = Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .current_dir(folder.path())
        .args([
            "calibrate",
            "bundle",
            "--out",
            "out",
            "--optimiser",
            "levenberg-marquardt",
        ])
        .output()
        .unwrap();
    let said = String::from_utf8(program.stdout).unwrap();
    println!("{said}");
    let results = results(&folder.path().join("out"));
    let corrections = results["corrections"].as_array().unwrap();
    let mass = corrections
        .iter()
        .find(|c| c["path"] == "crosshead.mass")
        .unwrap();
    assert!(
        (mass["value"].as_f64().unwrap() - 18.0).abs() < 0.05,
        "{mass}"
    );
    assert_eq!(mass["nominal"], 18.54);
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("Values of the data sheet"));
    if results["model_is_adequate"] == false {
        for (path, parameter) in results["parameters"].as_object().unwrap() {
            assert!(
                parameter["low"].is_null() && parameter["high"].is_null(),
                "{path}"
            );
        }
        assert!(said.contains("the model is wrong") && page.contains("The model is wrong"));
    }
}
