//! A bundle of a part of one recorded run, and calibrations of it.

use ::calibrate::{Settings, Task, task};
use input::calibration::Calibration;
use recordings::measured::{MeasuredFile, Options};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The example whose run is used, and that run's length: 12 revolutions at 650 rpm.
pub const EXAMPLE: &str = "../../data/recordings/example-single-stage";
pub const RUN: &str = "run03";
pub const SAMPLES: usize = 22_154;

pub fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE)
}

/// Time, crank angle, acceleration and pressure of the run, in SI units.
pub fn recorded() -> [Vec<f64>; 4] {
    recorded_in(RUN)
}

pub fn recorded_in(run: &str) -> [Vec<f64>; 4] {
    let path = example().join(format!("{run}.parquet"));
    let mut file = MeasuredFile::open(&path, &Options::default()).unwrap();
    let names: Vec<String> = file.channels().iter().map(|c| c.column.clone()).collect();
    let mut samples = vec![Vec::new(); names.len()];
    let mut recording = file.next().unwrap().unwrap();
    while samples[0].len() < SAMPLES {
        let most = SAMPLES - samples[0].len();
        recording.read(most, &mut samples).unwrap();
    }
    let of = |column: &str| {
        let place = names.iter().position(|name| name == column).unwrap();
        samples[place].clone()
    };
    let time = (0..SAMPLES).map(|i| i as f64 / 20_000.0).collect();
    let [angle, acceleration, pressure] = [
        "crank_angle_rad",
        "crosshead_acceleration_m_s2",
        "cylinder_pressure_pa",
    ]
    .map(of);
    [time, angle, acceleration, pressure]
}

/// A column of a recording: its heading, its entry in the list of channels, and the samples.
pub type Column = (&'static str, &'static str, Vec<f64>);

pub const TIME: &str = "{name: time, column: t_s, unit: s}";
pub const ANGLE: &str = "{name: crank angle, column: crank_angle_rad, unit: rad}";
pub const ACCELERATION: &str =
    "{name: crosshead acceleration, column: crosshead_acceleration_m_s2, unit: m/s2}";
pub const PRESSURE: &str = "{name: cylinder pressure, column: cylinder_pressure_pa, unit: Pa}";

/// The columns as the example has them.
pub fn plain() -> Vec<Column> {
    columns(recorded())
}

pub fn columns([time, angle, acceleration, pressure]: [Vec<f64>; 4]) -> Vec<Column> {
    vec![
        ("t_s", TIME, time),
        ("crank_angle_rad", ANGLE, angle),
        ("crosshead_acceleration_m_s2", ACCELERATION, acceleration),
        ("cylinder_pressure_pa", PRESSURE, pressure),
    ]
}

/// recordings.yaml of one run with these columns.
pub fn yaml(columns: &[Column]) -> String {
    let text = fs::read_to_string(example().join("recordings.yaml")).unwrap();
    let machine = text.split("runs:").next().unwrap();
    let channels: String = columns
        .iter()
        .map(|(_, entry, _)| format!("  - {entry}\n"))
        .collect();
    format!(
        "{machine}runs:\n- id: run03\n  file: run03.csv\n  speed_rpm: 650\n  load:\n    \
         suction_pressure_pa: 105000.0\n    discharge_pressure_pa: 393000.0\n  joints:\n    \
         big_end:\n      clearance_m: 0.0001\n    small_end:\n      clearance_m: 0.0001\n  \
         sample_rate_hz: 20000\n  channels:\n{channels}"
    )
}

pub fn csv(columns: &[Column]) -> String {
    let headings: Vec<&str> = columns.iter().map(|(heading, ..)| *heading).collect();
    let mut text = headings.join(",") + "\n";
    for i in 0..columns[0].2.len() {
        let cells: Vec<String> = columns.iter().map(|(.., x)| x[i].to_string()).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

/// A bundle `bundle` in a folder of its own.
pub fn write(yaml: &str, csv: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let bundle = folder.path().join("bundle");
    fs::create_dir(&bundle).unwrap();
    fs::write(bundle.join("recordings.yaml"), yaml).unwrap();
    fs::write(bundle.join("run03.csv"), csv).unwrap();
    folder
}

pub fn written(columns: &[Column]) -> TempDir {
    write(&yaml(columns), &csv(columns))
}

/// The exit status and the message of `crosshead calibrate`.
pub fn calibrate(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let program = Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .current_dir(folder)
        .arg("calibrate")
        .args(arguments)
        .output()
        .unwrap();
    let message = String::from_utf8(program.stderr).unwrap();
    (program.status.code().unwrap(), message)
}

/// The task of a settings file's text, beside the bundle.
pub fn task_of(folder: &Path, text: &str) -> Task {
    let calibration = settings_of(folder, text);
    let settings = Settings {
        machine: None,
        calibration: &calibration,
        base: folder,
        allow_outside: false,
        clearances_unknown: false,
        locate: &|error| error,
    };
    task(&settings)
        .map_err(|failure| format!("{failure:?}"))
        .unwrap()
}

pub fn settings_of(folder: &Path, text: &str) -> Calibration {
    let path = folder.join("calibration.yaml");
    fs::write(&path, text).unwrap();
    Calibration::read(&path).unwrap().0
}
