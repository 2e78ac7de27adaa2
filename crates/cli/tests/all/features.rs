//! `crosshead features` on datasets, bundles and files with something wrong.

use crate::check::THROWS;
use recordings::formats::parquet::read_table;
use recordings::{Data, Table};
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> Output {
    let program = match program {
        "gen-dataset" => env!("CARGO_BIN_EXE_gen-dataset"),
        _ => env!("CARGO_BIN_EXE_crosshead"),
    };
    Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The table that `crosshead features` writes.
fn features(folder: &Path, arguments: &[&str]) -> Table {
    let all = [&["features"], arguments, &["--out", "out.parquet"]].concat();
    let output = run(folder, "crosshead", &all);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {message}");
    read_table(&folder.join("out.parquet")).unwrap()
}

fn text(table: &Table, column: &str, row: usize) -> String {
    table.values::<String>(column).unwrap()[row]
        .clone()
        .unwrap_or_default()
}

fn real(table: &Table, column: &str, row: usize) -> Option<f64> {
    table.values::<f64>(column).unwrap()[row]
}

/// No number anywhere is NaN or infinite.
fn all_finite(table: &Table) -> bool {
    table.columns().iter().all(|data| match data {
        Data::Real(values) => values.iter().flatten().all(|x| x.is_finite()),
        _ => true,
    })
}

const SWEEP: &str = "
name: small
machine: MACHINE
run: {revolutions: 4, transient: 2, tolerance: 1e-8}
windows: {count: 2, revolutions: 2}
cases:
  - grid: {joints: [[], [big_end]], clearance: [0.2 mm], speed: [450 rpm, 550 rpm]}
";

#[test]
fn datasets_give_the_features_that_they_have() {
    let folder = tempfile::tempdir().unwrap();
    let machine = project().join("data/machines/single-stage.yaml");
    let sweep = SWEEP.replace("MACHINE", &machine.display().to_string());
    fs::write(folder.path().join("sweep.yaml"), sweep).unwrap();
    for format in ["parquet", "mcap"] {
        let made = ["sweep.yaml", "--out", format, "--format", format];
        assert!(run(folder.path(), "gen-dataset", &made).status.success());
    }
    // In MCAP a case is one recording: its windows are cut again.
    for (input, window) in [("parquet", None), ("mcap", Some("2 revolutions"))] {
        let window = window.map_or(vec![], |w| vec!["--window", w]);
        let machine = machine.display().to_string();
        let geometry = ["--machine", &machine];
        let computed = features(folder.path(), &[&[input], &geometry[..], &window].concat());
        let mut compared = 0;
        for split in ["train", "validation", "test"] {
            let path = format!("{input}/features/{split}-00000-of-00001.parquet");
            let expected = read_table(&folder.path().join(path)).unwrap();
            for row in 0..expected.rows() {
                let id = text(&expected, "case_id", row);
                let window = expected.values::<i64>("window").unwrap()[row];
                let is_row = |&i: &usize| {
                    text(&computed, "case_id", i) == id
                        && computed.values::<i64>("window").unwrap()[i] == window
                };
                let found = (0..computed.rows()).find(is_row).unwrap();
                for column in expected.schema().columns() {
                    if !column.name.contains('.') || column.kind != recordings::Kind::Real {
                        continue;
                    }
                    let [a, b] = [(&computed, found), (&expected, row)]
                        .map(|(table, row)| real(table, &column.name, row));
                    assert_eq!(a, b, "{input}, {id}, {}", column.name);
                    compared += 1;
                }
                for label in ["fault", "split", "group"] {
                    assert_eq!(text(&computed, label, found), text(&expected, label, row));
                }
            }
        }
        assert!(compared > 500, "{compared}");
    }
}

/// With `--like` a recording has the columns of the dataset and windows of its length, or is refused.
#[test]
fn recordings_are_made_like_a_dataset_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let machine = project().join("data/machines/single-stage.yaml");
    let machine = machine.display().to_string();
    let sweep = SWEEP.replace("MACHINE", &machine);
    fs::write(folder.path().join("sweep.yaml"), sweep).unwrap();
    let simulate = |out: &str, options: &[&str]| {
        let all = [&["simulate", &machine, "--out", out][..], options].concat();
        assert!(run(folder.path(), "crosshead", &all).status.success());
    };
    let made = run(folder.path(), "gen-dataset", &["sweep.yaml", "--out", "ds"]);
    assert!(made.status.success());
    simulate("long", &["--revolutions", "7"]);
    simulate("fine", &["--revolutions", "4", "--sample-rate", "20 kHz"]);
    simulate("short", &["--revolutions", "1"]);

    let expected = read_table(
        &folder
            .path()
            .join("ds/features/train-00000-of-00001.parquet"),
    );
    let names = |table: &Table| -> Vec<String> {
        let columns = table.schema().columns().iter();
        let features = columns.filter(|c| c.role == Some(recordings::Role::Feature));
        features.map(|c| c.name.clone()).collect()
    };
    let measured = features(folder.path(), &["long/signals.parquet", "--like", "ds"]);
    assert_eq!(names(&measured), names(&expected.unwrap()));
    // Seven revolutions in windows of two.
    assert_eq!(measured.rows(), 3);
    assert!(real(&measured, "cylinder_pressure.indicated_power_w", 0).is_some());

    for (arguments, message) in [
        (
            &["fine/signals.parquet"][..],
            "sample rate: found 20000 Hz, expected 10000 Hz as in the dataset",
        ),
        (&["short/signals.parquet"], "less than a window"),
        (
            &[
                "long/signals.parquet",
                "--column",
                "crosshead_acceleration_m_s2",
            ],
            "channels: found crosshead_acceleration, expected crosshead_acceleration, cylinder_pressure, \
             frame_acceleration_x as in the dataset",
        ),
        (
            &["long/signals.parquet", "--window", "1 s"],
            "cannot be used with",
        ),
    ] {
        let out = [
            "--like",
            "ds",
            "--speed",
            "500 rpm",
            "--out",
            "refused.parquet",
        ];
        let all = [&["features"], arguments, &out].concat();
        let output = run(folder.path(), "crosshead", &all);
        let found = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {found}");
        assert!(found.contains(message), "{found}");
        assert!(!folder.path().join("refused.parquet").exists());
    }
}

/// Acceleration of a shaft at 600 rpm in m/s^2, sampled at 2 kHz.
fn wave(i: usize) -> f64 {
    let t = i as f64 / 2000.0;
    3.0 * (TAU * 10.0 * t).sin() + 0.5 * (TAU * 310.0 * t).cos()
}

fn csv(heading: &str, samples: usize, row: impl Fn(usize) -> String) -> String {
    let lines: Vec<String> = (0..samples).map(row).collect();
    format!("{heading}\n{}\n", lines.join("\n"))
}

#[test]
fn the_same_bytes_whatever_the_threads() {
    let folder = tempfile::tempdir().unwrap();
    let text = csv("t_s,acc_m_s2", 8000, |i| {
        format!("{},{}", i as f64 / 2000.0, wave(i))
    });
    fs::write(folder.path().join("a.csv"), text).unwrap();
    let arguments = [
        "a.csv",
        "--speed",
        "600 rpm",
        "--window",
        "3 revolutions",
        "--threads",
    ];
    let bytes = ["1", "3"].map(|threads| {
        let table = features(folder.path(), &[&arguments[..], &[threads]].concat());
        assert_eq!(table.rows(), 13);
        fs::read(folder.path().join("out.parquet")).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn units_and_speeds_from_anywhere_give_the_same_features() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    let degrees = |i: usize| (i as f64 / 2000.0 * 3600.0) % 360.0;
    write(
        "a.csv",
        csv("t,acc [m/s^2]", 4000, |i| {
            format!("{},{}", i as f64 / 2e3, wave(i))
        }),
    );
    write(
        "b.csv",
        csv("t [ms];crank_angle_deg;acc_g", 4000, |i| {
            format!("{};{};{}", i as f64 / 2.0, degrees(i), wave(i) / 9.80665)
        }),
    );
    write("c.csv", csv("acc", 4000, |i| format!("{}", wave(i) / 50.0)));
    let cases = [
        vec!["a.csv", "--speed", "600 rpm"],
        vec!["b.csv"],
        vec![
            "c.csv",
            "--unit",
            "50 m/s^2",
            "--sample-rate",
            "2000",
            "--speed",
            "600 rpm",
        ],
    ];
    for arguments in cases {
        let table = features(folder.path(), &arguments);
        let value = |feature: &str| real(&table, &format!("acc.{feature}"), 0).unwrap();
        // Amplitudes of the two sines; 310 Hz is no whole order of 10 Hz above 20.
        assert!((value("order_01_m_s2") - 3.0).abs() < 1e-3, "{arguments:?}");
        let rms = (0.5 * (9.0 + 0.25_f64)).sqrt();
        assert!((value("rms_m_s2") - rms).abs() < 1e-3, "{arguments:?}");
        assert!((real(&table, "speed_rpm", 0).unwrap() - 600.0).abs() < 0.1);
        assert!(
            !text(&table, "missing", 0).contains("speed"),
            "{arguments:?}"
        );
    }
    // Without a speed the orders are missing, and the rest is there.
    let table = features(folder.path(), &["a.csv"]);
    assert_eq!(real(&table, "acc.order_01_m_s2", 0), None);
    assert!(real(&table, "acc.band_0160_0320_m2_s4", 0).unwrap() > 0.12);
    assert!(real(&table, "acc.spectral_entropy", 0).is_some());
    assert!(text(&table, "missing", 0).starts_with("acc.band_1280_2560_m2_s4: the band begins"));
}

const BUNDLE: &str = "
format: clearance recordings 1
machine: {name: test, crank_radius_m: 0.1}
runs:
- id: first
  file: a.csv
  speed_rpm: 600
  load: {suction_pressure_pa: 1.0e5, discharge_pressure_pa: 4.0e5}
  joints: {big_end: {clearance_m: 0.0002}, small_end: ideal}
  sample_rate_hz: 2000.0
  channels:
  - {name: time, column: t_s, unit: s}
  - {name: crosshead acceleration, column: acc, unit: m/s2}
";

#[test]
fn a_bundle_tells_what_its_files_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let text_of = csv("t_s,acc,more", 4000, |i| {
        format!("{},{},7", i as f64 / 2e3, wave(i))
    });
    fs::write(folder.path().join("a.csv"), text_of).unwrap();
    fs::write(folder.path().join("recordings.yaml"), BUNDLE).unwrap();
    let table = features(folder.path(), &["."]);
    assert_eq!(text(&table, "run", 0), "first");
    assert_eq!(real(&table, "speed_rpm", 0), Some(600.0));
    assert_eq!(real(&table, "clearance_big_end_m", 0), Some(0.0002));
    assert_eq!(real(&table, "clearance_small_end_m", 0), Some(0.0));
    assert_eq!(real(&table, "discharge_pressure_pa", 0), Some(4e5));
    assert!((real(&table, "acc.order_01_m_s2", 0).unwrap() - 3.0).abs() < 1e-3);
    assert!(table.schema().position("more.mean").is_err());

    let wrong = BUNDLE.replace("speed_rpm:", "sped_rpm:");
    fs::write(folder.path().join("recordings.yaml"), wrong).unwrap();
    let output = run(
        folder.path(),
        "crosshead",
        &["features", ".", "--out", "o.parquet"],
    );
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        message.contains("recordings.yaml:7:3: runs.0.sped_rpm: unknown key"),
        "{message}"
    );
    assert!(message.contains("did you mean 'speed_rpm'?"), "{message}");
    assert!(!folder.path().join("o.parquet").exists());
}

/// Unit and offset of a channel hold whatever its name says, and a throw of --machine gives the name.
#[test]
fn a_pressure_is_absolute_whatever_throw_its_name_states() {
    let folder = tempfile::tempdir().unwrap();
    let recording = csv("t_s,HE [psig],angle", 4000, |i| {
        let angle = (1.8 * i as f64) % 360.0;
        let pressure = 350.0 + 100.0 * angle.to_radians().cos();
        format!("{},{pressure},{angle}", i as f64 / 2e3)
    });
    fs::write(folder.path().join("a.csv"), recording).unwrap();
    fs::write(folder.path().join("machine.yaml"), THROWS).unwrap();
    let bundle = |name: &str, column: &str, unit: &str| {
        let text = format!(
            "runs:\n- id: first\n  file: a.csv\n  channels:\n  - {{name: {name}, column: '{column}', unit: {unit}, offset: 14.4}}\n  - {{name: crank angle, column: angle, unit: deg}}\n"
        );
        fs::write(folder.path().join("recordings.yaml"), text).unwrap();
    };
    let known = ["--machine", "machine.yaml", "--top-dead-centre", "0 deg"];
    let psi = 6894.757;
    for (name, column, unit, machine) in [
        ("throw2 cylinder pressure", "HE", "psi", true),
        ("throw2 cylinder pressure", "HE", "psig", true),
        ("throw2 cylinder pressure", "HE [psig]", "psig", true),
        ("throw2 cylinder pressure", "HE", "psig", false),
        ("oil pressure", "HE", "psig", true),
        ("oil pressure", "HE", "psi", false),
    ] {
        bundle(name, column, unit);
        let arguments = [&["."][..], if machine { &known[..] } else { &[] }].concat();
        let table = features(folder.path(), &arguments);
        let mean = real(&table, "HE.mean_pa", 0).unwrap();
        let expected = 364.4 * psi;
        assert!(
            (mean / expected - 1.0).abs() < 1e-3,
            "{name} {column} {unit}: {mean}"
        );
        let power = table.schema().position("HE.indicated_power_w").ok();
        let power = power.and_then(|_| real(&table, "HE.indicated_power_w", 0));
        assert_eq!(
            power.is_some(),
            name.starts_with("throw2") && machine,
            "{name} {column} {unit}"
        );
    }
    for name in ["throw9 cylinder pressure", "cylinder pressure"] {
        bundle(name, "HE", "psi");
        let all = [&["features", "."], &known[..], &["--out", "o.csv"]].concat();
        let output = run(folder.path(), "crosshead", &all);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(
            message.contains("recordings.yaml:5:12: runs.0.channels.0.name: found "),
            "{message}"
        );
        assert!(message.contains("one of throw1, throw2"), "{message}");
    }
}

#[test]
fn what_is_wrong_with_a_signal_stands_beside_its_features() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("constant.csv", csv("acc_m_s2", 500, |_| "2.5".into()));
    write(
        "holes.csv",
        csv("acc_m_s2", 500, |i| {
            if i == 77 {
                "".into()
            } else {
                wave(i).to_string()
            }
        }),
    );
    write(
        "infinite.csv",
        csv("acc_m_s2", 500, |i| {
            if i == 5 {
                "inf".into()
            } else {
                wave(i).to_string()
            }
        }),
    );
    write(
        "clipped.csv",
        csv("acc_m_s2", 500, |i| wave(i).clamp(-1.5, 1.5).to_string()),
    );
    write("short.csv", csv("acc_m_s2", 57, |i| wave(i).to_string()));
    write(
        "huge.csv",
        csv("acc_m_s2", 500, |i| format!("{}e37", 3.0 * wave(i))),
    );
    let gap = |i: usize| i as f64 / 2000.0 + if i < 200 { 0.0 } else { 1.0 };
    write(
        "gap.csv",
        csv("t,acc_m_s2", 500, |i| format!("{:.4},{}", gap(i), wave(i))),
    );
    for (name, column, expected) in [
        (
            "constant.csv",
            "missing",
            "acc.skewness: the signal is constant",
        ),
        (
            "holes.csv",
            "warnings",
            "acc: 1 missing sample bridged by a line",
        ),
        (
            "infinite.csv",
            "warnings",
            "acc: 1 missing sample bridged by a line",
        ),
        ("clipped.csv", "warnings", "acc: may be clipped"),
        (
            "short.csv",
            "missing",
            "acc: 57 samples, but at least 100 are needed",
        ),
        (
            "gap.csv",
            "warnings",
            "1.000000 s are missing before the window",
        ),
        ("huge.csv", "missing", ""),
    ] {
        let rate = ["--sample-rate", "2 kHz"];
        let table = features(
            folder.path(),
            &[&[name], &rate[..], &["--speed", "600 rpm"]].concat(),
        );
        let last = table.rows() - 1;
        let found = text(&table, column, last);
        assert!(found.contains(expected), "{name}: {found}");
        assert!(all_finite(&table), "{name}");
    }
}
