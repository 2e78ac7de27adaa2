//! A bundle of one run that is simulated here, with its sensors' noise.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn crosshead(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_crosshead");
    Command::new(program).args(arguments).output().unwrap()
}

pub fn machine() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml")
}

/// A bundle of one run, without a machine section.
pub fn bundle(folder: &Path) {
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
        "--tolerance",
        "1e-8",
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

pub fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
