//! What a user looks at first: the same numbers from `simulate` and from the recording by `features`.

use crate::one_run::{crosshead, machine, said};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn run(arguments: &[&str]) -> String {
    let output = crosshead(arguments);
    assert!(output.status.success(), "{}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The only row of a table of features.
fn row(path: &Path) -> BTreeMap<String, String> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').map(str::to_owned);
    // No text of this row has a comma in it before the features.
    names
        .zip(lines.next().unwrap().split(',').map(str::to_owned))
        .collect()
}

#[test]
fn a_run_and_its_recording_agree_on_power_and_vibration() {
    let folder = tempfile::tempdir().unwrap();
    let [out, table] = ["run", "features.csv"].map(|name| folder.path().join(name));
    let machine = machine();
    let machine = machine.to_str().unwrap();
    let told = run(&[
        "simulate",
        machine,
        "--revolutions",
        "6",
        "--transient",
        "2",
        "--out",
        out.to_str().unwrap(),
    ]);
    for words in ["indicated power", "rod load", "API 618", "mm/s rms"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    for figure in ["pv-card.svg", "rod-load.svg", "waveform.svg"] {
        let svg = fs::read_to_string(out.join(figure)).unwrap();
        assert!(svg.starts_with("<svg"), "{figure}");
    }
    let text = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let signals = out.join("signals.parquet");
    run(&[
        "features",
        signals.to_str().unwrap(),
        "--machine",
        machine,
        "--out",
        table.to_str().unwrap(),
    ]);
    let row = row(&table);
    let agrees = |found: &Value, column: &str, within: f64| {
        let found = found.as_f64().unwrap();
        let expected: f64 = row[column].parse().unwrap();
        assert!(
            (found / expected - 1.0).abs() < within,
            "{column}: {found}, {expected}"
        );
    };
    // Noise of 1 kPa and a converter stand between the chamber and the recording.
    let chamber = &summary["chambers"][0];
    agrees(
        &chamber["indicated_power_w"],
        "cylinder_pressure.indicated_power_w",
        5e-3,
    );
    let mean = "cylinder_pressure.indicated_mean_pressure_pa";
    agrees(&chamber["indicated_mean_pressure_pa"], mean, 5e-3);
    let vibration = &summary["vibration"][0];
    assert_eq!(vibration["channel"], "crosshead_acceleration_m_s2");
    let velocity = "crosshead_acceleration.velocity_rms_m_s";
    agrees(&vibration["velocity_rms_m_s"], velocity, 1e-4);
    let displacement = "crosshead_acceleration.displacement_rms_m";
    agrees(&vibration["displacement_rms_m"], displacement, 1e-4);
    // Without the machine there is no power, and the reason is told.
    run(&[
        "features",
        signals.to_str().unwrap(),
        "--out",
        table.to_str().unwrap(),
    ]);
    let without = crosshead(&[
        "features",
        signals.to_str().unwrap(),
        "--out",
        table.to_str().unwrap(),
    ]);
    let told = String::from_utf8(without.stdout).unwrap();
    assert!(
        told.contains("--machine gives bore, stroke and rod"),
        "{told}"
    );
}

#[test]
fn a_run_of_a_machine_of_two_stages_has_a_card_for_each_chamber() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/two-stage.yaml");
    run(&[
        "simulate",
        machine.to_str().unwrap(),
        "--revolutions",
        "2",
        "--transient",
        "1",
        "--out",
        out.to_str().unwrap(),
        "--format",
        "csv",
    ]);
    let text = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let throws = summary["rod_load"].as_array().unwrap();
    assert_eq!(throws.len(), 2);
    let chambers = summary["chambers"].as_array().unwrap();
    assert!(
        chambers
            .iter()
            .all(|c| c["indicated_power_w"].as_f64().unwrap() > 0.0)
    );
    assert!(chambers.len() >= 2);
}
