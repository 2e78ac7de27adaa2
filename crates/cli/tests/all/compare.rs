//! `crosshead compare`: a run beside itself, and beside one with more clearance.

use crate::one_run::{crosshead, machine, said};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn run(arguments: &[&str]) -> String {
    let output = crosshead(arguments);
    assert!(output.status.success(), "{}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The folder of a run with this clearance at the big end.
fn simulated(folder: &Path, clearance: &str) -> String {
    let out = folder.join(clearance.replace(' ', "-"));
    let machine = machine();
    let change = format!("joints.big_end.clearance={clearance}");
    let mut arguments = vec!["simulate", machine.to_str().unwrap(), "--set", &change];
    arguments.extend([
        "--revolutions",
        "5",
        "--transient",
        "3",
        "--tolerance",
        "1e-7",
    ]);
    arguments.extend(["--out", out.to_str().unwrap()]);
    run(&arguments);
    out.to_str().unwrap().to_owned()
}

fn compared(folder: &Path, a: &str, b: &str) -> (Value, String, String) {
    let out = folder.join("compared");
    let told = run(&[
        "compare",
        a,
        b,
        "--out",
        out.to_str().unwrap(),
        "--overwrite",
    ]);
    let text = fs::read_to_string(out.join("comparison.json")).unwrap();
    let page = fs::read_to_string(out.join("comparison.html")).unwrap();
    (serde_json::from_str(&text).unwrap(), page, told)
}

#[test]
fn a_run_does_not_differ_from_itself_and_does_from_a_worn_one() {
    let folder = tempfile::tempdir().unwrap();
    let a = simulated(folder.path(), "0.05 mm");
    let b = simulated(folder.path(), "0.3 mm");
    let (same, _, _) = compared(folder.path(), &a, &a);
    let features = same["features"].as_array().unwrap();
    assert!(features.len() > 200, "{}", features.len());
    for feature in features {
        if let Some(difference) = feature["difference"].as_f64() {
            assert_eq!(difference, 0.0, "{feature}");
            assert!(
                feature["ratio"].is_null() || feature["ratio"] == 1.0,
                "{feature}"
            );
        }
    }
    let (other, page, told) = compared(folder.path(), &a, &b);
    let find = |name: &str| {
        let features = other["features"].as_array().unwrap();
        features.iter().find(|f| f["name"] == name).unwrap().clone()
    };
    // What is worn knocks harder; the pressure hardly notices.
    let knocks = find("crosshead_acceleration.residual_rms_m_s2");
    let [x, y] = ["a", "b"].map(|side| knocks[side].as_f64().unwrap());
    assert!((knocks["difference"].as_f64().unwrap() - (y - x)).abs() < 1e-12);
    assert!((knocks["ratio"].as_f64().unwrap() - y / x).abs() < 1e-12);
    let kurtosis = find("crosshead_acceleration.band_0320_0640_m2_s4");
    assert!(kurtosis["ratio"].as_f64().unwrap() > 1.5, "{kurtosis}");
    let pressure = find("cylinder_pressure.mean_pa");
    assert!((pressure["ratio"].as_f64().unwrap() - 1.0).abs() < 0.01);
    // A figure for each of three channels, both of them over angle and frequency.
    assert_eq!(page.matches("<figure").count(), 3, "{told}");
    assert!(page.contains(&a) && page.contains(&b));
    // Those that differ most are printed first, and it is a worn machine's.
    assert_eq!(
        told.lines().filter(|line| line.starts_with("  ")).count(),
        10
    );
}

#[test]
fn a_comparison_that_is_there_stays() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("comparison.json"), "kept").unwrap();
    let out = folder.path().to_str().unwrap();
    let refused = crosshead(&["compare", "a.csv", "b.csv", "--out", out]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("--overwrite"), "{}", said(&refused));
    let gone = crosshead(&["compare", "gone.csv", "b.csv", "--out", out, "--overwrite"]);
    assert_eq!(gone.status.code(), Some(2));
    assert_eq!(
        fs::read_to_string(folder.path().join("comparison.json")).unwrap(),
        "kept"
    );
}

#[test]
fn recordings_without_a_channel_in_common_are_refused_with_the_channels_of_each() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, heading: &str| {
        let path = folder.path().join(name);
        let rows = (0..500).map(|i| format!("{:.4},{}\n", f64::from(i) / 1000.0, i % 7));
        fs::write(&path, format!("{heading}\n{}", rows.collect::<String>())).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let a = written("a.csv", "time [s],acc [m/s^2]");
    let b = written("b.csv", "time [s],pressure [Pa]");
    let out = folder.path().join("compared");
    let output = crosshead(&["compare", &a, &b, "--out", out.to_str().unwrap()]);
    let told = said(&output);
    assert_eq!(output.status.code(), Some(2), "{told}");
    for part in [
        "no channel in common",
        "a.csv: acc [m/s^2]",
        "b.csv: pressure [Pa]",
    ] {
        assert!(told.contains(part), "{told}");
    }
}
