//! `--json`: the results of a verb as one document on standard output.

use crate::small_sweep::{crosshead, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

fn document(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"))
}

#[test]
fn mistakes_are_a_document_with_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("machine.yaml");
    let wrong = crate::check::MACHINE.replace("  mass: 12 kg", "  mass: 12");
    fs::write(&path, wrong).unwrap();
    let output = crosshead(&["check", "--json"]).arg(&path).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let found = document(&output);
    assert_eq!(found[0]["kind"], "a machine");
    let mistake = &found[0]["mistakes"][0];
    assert_eq!(mistake["line"], 7);
    assert_eq!(mistake["key"], "rod.mass");
    assert!(text(&output.stderr).contains("rod.mass"));
}

#[test]
fn features_tell_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let recording =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/recordings/matlab-v7.mat");
    let table = folder.path().join("features.parquet");
    let output = crosshead(&["features", "--json"])
        .arg(recording)
        .arg("--out")
        .arg(&table)
        .output()
        .unwrap();
    let found = document(&output);
    assert_eq!(found["table"], table.display().to_string());
    assert_eq!(found["files"], 1);
    assert!(found["windows"].as_u64().unwrap() >= 1);
}

#[test]
fn a_comparison_is_that_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let recording = |name: &str, amplitude: f64| {
        let path = folder.path().join(name);
        let rows = (0..4000).map(|i| {
            let t = f64::from(i) / 1000.0;
            format!("{t},{}\n", amplitude * (t * 60.0).sin())
        });
        let rows: String = rows.collect();
        fs::write(&path, format!("t_s,acc_m_s2\n{rows}")).unwrap();
        path
    };
    let (a, b) = (recording("a.csv", 1.0), recording("b.csv", 2.0));
    let out = folder.path().join("compared");
    let output = crosshead(&["compare", "--json", "--speed", "500 rpm"])
        .args([&a, &b])
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    let written: Value =
        serde_json::from_slice(&fs::read(out.join("comparison.json")).unwrap()).unwrap();
    assert_eq!(document(&output), written);
}
