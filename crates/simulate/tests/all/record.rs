//! Records of the single-stage machine: sampling, transient, ledger, repetition.

use input::{MachineFile, Resolved};
use mechanism::drive::{Drive, Fluctuation, GivenSpeed};
use simulate::{Measured, Record, Settings, Transient, simulate, simulate_watched};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// The shipped machine with the same clearance at both ends, mm.
fn machine(clearance: &str) -> Resolved {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, clearance.into()).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

fn settings() -> Settings {
    Settings {
        transient: Transient::Revolutions(5),
        revolutions: 4,
        ..Settings::default()
    }
}

fn record(machine: &Resolved, settings: &Settings) -> Record {
    simulate(&machine.machine, &machine.sensors, settings, true).unwrap()
}

/// The series of the sensor that measures `what`.
fn series<'a>(machine: &Resolved, record: &'a Record, what: Measured) -> &'a [f64] {
    let index = machine
        .sensors
        .iter()
        .position(|s| s.measured == what)
        .unwrap();
    &record.series[index]
}

const ACCELERATION: Measured = Measured::CrossheadAcceleration { throw: 0 };

#[test]
fn a_record_has_its_samples_and_the_crank_angle_of_their_times() {
    let machine = machine("0.2 mm");
    let record = record(&machine, &settings());
    // Four revolutions of 0.12 s at 10 kHz.
    assert!(record.series.iter().all(|s| s.len() == 4800));
    let speed = 500.0 * TAU / 60.0;
    let angles = series(&machine, &record, Measured::CrankAngle);
    for (i, angle) in angles.iter().enumerate() {
        let expected = (speed * (0.6 + i as f64 * 1e-4)).rem_euclid(TAU);
        let apart = (angle - expected).rem_euclid(TAU);
        assert!(apart.min(TAU - apart) < 1e-9, "sample {i}");
    }
    assert_eq!(record.transient, 5);
}

#[test]
fn a_trace_from_the_very_start_is_the_reference_trajectory() {
    let machine = machine("0.2 mm");
    let settings = Settings {
        transient: Transient::Revolutions(0),
        revolutions: 2,
        tolerance: 1e-12,
        ..Settings::default()
    };
    let trace = record(&machine, &settings).trace.unwrap();
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/reference/trajectories/both_02mm.csv"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = names.iter().position(|n| *n == "as").unwrap();
    // One row every 0.4 ms, at 80 kHz every 32nd entry; the last row is the end of the record.
    let expected = lines.map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap());
    let ours = trace.throws[0]
        .acceleration
        .iter()
        .step_by(4 * trace.stride);
    let mut rows = 0;
    for (i, (ours, expected)) in ours.zip(expected).enumerate() {
        // At the dead centres, every 150 rows, the gas may be on either side of its change.
        if i % 150 != 0 {
            assert!(
                (ours - expected).abs() < 1e-6 * 1e3,
                "row {i}: {ours} {expected}"
            );
            rows += 1;
        }
    }
    assert!(rows > 590, "{rows}");
}

#[test]
fn the_ledger_closes_to_a_ten_millionth() {
    for clearance in ["0.1 mm", "0.3 mm"] {
        let record = record(&machine(clearance), &settings());
        let missing = record.energy_residual.unwrap();
        assert!(missing.abs() < 1e-7, "{missing}");
    }
}

#[test]
fn what_lies_below_the_pass_band_is_not_touched() {
    // The crank-angle-synchronous orders 1 to 20 lie below 200 Hz: recorded and true acceleration
    // must have the same.
    let machine = machine("0.2 mm");
    let record = record(&machine, &settings());
    let trace = record.trace.as_ref().unwrap();
    let truth: Vec<f64> = trace.throws[0].acceleration.clone();
    let recorded = series(&machine, &record, ACCELERATION);
    let order = |samples: &[f64], k: f64| -> f64 {
        let n = samples.len() as f64;
        let (mut c, mut s) = (0.0, 0.0);
        for (i, x) in samples.iter().enumerate() {
            let phase = k * 4.0 * TAU * i as f64 / n;
            c += x * phase.cos() * 2.0 / n;
            s += x * phase.sin() * 2.0 / n;
        }
        c.hypot(s)
    };
    for k in 1..=20 {
        let (a, b) = (order(&truth, f64::from(k)), order(recorded, f64::from(k)));
        assert!((a - b).abs() < 0.02, "order {k}: {a} {b}");
    }
}

#[test]
fn a_finer_recording_decimated_is_the_coarser_one() {
    let machine = machine("0.3 mm");
    let coarse = record(&machine, &settings());
    let fine = record(
        &machine,
        &Settings {
            sample_rate: 20e3,
            ..settings()
        },
    );
    let (coarse, fine) = (
        series(&machine, &coarse, ACCELERATION),
        series(&machine, &fine, ACCELERATION),
    );
    let decimator = signal::decimate::Decimator::new(2).unwrap();
    let half = decimator.half_length();
    let again = decimator.apply(fine);
    assert_eq!(
        half % 2,
        0,
        "outputs of the second decimation fall between coarse samples"
    );
    let (mut apart, mut size) = (0.0, 0.0);
    // Output i of the second decimation is centred on fine sample half + 2 i.
    for (value, coarse) in again.iter().zip(&coarse[half / 2..]).take(4000) {
        apart += (value - coarse).powi(2);
        size += coarse.powi(2);
    }
    assert!(size > 0.0);
    let ratio = (apart / size).sqrt();
    assert!(ratio < 2e-3, "{ratio}");
}

#[test]
fn a_periodic_motion_is_found_settled_and_a_chaotic_one_is_not() {
    let settle = Settings {
        transient: Transient::Settled {
            change: 1e-6,
            at_most: 40,
        },
        ..settings()
    };
    let periodic = record(&machine("0.2 mm"), &settle);
    assert!(
        periodic.settled && periodic.transient < 30,
        "{}",
        periodic.transient
    );
    let mut light = machine("0.3 mm");
    let throw = &mut light.machine.throws[0];
    for joint in [&mut throw.big_end, &mut throw.small_end] {
        if let mechanism::joints::revolute::Revolute::Clear(clear) = joint
            && let mechanism::joints::contact::ContactLaw::Impact(law) = &mut clear.contact
        {
            law.damping = 2e3;
        }
    }
    let chaotic = record(&light, &settle);
    assert!(!chaotic.settled && chaotic.transient == 40);
}

#[test]
fn a_record_repeats_bit_for_bit() {
    let machine = machine("0.3 mm");
    let (a, b) = (record(&machine, &settings()), record(&machine, &settings()));
    assert_eq!(a.series, b.series);
}

#[test]
fn a_tolerance_out_of_reach_is_an_error_with_its_time() {
    let machine = machine("0.2 mm");
    let hopeless = Settings {
        tolerance: 1e-30,
        ..settings()
    };
    let error = simulate(&machine.machine, &machine.sensors, &hopeless, false).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("the tolerance cannot be met at t ="),
        "{error}"
    );
}

#[test]
fn an_ideal_machine_is_recorded_too() {
    let record = record(&machine("ideal"), &settings());
    assert!(record.series.iter().flatten().all(|x| x.is_finite()));
    assert!(record.energy_residual.unwrap().abs() < 1e-9);
}

#[test]
fn a_machine_without_a_state_is_recorded() {
    // Joints are ideal, the speed is given, and no works are integrated: nothing is left to be solved.
    let ideal = machine("ideal");
    let settings = settings();
    let plain = simulate(&ideal.machine, &ideal.sensors, &settings, false).unwrap();
    let traced = record(&ideal, &settings);
    assert_eq!(plain.energy_residual, None);
    for (plain, traced) in plain
        .series
        .iter()
        .flatten()
        .zip(traced.series.iter().flatten())
    {
        assert!((plain - traced).abs() <= 1e-9 * traced.abs().max(1.0));
    }
}

/// θ̇ = ω (1 + d cos(ω t + ψ)).
#[test]
fn the_crank_speed_is_that_of_the_drive() {
    let mut machine = machine("ideal");
    let speed = 500.0 * TAU / 60.0;
    let (amplitude, phase) = (0.01, 0.4);
    machine.machine.drive = Drive::Given(GivenSpeed {
        speed,
        fluctuation: vec![Fluctuation { amplitude, phase }],
    });
    machine.sensors = vec![machine.perfect_sensor(Measured::CrankSpeed)];
    let record = record(&machine, &settings());
    let speeds = series(&machine, &record, Measured::CrankSpeed);
    for (i, seen) in speeds.iter().enumerate() {
        let time = record.start + i as f64 / record.sample_rate;
        let expected = speed * (1.0 + amplitude * (speed * time + phase).cos());
        assert!((seen / expected - 1.0).abs() < 1e-6, "sample {i}: {seen}");
    }
}

#[test]
fn who_watches_a_run_may_end_it_and_changes_nothing_otherwise() {
    let machine = machine("0.2 mm");
    let mut shares = Vec::new();
    let watched = simulate_watched(
        &machine.machine,
        &machine.sensors,
        &settings(),
        &mut |share| {
            shares.push(share);
            ControlFlow::Continue(())
        },
    );
    assert_eq!(
        watched.unwrap().series,
        record(&machine, &settings()).series
    );
    assert!(shares.is_sorted() && shares.last() > Some(&0.99));
    let mut steps = 0;
    let ended = simulate_watched(
        &machine.machine,
        &machine.sensors,
        &settings(),
        &mut |share| {
            steps += 1;
            match share > 0.5 {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        },
    );
    assert!(ended.unwrap_err().is_stopped());
    assert!(steps < shares.len());
}
