//! A run in several files is the run in one.

use crate::small_sweep::{crosshead, text};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Output;

const RATE: f64 = 10_000.0;

/// Rows of a table of these columns from sample `from` on, of a run at 500 rpm.
fn table(columns: &[&str], from: usize, count: usize) -> String {
    let mut rows = columns.join(",") + "\n";
    for i in from..from + count {
        let time = i as f64 / RATE;
        let angle = (500.0 / 60.0 * TAU * time).rem_euclid(TAU);
        let cells = columns.iter().map(|column| match *column {
            "t_s" => format!("{time:.4}"),
            "crank_angle_rad" => format!("{angle:.5}"),
            "acc" => format!("{:.4}", 30.0 * angle.cos()),
            _ => format!("{:.1}", 2.5e5 + 1.4e5 * (angle + 0.4).sin()),
        });
        writeln!(rows, "{}", cells.collect::<Vec<_>>().join(",")).unwrap();
    }
    rows
}

/// A bundle whose run has these lines, and what replays it.
fn replay(folder: &Path, lines: &str) -> Output {
    let list = format!(
        "format: clearance recordings 1\nruns:\n  - id: run01\n    speed_rpm: 500\n\
         \x20   load: {{suction_pressure_pa: 105000, discharge_pressure_pa: 393000}}\n{lines}"
    );
    fs::write(folder.join("recordings.yaml"), list).unwrap();
    let machine =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    crosshead(&["replay"])
        .arg(folder)
        .arg("--machine")
        .arg(machine)
        .arg("--out")
        .arg(folder.join("replayed"))
        .output()
        .unwrap()
}

const ONE: &str = "    file: all.csv
    channels:
      - {name: crank angle, column: crank_angle_rad, unit: rad}
      - {name: crosshead acceleration, column: acc, unit: m/s2}
      - {name: cylinder pressure, column: p, unit: Pa}
";

const TWO: &str = "    files: [acceleration.csv, pressure.csv]
    channels:
      - {name: crank angle, column: crank_angle_rad, unit: rad, file: acceleration.csv}
      - {name: crosshead acceleration, column: acc, unit: m/s2, file: acceleration.csv}
      - {name: cylinder pressure, column: p, unit: Pa, file: pressure.csv}
";

#[test]
fn two_files_of_a_run_are_aligned_by_their_times() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let all = table(&["t_s", "crank_angle_rad", "acc", "p"], 1500, 10_000);
    fs::write(one.path().join("all.csv"), all).unwrap();
    // The pressure begins 0.15 s after the acceleration and goes on for longer.
    let acceleration = table(&["t_s", "crank_angle_rad", "acc"], 0, 11_500);
    fs::write(two.path().join("acceleration.csv"), acceleration).unwrap();
    fs::write(
        two.path().join("pressure.csv"),
        table(&["t_s", "p"], 1500, 12_000),
    )
    .unwrap();
    let outputs = [replay(one.path(), ONE), replay(two.path(), TWO)];
    for output in &outputs {
        assert!(output.status.success(), "{output:?}");
    }
    let run = |folder: &Path| fs::read(folder.join("replayed/run01.parquet")).unwrap();
    assert!(run(one.path()) == run(two.path()));
}

#[test]
fn files_that_cannot_be_aligned_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let acceleration = table(&["t_s", "crank_angle_rad", "acc"], 0, 5000);
    fs::write(folder.path().join("acceleration.csv"), acceleration).unwrap();
    fs::write(
        folder.path().join("pressure.csv"),
        table(&["t_s", "p"], 90_000, 5000),
    )
    .unwrap();
    let output = replay(folder.path(), TWO);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = text(&output.stderr);
    assert!(said.contains("have no time in common"), "{said}");
    let output = replay(folder.path(), &TWO.replace(", file: pressure.csv", ""));
    let said = text(&output.stderr);
    let expected = "runs.0.channels.2.file: missing; expected the file that has it, one of acceleration.csv, pressure.csv";
    assert!(said.contains(expected), "{said}");
    let output = replay(
        folder.path(),
        &TWO.replace("files: [", "file: a.csv\n    files: ["),
    );
    assert!(text(&output.stderr).contains("expected it or file, not both"));
}
