//! `crosshead explain-gap` on measured pressures: one revolution at each end of a real compressor's
//! cylinder, recorded on different days, whose source says when the suction valves close.
#![allow(clippy::print_stderr)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

const BUNDLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../data/recordings/recip-compressor-pressure"
);
/// What the best fit of ideal valves leaves, exponents anywhere from 1 to 5/3, by a search of Nelder
/// and Mead's over the closed form (calibrate/tests/all/real_pressure.rs): head end and crank end, Pa.
const IDEAL: [f64; 2] = [153.8e3, 129.5e3];

fn crosshead(arguments: &[&str]) {
    let program = env!("CARGO_BIN_EXE_crosshead");
    let told = Command::new(program).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(told.status.success(), "{arguments:?}: {said}");
}

fn results(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Root mean square over both ends, Pa.
fn of_both(rms: [f64; 2]) -> f64 {
    ((rms[0] * rms[0] + rms[1] * rms[1]) / 2.0).sqrt()
}

#[test]
#[ignore = "minutes: tests/nightly/run pressures"]
fn late_suction_valves_are_found_and_most_of_the_gap_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("explained");
    crosshead(&["explain-gap", BUNDLE, "--out", out.to_str().unwrap()]);
    let gap = results(&out.join("gap.json"));
    let runs = ["head_end", "crank_end"];
    let ideal = of_both(IDEAL);

    // What ideal valves leave is within a few percent of the least that they can.
    let of_runs = |key: &str| runs.map(|run| number(&gap["runs"][run]["pressure_rms_pa"][key]));
    let before = of_both(of_runs("before"));
    assert!((1.0..1.1).contains(&(before / ideal)), "{before}");

    // The valves of both ends are named, and leave at most a third.
    let effects = gap["effects"].as_array().unwrap();
    let closes = [("head", 180.0, 250.0, 255.0), ("crank", 0.0, 62.0, 62.0)];
    for (effect, (end, dead, low, high)) in effects.iter().zip(closes) {
        assert_eq!(effect["effect"], "suction_unloading", "{effect}");
        assert_eq!(effect["end"], end, "{effect}");
        let held = number(&effect["parameters"]["held"]["value"]);
        let angle = dead + held.to_degrees();
        assert!((low - 5.0..high + 5.0).contains(&angle), "{end} at {angle}");
        assert!(effect["sentence"].as_str().unwrap().contains("closes late"));
    }
    let after = of_runs("after");
    eprintln!("{:.0?} to {after:.0?} Pa", of_runs("before"));
    assert!(of_both(after) < ideal / 3.0, "{after:?}");
    assert_eq!(gap["verdict"], "partly-explained");

    // What the curve leaves open is said and has no interval, and that no run was held out is said.
    for open in ["cylinder.crank_end.clearance", "cylinder.exponent"] {
        assert_eq!(gap["parameters"][open]["identifiable"], false, "{open}");
    }
    let notes = gap["notes"].to_string();
    let columns = ["cylinder_pressure_pa", "cylinder_pressure_crank_end_pa"];
    for (run, column) in runs.into_iter().zip(columns) {
        let open = format!(
            "{run}, {column}: this curve does not determine both clearance volume and polytropic exponents"
        );
        assert!(notes.contains(&open), "{notes}");
    }
    assert!(notes.contains("No run was held out"), "{notes}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("closes late") && page.contains("kPa"));
}

/// One end explained by itself predicts the other, of which only clearance volume and closing angle
/// are fitted; the pressures of its lines are those that the bundle states.
#[test]
#[ignore = "minutes: tests/nightly/run pressures"]
fn one_end_predicts_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let ends = [
        ("crank_end", "head_end", "cylinder.head_clearance", IDEAL[0]),
        (
            "head_end",
            "crank_end",
            "cylinder.crank_end.clearance",
            IDEAL[1],
        ),
    ];
    for (fitted, predicted, clearance, ideal) in ends {
        let explained = folder.path().join(fitted);
        let out = folder.path().join(format!("{fitted}-{predicted}"));
        let path = |path: &Path| path.to_str().unwrap().to_owned();
        crosshead(&[
            "explain-gap",
            BUNDLE,
            "--leave-out",
            predicted,
            "--out",
            &path(&explained),
        ]);
        crosshead(&[
            "calibrate",
            BUNDLE,
            "--machine",
            &path(&explained.join("machine.yaml")),
            "--leave-out",
            fitted,
            "--parameter",
            clearance,
            "--parameter",
            "effects.suction_unloading.held",
            "--out",
            &path(&out),
        ]);
        let gas = &results(&out.join("calibration.json"))["gas"][predicted];
        let channel = gas.as_object().unwrap().values().next().unwrap();
        let rms = number(&channel["rms_pa"]["calibrated"]);
        eprintln!("{predicted} from {fitted}: {rms:.0} Pa");
        assert!(rms < ideal / 3.0, "{predicted} from {fitted}: {rms}");
    }
}
