//! `crosshead calibrate`, on a part of a recorded run: how recordings are read, refused, aligned,
//! and what becomes of a calibration that is stopped.
#![allow(clippy::print_stdout)]

mod ends;
mod example_run;
mod input;
mod recorder;

use ::calibrate::{Calibrated, Existing, Settings, Task, bundle, prepare};
use ::input::bundle::Bundle;
use cli::calibrate::finish;
use example_run::*;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;

/// A calibration into `out`, stopped at its first step or not.
fn into_folder(
    settings: &Settings,
    out: &Path,
    existing: Existing,
    stop: bool,
) -> Result<Calibrated, String> {
    let prepared = prepare(settings, out, existing).map_err(|error| error.to_string())?;
    finish(prepared, &AtomicBool::new(stop)).map_err(|failure| format!("{failure:?}"))
}

#[test]
fn names_units_and_angles_of_any_kind_are_read_alike() {
    const GRAVITY: f64 = 9.80665;
    let [time, angle, acceleration, pressure] = recorded();
    let mut turns = 0.0;
    let mut before = 0.0;
    let cumulative = angle.iter().map(|angle| {
        if *angle < before - 3.0 {
            turns += 360.0;
        }
        before = *angle;
        turns + angle.to_degrees()
    });
    let odd = vec![
        (
            "T [ms]",
            "{name: time, column: 'T [ms]', unit: ms}",
            scaled(&time, 1e3),
        ),
        (
            "enc",
            "{name: Crank angle, column: enc, unit: deg}",
            cumulative.collect(),
        ),
        (
            "oil",
            "{name: oil pressure, column: oil, unit: bar}",
            scaled(&time, 0.0),
        ),
        (
            "ch 7",
            "{name: crosshead acceleration, column: ch 7, unit: g}",
            scaled(&acceleration, 1.0 / GRAVITY),
        ),
        (
            "p",
            "{name: cylinder pressure, column: p, unit: barg, offset: 1.01325}",
            pressure.iter().map(|p| p / 1e5 - 1.01325).collect(),
        ),
    ];
    let read = |folder: &TempDir| {
        let bundle = Bundle::read(&folder.path().join("bundle")).unwrap();
        let tree = bundle::machine(&bundle, None).unwrap();
        bundle::runs(&bundle, &tree, &[]).unwrap().remove(0)
    };
    let a = read(&written(&plain()));
    let b = read(&written(&odd));
    assert_eq!(a.channels.len(), 2);
    for (a, b) in a.channels.iter().zip(&b.channels) {
        assert_eq!(a.column, b.column);
        let scale = a.samples.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
        let apart = a.samples.iter().zip(&b.samples).map(|(a, b)| (a - b).abs());
        // Both are float32 on the way.
        assert!(apart.fold(0.0, f64::max) < 3e-7 * scale, "{}", a.column);
    }
    let apart = |a: &f64, b: &f64| (a - b + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    let angles = a
        .crank_angle
        .iter()
        .flatten()
        .zip(b.crank_angle.iter().flatten());
    // The cumulative angle of 12 revolutions is a float32 too.
    assert!(angles.map(|(a, b)| apart(a, b).abs()).fold(0.0, f64::max) < 1e-5);
    assert_eq!(a.settings, b.settings);
}

fn scaled(samples: &[f64], factor: f64) -> Vec<f64> {
    samples.iter().map(|x| x * factor).collect()
}

/// RMS difference of a task's crank angle from the recorded one, rad, leaving out the ends.
fn angle_error(task: &Task) -> f64 {
    let [_, recorded, ..] = recorded();
    let found = task.runs[0].crank_angle.as_ref().unwrap();
    let apart = found.iter().zip(&recorded).map(|(a, b)| {
        let apart = a - b;
        apart - TAU * (apart / TAU).round()
    });
    (apart.map(|x| x * x).sum::<f64>() / recorded.len() as f64).sqrt()
}

#[test]
fn a_missing_crank_angle_is_found_in_the_recording() {
    let without: Vec<Column> = plain()
        .into_iter()
        .filter(|c| c.0 != "crank_angle_rad")
        .collect();
    // The stated speed is 1 % off.
    let yaml = yaml(&without).replace("speed_rpm: 650", "speed_rpm: 643.5");
    let folder = write(&yaml, &csv(&without));
    let error = angle_error(&task_of(folder.path(), "bundle: bundle\n"));
    println!("from the waveform alone: {error:.2e} rad");
    assert!(error < 5e-3, "{error}");

    let [time, angle, acceleration, _] = recorded();
    // The pulse of a tacho, whose place on the shaft is not known.
    let pulse = angle
        .iter()
        .map(|a| f64::from((1.0..1.1).contains(a)) * 5.0)
        .collect();
    let tacho = vec![
        ("t_s", TIME, time),
        ("trigger", "{name: tacho, column: trigger, unit: V}", pulse),
        ("crosshead_acceleration_m_s2", ACCELERATION, acceleration),
    ];
    let folder = written(&tacho);
    let error = angle_error(&task_of(folder.path(), "bundle: bundle\n"));
    println!("from a tacho: {error:.2e} rad");
    assert!(error < 5e-3, "{error}");
    // The same with its place told.
    let told = "unit: V, crank_angle_rad: 1.0}";
    let yaml = self::yaml(&tacho).replace("unit: V}", told);
    let folder = write(&yaml, &csv(&tacho));
    let error = angle_error(&task_of(folder.path(), "bundle: bundle\n"));
    assert!(error < 5e-3, "{error}");
}

#[test]
fn wrong_bundles_are_told_before_anything_is_done() {
    let columns = plain();
    let (yaml, csv) = (yaml(&columns), csv(&columns));
    let changed = |column: usize, change: &dyn Fn(usize, f64) -> f64| {
        let mut columns = columns.clone();
        let samples = columns[column].2.iter().enumerate();
        columns[column].2 = samples.map(|(i, x)| change(i, *x)).collect();
        self::csv(&columns)
    };
    let says = |yaml: &str, csv: &str, expected: &str| {
        let folder = write(yaml, csv);
        let (status, message) = calibrate(folder.path(), &["bundle", "--out", "out"]);
        assert_eq!(status, 2, "{expected}: {message}");
        assert!(
            message.contains(expected),
            "{message}\n  is not\n{expected}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(!folder.path().join("out").exists(), "{expected}");
    };
    let yaml_says = |from: &str, to: &str, expected: &str| {
        assert!(yaml.contains(from), "{from}");
        says(&yaml.replace(from, to), &csv, expected);
    };
    yaml_says(
        "file: run03.csv",
        "file: run04.csv",
        "run run03: cannot open `bundle/run04.csv`",
    );
    yaml_says(
        "column: crosshead_acceleration_m_s2",
        "column: crosshead_acceleration_m_s",
        "has no column crosshead_acceleration_m_s; did you mean crosshead_acceleration_m_s2?",
    );
    yaml_says(
        "name: crosshead acceleration, column: crosshead_acceleration_m_s2",
        "name: crosshed acceleration, column: x",
        "runs.0.channels.2.name: found 'crosshed acceleration', expected one of",
    );
    yaml_says(
        "unit: m/s2",
        "unit: m/z2",
        "runs.0.channels.2.unit: there is no unit 'z'",
    );
    yaml_says(", unit: m/s2", "", "runs.0.channels.2.unit: missing");
    yaml_says(
        "unit: Pa",
        "unit: psig",
        "psig counts from the ambient pressure",
    );
    yaml_says(
        "sample_rate_hz: 20000",
        "sample_rate_hz: 25000",
        "the times are those of 20000",
    );
    yaml_says(
        "speed_rpm: 650",
        "speed_rpm: 715",
        "the speed is stated as 715.0 rpm, but the recording turns at 650.0 rpm",
    );
    yaml_says(
        "stroke_m: 0.24",
        "stroke_m: 0.30",
        "machine.stroke_m: found 0.3",
    );
    yaml_says(
        "rod_length_m: 0.6",
        "rod_length_m: 0.06",
        "bundle/recordings.yaml: rod.length: found",
    );
    yaml_says(
        "crank_radius_m: 0.12\n  rod_length_m: 0.6\n  stroke_m: 0.24",
        "crank_radius_m: 0.06\n  rod_length_m: 0.6\n  stroke_m: 0.12",
        "run run03: channel crosshead_acceleration_m_s2: its first order is",
    );
    yaml_says(
        "discharge_pressure_pa: 393000.0",
        "discharge_pressure_pa: 786000.0",
        "never reaches the discharge pressure",
    );
    yaml_says(
        "sample_rate_hz: 20000",
        "sample_rate_hz: 20000\n  samples: 30000",
        "cut off?",
    );
    let lines: Vec<&str> = csv.lines().collect();
    says(&yaml, &(lines[..100].join("\n") + "\n1,2"), "run run03: ");
    says(&yaml, &(lines[..100].join("\n") + "\n"), "run run03: ");
    let clipped = changed(2, &|_, x| x.clamp(-300.0, 300.0));
    says(
        &yaml,
        &clipped,
        "channel crosshead_acceleration_m_s2 is clipped",
    );
    let noise =
        |i: usize| ((i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / (1 << 24) as f64;
    says(
        &yaml,
        &changed(2, &|i, _| noise(i)),
        "run run03: channel crosshead_acceleration_m_s2",
    );
    says(
        &yaml,
        &changed(2, &|i, x| if i == 77 { f64::NAN } else { x }),
        "no number at sample 77",
    );
    let backwards = changed(1, &|i, x| if i == 5000 { (x - 1.0).max(0.0) } else { x });
    says(&yaml, &backwards, "run run03: ");
    says(
        &yaml,
        &changed(0, &|i, x| if i < 9000 { x } else { x + 0.5 }),
        "are missing before sample",
    );
    says(
        &yaml,
        &changed(0, &|i, x| x + 1e-9 * (i as f64).powi(2)),
        "run run03: ",
    );
    says(&yaml, &changed(2, &|_, x| -x), "positive toward the head");
}

#[test]
fn settings_are_checked_with_their_lines() {
    let columns = plain();
    let folder = written(&columns);
    let says = |text: &str, expected: &str| {
        fs::write(folder.path().join("c.yaml"), text).unwrap();
        let (status, message) = calibrate(folder.path(), &["c.yaml", "--out", "out"]);
        assert_eq!(status, 2, "{message}");
        assert!(
            message.contains(expected),
            "{message}\n  is not\n{expected}"
        );
        assert!(!folder.path().join("out").exists());
    };
    says("bundle: bundel\n", "bundel/recordings.yaml: cannot be read");
    says(
        "bundle: bundle\nparameters:\n  joints.big_end.contact.stifness:\n",
        "parameters.joints.big_end.contact.stifness: ",
    );
    says(
        "bundle: bundle\nparameters:\n  rod.mass: {bounds: [4 kg, 5 kg]}\n",
        "do not enclose its value 12",
    );
    says(
        "bundle: bundle\nparameters:\n  rod.mass: {bounds: [4 m, 50 m]}\n",
        "the bounds have another unit than its value (kg)",
    );
    says(
        "bundle: bundle\nleave_out: [run3]\n",
        "c.yaml:2:12: leave_out: found 'run3'",
    );
    says(
        "bundle: bundle\nhold_out: [run03]\n",
        "hold_out: found every run, expected at least one",
    );
    says(
        "bundle: bundle\nleave_out: [run03]\n",
        "every run is left out",
    );
    let (status, message) = calibrate(folder.path(), &["nowhere", "--out", "out"]);
    assert_eq!(status, 2);
    assert!(message.contains("nowhere: cannot be read"), "{message}");
}

#[test]
fn a_stopped_calibration_goes_on_and_a_whole_one_stays() {
    let folder = written(&plain());
    let text = "bundle: bundle\nparameters: [joints.big_end.contact.damping]\n\
                optimiser: levenberg_marquardt\nevaluations: 30\n";
    let calibration = settings_of(folder.path(), text);
    let settings = Settings {
        machine: None,
        calibration: &calibration,
        base: folder.path(),
        allow_outside: false,
        clearances_unknown: false,
        locate: &|error| error,
    };
    let out = folder.path().join("out");
    let run = |existing, stop| into_folder(&settings, &out, existing, stop);
    let stopped = run(Existing::Refuse, true).unwrap();
    assert!(!stopped.results.complete);
    assert!(run(Existing::Refuse, false).is_err());
    let whole = run(Existing::Resume, false).unwrap();
    assert!(whole.results.complete);
    assert!(!whole.reused);
    assert!(whole.results.evaluations > stopped.results.evaluations);
    let results = fs::read(out.join("calibration.json")).unwrap();
    let again = run(Existing::Resume, false).unwrap();
    assert!(again.reused);
    assert_eq!(fs::read(out.join("calibration.json")).unwrap(), results);

    // The same anew gives the same bytes, whatever went before.
    let machine = fs::read(out.join("machine.yaml")).unwrap();
    let other = run(Existing::Overwrite, false).unwrap().results;
    let second = folder.path().join("second");
    let fresh = into_folder(&settings, &second, Existing::Refuse, false)
        .unwrap()
        .results;
    assert_eq!(other, fresh);
    assert_eq!(
        fs::read(second.join("machine.yaml")).unwrap(),
        fs::read(out.join("machine.yaml")).unwrap()
    );
    assert!(!machine.is_empty());

    // Other settings are told, or made anew.
    let calibration = settings_of(folder.path(), &text.replace("damping", "stiffness"));
    let settings = Settings {
        machine: None,
        calibration: &calibration,
        ..settings
    };
    let changed = into_folder(&settings, &out, Existing::Resume, false);
    assert!(format!("{changed:?}").contains("--overwrite"));
    let renewed = into_folder(&settings, &out, Existing::Renew, false).unwrap();
    assert!(!renewed.reused);
    assert!(
        renewed
            .results
            .parameters
            .get("joints.big_end.contact.stiffness")
            .is_some()
    );
    // A folder with something else in it is left alone.
    let full = into_folder(&settings, folder.path(), Existing::Overwrite, false);
    assert!(
        format!("{full:?}").contains("not a calibration"),
        "{full:?}"
    );
}
