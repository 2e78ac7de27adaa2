//! Signals over the crank angle: as many samples in each revolution, from the angle that the case draws, with what
//! resampling leaves of an order in closed form.

use crate::toy::{self, each, files, options, plan, run};
use crate::venv;
use recordings::Table;
use recordings::formats::parquet;
use signal::channel::Channel;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;
use sweep::dataset::Failure;
use sweep::{Case, Existing, Plan, Recording, generate};

const POINTS: usize = 64;

/// Twelve cases at two speeds, resampled from 2 kHz: 240 and 300 samples in a revolution.
fn sweep(start: &str) -> String {
    format!(
        "name: test
machine: {{MACHINE}}
seed: 3
run: {{revolutions: 4, transient: 2, samples_per_revolution: {POINTS}{start}, chaos: false}}
repeats: 3
windows: {{count: 2, revolutions: 2}}
cases: [{{grid: {{joints: [[], [big_end]], clearance: 0.1 mm, speed: [400 rpm, 500 rpm]}}}}]
splits: {{train: 100 %}}
shard_size: 5
"
    )
}

/// The plan of a sweep of the shipped machine, recorded at 2 kHz.
fn plan_of(text: &str, changes: &[(&str, &str)]) -> Result<Plan, input::Error> {
    let shipped = toy::machines().join("single-stage.yaml");
    let mut machine = std::fs::read_to_string(shipped).unwrap();
    machine += "\nsample_rate: 2 kHz\n";
    for (from, to) in changes {
        assert!(machine.contains(from), "{from}");
        machine = machine.replace(from, to);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("machine.yaml"), machine).unwrap();
    let text = text.replace("{MACHINE}", "machine.yaml");
    let document = input::yaml::Document::parse(&text, "sweep.yaml")?;
    Plan::new(&document, folder.path())
}

/// Orders that pass (0.4 of 64 points: 25), that would alias below them, and that the recorder holds (0.4 of 240: 96).
const PASSES: [f64; 3] = [1.0, 7.0, 25.0];
const ALIASES: [f64; 3] = [39.0, 63.0, 95.0];

fn wave(angle: f64) -> f64 {
    PASSES.iter().map(|k| (k * angle + 0.3 * k).sin()).sum()
}

/// A recording of orders of the crank, which begins at angle 0.
fn record(case: &Case) -> Result<Recording, Failure> {
    let rate = case.settings.sample_rate;
    let step = case.resolved.speed / rate;
    let samples = (f64::from(case.settings.revolutions) * TAU / step).ceil() as usize;
    let channels = case.resolved.sensors.iter().map(|sensor| Channel {
        name: sensor.measured.column(&[""]),
        unit: sensor.measured.unit().into(),
        samples: (0..samples)
            .map(|i| {
                let angle = step * i as f64;
                match sensor.measured.unit() {
                    "rad" => angle.rem_euclid(TAU) as f32,
                    _ => {
                        let folded: f64 = ALIASES.iter().map(|k| (k * angle).cos()).sum();
                        (wave(angle) + folded) as f32
                    }
                }
            })
            .collect(),
    });
    Ok(Recording {
        motion: None,
        warnings: Vec::new(),
        sample_rate_hz: rate,
        channels: channels.collect(),
    })
}

fn make(plan: &Plan, root: &Path, threads: usize) {
    let cancel = AtomicBool::new(false);
    let refuse = options(Existing::Refuse, threads, &cancel);
    let manifest = generate(plan, root, &refuse, &each(record), &mut ()).unwrap();
    assert!(manifest.failed.is_empty(), "{:?}", manifest.failed);
}

fn tables(root: &Path, subset: &str) -> Vec<Table> {
    let paths = files(root).into_keys();
    let paths = paths.filter(|path| path.starts_with(subset));
    paths
        .map(|path| parquet::read_table(&root.join(path)).unwrap())
        .collect()
}

#[test]
fn signals_are_of_one_length_and_what_resampling_leaves_is_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
    let plan = plan_of(&sweep(", start: random"), &[]).unwrap();
    make(&plan, &one, 1);
    make(&plan, &two, 2);
    toy::assert_same(&one, &two);
    let mut starts = BTreeSet::new();
    for table in tables(&one, "signals") {
        assert_eq!(table.schema().metadata()["samples_per_revolution"], "64");
        assert!(table.schema().position("sample_rate_hz").is_err());
        let of_turn = table.values::<i64>("samples_per_revolution").unwrap();
        let start = table.values::<f64>("start_angle_rad").unwrap();
        let angle = table.values::<Vec<f32>>("crank_angle_rad").unwrap();
        let signal = table
            .values::<Vec<f32>>("crosshead_acceleration_m_s2")
            .unwrap();
        for row in 0..table.rows() {
            assert_eq!(of_turn[row], Some(POINTS as i64));
            let (angle, signal) = (angle[row].as_ref().unwrap(), signal[row].as_ref().unwrap());
            assert_eq!((angle.len(), signal.len()), (2 * POINTS, 2 * POINTS));
            let start = start[row].unwrap();
            starts.insert((start / TAU * POINTS as f64).round() as usize);
            for (j, (angle, y)) in angle.iter().zip(signal).enumerate() {
                let at = start + TAU * j as f64 / POINTS as f64;
                assert!(
                    (f64::from(*angle) - at.rem_euclid(TAU)).abs() < 1e-5,
                    "{angle} {at}"
                );
                // Each of the six orders errs by 1e-4 at most, and the samples are of single precision.
                let error = f64::from(*y) - wave(at);
                assert!(error.abs() < 6e-4 + 1e-6, "row {row}, {j}: {error:e}");
            }
        }
    }
    // Each of the twelve cases draws its own.
    assert!(starts.len() > 8, "{starts:?}");
    let script = venv::readers().join("read_dataset.py");
    venv::run(Command::new(venv::python()).arg(script).arg(&one));
}

#[test]
fn features_are_those_of_the_same_stretch_of_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    make(&plan_of(&sweep(""), &[]).unwrap(), folder.path(), 2);
    for table in tables(folder.path(), "signals") {
        let starts = table.values::<f64>("start_angle_rad").unwrap();
        assert!(starts.iter().all(|start| *start == Some(0.0)));
    }
    // Whole revolutions of six orders: 6/2, of which resampling takes three away.
    for table in tables(folder.path(), "features") {
        for rms in table
            .values::<f64>("crosshead_acceleration.rms_m_s2")
            .unwrap()
        {
            assert!((rms.unwrap() - 3_f64.sqrt()).abs() < 0.01, "{rms:?}");
        }
    }
}

#[test]
fn a_sweep_without_it_has_the_signals_that_it_had() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(toy::SWEEP);
    run(&plan, folder.path(), Existing::Refuse, 2).unwrap();
    let case = plan.case(0).unwrap();
    assert_eq!(case.settings, plan.settings);
    let tables = tables(folder.path(), "signals");
    let table = tables.iter().find(|table| table.rows() > 0).unwrap();
    assert_eq!(
        table.values::<f64>("sample_rate_hz").unwrap()[0],
        Some(1000.0)
    );
}

#[test]
fn what_cannot_be_resampled_is_refused() {
    let message = |text: &str, changes: &[(&str, &str)]| {
        plan_of(text, changes).map(|_| ()).unwrap_err().to_string()
    };
    let whole = sweep("");
    let both = whole.replace("transient: 2", "transient: 2, sample_rate: 2 kHz");
    let found = message(&both, &[]);
    assert_eq!(
        found,
        "sweep.yaml:4:81: run.samples_per_revolution: found 64 beside sample_rate 2000 Hz, expected one of the two; \
         sensors are recorded at the sample_rate of the machine file"
    );
    let found = message(&format!("{whole}format: mcap\n"), &[]);
    assert!(
        found.contains("found format mcap, expected format parquet"),
        "{found}"
    );
    let alone = whole.replace("samples_per_revolution: 64", "start: random");
    let found = message(&alone, &[]);
    assert!(
        found.contains("run.start: found a start without samples_per_revolution"),
        "{found}"
    );
    // 2 kHz at 500 rpm.
    let fine = whole.replace("samples_per_revolution: 64", "samples_per_revolution: 512");
    let found = message(&fine, &[]);
    let expected = "found 512, expected at most 240: at 500 rpm a recorder of 2000 Hz (sample_rate of the machine file)";
    assert!(found.contains(expected), "{found}");
    // Enough at the machine's own speed, and too few at that of a case.
    let edge = whole.replace("samples_per_revolution: 64", "samples_per_revolution: 240");
    plan_of(&edge, &[]).unwrap();
    let found = message(&edge.replace("500 rpm]", "600 rpm]"), &[]);
    assert!(
        found.contains("expected at most 200: at 600 rpm"),
        "{found}"
    );
}
