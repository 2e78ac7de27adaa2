//! Runs simulated in place of recordings that were themselves simulated: they must come back.

use calibrate::CrankMotion;
use calibrate::problem::columns;
use calibrate::replay::Replayed;
use calibrate::{Channel, Observation, Problem, Replay, Run, replay};
use input::{MachineFile, machine_file, paths};
use serde_json::Value;
use simulate::{Chain, ChamberEnd, Measured, Sensor, Settings, Transient, simulate_later};
use std::f64::consts::TAU;
use std::path::Path;

const SAMPLE_RATE: f64 = 10_000.0;

/// Encoder readings of 16 bits.
fn encoder(angle: f64) -> f64 {
    let step = TAU / 65536.0;
    ((angle / step).round() * step).rem_euclid(TAU)
}

/// A bundle's run of a machine of `data/machines`, changed: `revolutions` that begin `delay` seconds
/// after crank angle 0.
fn recorded(machine: &str, changes: &[(&str, &str)], delay: f64) -> (Problem, Run) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let file = machine_file::read(&folder.join(machine)).unwrap();
    let mut tree = file.to_tree().clone();
    for (path, value) in changes {
        paths::set(&mut tree, path, Value::from(*value)).unwrap();
    }
    let resolved = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let names: Vec<&str> = resolved
        .machine
        .throws
        .iter()
        .map(|throw| throw.name.as_str())
        .collect();
    let end = ChamberEnd::Head;
    let sensors: Vec<Sensor> = (0..names.len())
        .flat_map(|throw| {
            [
                Measured::CrossheadAcceleration { throw },
                Measured::CylinderPressure { throw, end },
            ]
        })
        .chain([Measured::CrankAngle])
        .map(|measured| Sensor {
            measured,
            chain: Chain::default(),
        })
        .collect();
    let settings = Settings {
        transient: Transient::Settled {
            change: 1e-9,
            at_most: 200,
        },
        revolutions: 6,
        sample_rate: SAMPLE_RATE,
        inner_rate: 80_000.0,
        tolerance: 1e-9,
    };
    let record = simulate_later(&resolved.machine, &sensors, &settings, delay, false).unwrap();
    assert!(record.settled);
    let (angle, series) = record.series.split_last().unwrap();
    let channels = sensors.iter().zip(series).map(|(sensor, samples)| Channel {
        column: sensor.measured.column(&names),
        samples: samples.clone(),
    });
    let angle: Vec<f64> = angle.iter().map(|a| encoder(*a)).collect();
    let run = Run {
        id: "run01".into(),
        settings: Vec::new(),
        speed_rpm: mean_speed_rpm(&angle),
        sample_rate: SAMPLE_RATE,
        is_timed: true,
        crank_angle: Some(angle),
        channels: channels.collect(),
    };
    let observation = Observation::from_run(&run, &columns(&resolved)).unwrap();
    let problem = Problem {
        tree,
        parameters: Vec::new(),
        runs: vec![observation],
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    (problem, run)
}

fn mean_speed_rpm(wrapped: &[f64]) -> f64 {
    let angles = signal::crank_angle::unwrap(wrapped).unwrap();
    let last = angles.len() - 1;
    (angles[last] - angles[0]) / TAU * 60.0 * SAMPLE_RATE / last as f64
}

/// Largest RMS difference of a channel, over the recording's RMS about its mean.
fn worst(run: &Run, replay: &Replay) -> f64 {
    let of_channel = |(channel, replayed): (&Channel, &Replayed)| {
        assert_eq!(channel.column, replayed.column);
        assert_eq!(channel.samples.len(), replayed.samples.len());
        let both = channel.samples.iter().zip(&replayed.samples);
        let squares: f64 = both.map(|(a, b)| (a - b).powi(2)).sum();
        (squares / channel.samples.len() as f64).sqrt() / replayed.recording_rms
    };
    let channels = run.channels.iter().zip(&replay.channels);
    channels.map(of_channel).fold(0.0, f64::max)
}

#[test]
fn a_run_at_given_speed_comes_back_sample_by_sample() {
    let changes = [
        ("joints.big_end.clearance", "0.1 mm"),
        ("joints.small_end.clearance", "0.1 mm"),
        // No whole number of samples in a revolution.
        ("speed", "487.3 rpm"),
    ];
    let (problem, run) = recorded("single-stage.yaml", &changes, 0.0431);
    let replay = replay(&problem, &run, &problem.runs[0], &[]).unwrap();
    assert!(replay.periodic);
    assert_eq!(replay.crank_angle.len(), run.channels[0].samples.len());
    // A step of the encoder is 1e-4 rad; over thousands of samples it averages out.
    assert!(
        replay.angle_difference < 5e-5,
        "{:e}",
        replay.angle_difference
    );
    assert!((replay.simulated_rpm / 487.3 - 1.0).abs() < 1e-6);
    let worst = worst(&run, &replay);
    assert!(worst < 1e-3, "{worst:e}");
}

#[test]
fn a_run_of_a_free_crank_comes_back_from_where_it_began() {
    let (problem, run) = recorded("two-stage.yaml", &[], 0.0871);
    let replay = replay(&problem, &run, &problem.runs[0], &[]).unwrap();
    assert!(replay.periodic);
    assert!(
        replay.angle_difference < 1e-4,
        "{:e}",
        replay.angle_difference
    );
    let apart = replay.simulated_rpm / replay.recorded_rpm - 1.0;
    assert!(apart.abs() < 1e-6, "{apart:e}");
    let worst = worst(&run, &replay);
    assert!(worst < 2e-3, "{worst:e}");
}

/// A stiffer bearing than the recorded one: the same angle, another wave, and a misfit that tells.
#[test]
fn another_machine_is_told_apart() {
    let clear = ("joints.big_end.clearance", "0.1 mm");
    let (mut problem, run) = recorded("single-stage.yaml", &[clear], 0.01);
    let path = "joints.big_end.contact.stiffness";
    paths::set(&mut problem.tree, path, Value::from("48 GN/m^1.5")).unwrap();
    let replay = replay(&problem, &run, &problem.runs[0], &[]).unwrap();
    let acceleration = &replay.channels[0];
    let share = acceleration.difference / acceleration.recording_rms;
    assert!(share > 0.01, "{share}");
    assert!(acceleration.misfit > 10.0 * replay.channels[1].misfit);
    assert!(replay.misfit > 2.0);
}
