//! `crosshead features`: where the crank stands, samples that are missing, and what is written.

use recordings::Table;
use recordings::formats::parquet::read_table;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Samples per second and per revolution: 600 rpm.
const RATE: f64 = 2000.0;
const TURN: usize = 200;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crosshead"))
        .arg("features")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The table that is written, what is printed, and what is said beside it.
fn features(folder: &Path, arguments: &[&str]) -> (Table, String, String) {
    let output = run(folder, &[arguments, &["--out", "out.parquet"]].concat());
    let [printed, told] =
        [&output.stdout, &output.stderr].map(|t| String::from_utf8_lossy(t).into());
    assert!(output.status.success(), "{arguments:?}: {told}");
    let table = read_table(&folder.join("out.parquet")).unwrap();
    (table, printed, told)
}

fn real(table: &Table, column: &str) -> Option<f64> {
    table.values::<f64>(column).unwrap()[0]
}

fn text(table: &Table, column: &str) -> String {
    let values = table.values::<String>(column).unwrap();
    values[0].clone().unwrap_or_default()
}

/// Crank angle of a sample, degrees: 0 at sample 0.
fn degrees(i: usize) -> f64 {
    360.0 * (i % TURN) as f64 / TURN as f64
}

/// A slow wave, and a knock 45 degrees after top dead centre, in the second of the twelve sectors.
fn knocking(i: usize) -> f64 {
    let angle = degrees(i).to_radians();
    2.0 * angle.cos() + 20.0 * (-200.0 * (1.0 - (angle - TAU / 8.0).cos())).exp()
}

/// A recording of `samples` samples: acceleration in g, encoder in degrees that reads 30 at top dead
/// centre, and a tacho whose pulse begins 60 degrees before that.
fn write(folder: &Path, name: &str, samples: usize, cell: impl Fn(usize, f64) -> String) {
    let line = |i: usize| {
        let pulse = 4.0 * f64::from(u8::from((300.0..320.0).contains(&degrees(i))));
        let encoder = (degrees(i) + 30.0) % 360.0;
        let acc = cell(i, knocking(i) / 9.80665);
        format!("{},{acc},{encoder},{pulse}", i as f64 / RATE)
    };
    let lines: Vec<String> = (0..samples).map(line).collect();
    let text = format!("t_s,ch1,enc,tach\n{}\n", lines.join("\n"));
    fs::write(folder.join(name), text).unwrap();
}

fn whole(_: usize, x: f64) -> String {
    x.to_string()
}

const BUNDLE: &str = "
format: clearance recordings 1
runs:
- id: first
  file: a.csv
  channels:
  - {name: time, column: t_s, unit: s}
  - {name: crosshead acceleration, column: ch1, unit: g}
  - {name: crank angle, column: enc, unit: deg, offset: -30}
";

#[test]
fn recordings_yaml_says_what_the_channels_are() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "a.csv", 4000, whole);
    let tacho = "{name: tacho, column: tach, unit: V, crank_angle_rad: 5.235987755982989}";
    let by_tacho = BUNDLE.replace(
        "{name: crank angle, column: enc, unit: deg, offset: -30}",
        tacho,
    );
    for (bundle, path) in [
        (BUNDLE, "."),
        (BUNDLE, "recordings.yaml"),
        (BUNDLE, "a.csv"),
        (by_tacho.as_str(), "."),
        (by_tacho.as_str(), "a.csv"),
    ] {
        fs::write(folder.join("recordings.yaml"), bundle).unwrap();
        let (table, ..) = features(folder, &[path]);
        let missing = text(&table, "missing");
        let speed = real(&table, "speed_rpm").unwrap();
        assert!((speed - 600.0).abs() < 0.1, "{path}: {speed}");
        assert_eq!(text(&table, "run"), "first");
        let order = real(&table, "ch1.order_01_m_s2").unwrap();
        assert!(order > 1.0, "{path}: {order} {missing}");
        let sector = |k: usize| real(&table, &format!("ch1.sector_{k:02}_rms_m_s2")).unwrap();
        assert!(
            (1..=12).all(|k| k == 2 || sector(k) < 0.5 * sector(2)),
            "{path}"
        );
        assert!(table.schema().position("tach.mean").is_err());
    }
    // A unit that cannot be one of the channel's is told with its line.
    let wrong = BUNDLE.replace("unit: deg", "unit: bar");
    fs::write(folder.join("recordings.yaml"), wrong).unwrap();
    let output = run(folder, &["a.csv", "--out", "o.parquet"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("recordings.yaml:9:"), "{message}");
}

#[test]
fn arguments_say_where_the_crank_stands() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "a.csv", 4000, whole);
    let unit = ["a.csv", "--unit", "g", "--column", "ch1"];
    let of = |more: &[&str]| features(folder, &[&unit, more].concat());
    let (_, printed, _) = of(&[]);
    let speed = "the speed is not known: --speed, --tacho or --crank-angle gives it";
    assert!(printed.contains(speed), "{printed}");
    let (_, printed, _) = of(&["--speed", "600 rpm"]);
    let top = "   12  top dead centre is not known: --top-dead-centre gives it";
    assert!(printed.contains(top), "{printed}");
    for reference in [["--tacho", "tach"], ["--crank-angle", "enc [deg]"]] {
        let (table, printed, _) = of(&reference);
        assert!((real(&table, "speed_rpm").unwrap() - 600.0).abs() < 0.1);
        assert_eq!(real(&table, "ch1.sector_02_rms_m_s2"), None);
        assert!(printed.contains(top), "{printed}");
        let zero = if reference[0] == "--tacho" {
            "60 deg"
        } else {
            "30 deg"
        };
        let (table, printed, _) = of(&[&reference[..], &["--top-dead-centre", zero]].concat());
        let sector = |k: usize| real(&table, &format!("ch1.sector_{k:02}_rms_m_s2")).unwrap();
        assert!((1..=12).all(|k| k == 2 || sector(k) < 0.5 * sector(2)));
        assert!(!printed.contains("top dead centre"), "{printed}");
    }
    for (arguments, expected) in [
        (["--tacho", "tch"], "no column `tch`"),
        (["--crank-angle", "enc"], "--crank-angle 'enc [deg]'"),
        (
            ["--top-dead-centre", "30"],
            "--top-dead-centre: found '30' (no unit)",
        ),
    ] {
        let output = run(
            folder,
            &[&["a.csv", "--out", "o.csv"], &arguments[..]].concat(),
        );
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_reversed_encoder_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let lines: Vec<String> = (0..4000)
        .map(|i| format!("{},{},{}", i as f64 / RATE, knocking(i), 359.9 - degrees(i)))
        .collect();
    let content = format!("t_s,acc_m_s2,crank_angle_deg\n{}\n", lines.join("\n"));
    fs::write(folder.join("a.csv"), content).unwrap();
    let (table, _, told) = features(folder, &["a.csv"]);
    let expected = "the crank angle runs backwards, first at sample 1 (0.000500 s after the window \
                    begins): is the encoder reversed?";
    assert!(told.contains(expected), "{told}");
    assert!(text(&table, "warnings").contains(expected));
}

#[test]
fn short_gaps_are_bridged_and_long_ones_split() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let blank = |gap: std::ops::Range<usize>| {
        move |i: usize, x: f64| {
            if gap.contains(&i) {
                String::new()
            } else {
                x.to_string()
            }
        }
    };
    let tacho = ["--unit", "g", "--column", "ch1", "--tacho", "tach"];
    write(folder, "short.csv", 4000, blank(1000..1003));
    let (table, printed, told) = features(folder, &[&["short.csv"], &tacho[..]].concat());
    assert_eq!(table.rows(), 1);
    assert!(real(&table, "ch1.order_01_m_s2").is_some());
    let bridged = "ch1: 3 missing samples bridged by a line";
    assert_eq!(text(&table, "warnings"), bridged);
    assert!(told.contains(bridged), "{told}");
    assert!(printed.contains("1 window, "), "{printed}");
    assert!(printed.contains("3 missing samples bridged by lines (gaps of up to 4)"));

    write(folder, "long.csv", 4000, blank(1000..1100));
    let (table, ..) = features(folder, &[&["long.csv"], &tacho[..]].concat());
    let starts = table.values::<f64>("start_s").unwrap();
    assert_eq!(starts, [Some(0.0), Some(0.55)]);
    let durations = table.values::<f64>("duration_s").unwrap();
    assert_eq!(durations, [Some(0.5), Some(1.45)]);
    let warnings = table.values::<String>("warnings").unwrap();
    let gap = "0.050000 s are missing before the window";
    assert_eq!(warnings[1].as_deref(), Some(gap));
    for value in table.values::<f64>("ch1.order_01_m_s2").unwrap() {
        assert!(value.is_some());
    }

    // A channel that is never there does not take the others with it.
    write(folder, "never.csv", 4000, blank(0..4000));
    let (table, ..) = features(folder, &["never.csv", "--speed", "600 rpm"]);
    assert_eq!(table.rows(), 1);
    assert!(real(&table, "tach.mean").is_some());
}

#[test]
fn the_ending_says_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "a.csv", 400, whole);
    assert!(run(folder, &["a.csv", "--out", "f.csv"]).status.success());
    let written = fs::read_to_string(folder.join("f.csv")).unwrap();
    let heading = "file,window,start_s,duration_s,sample_rate_hz,speed_rpm,ch1.mean,";
    assert!(written.starts_with(heading), "{written}");
    assert_eq!(written.lines().count(), 2);
    for (out, expected) in [
        (".", "--out: . is a folder, expected a file"),
        (
            "f.parquet/",
            "--out: f.parquet/ is a folder, expected a file",
        ),
        (
            "x.xlsx",
            "--out: found x.xlsx, expected a name that ends in .parquet or .csv",
        ),
        ("x", "expected a name that ends in .parquet or .csv"),
    ] {
        let output = run(folder, &["a.csv", "--out", out]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{out}");
        assert!(message.contains(expected), "{message}");
    }
}
