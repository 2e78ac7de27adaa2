//! The housing of a crosshead guide and the frame below it against the closed form of a driven oscillator.

use input::{MachineFile, Resolved, paths};
use serde_json::{Value, json};
use signal::Complex64;
use simulate::{Axis, ChamberEnd, Measured, Record, Settings, Transient, simulate};
use std::f64::consts::{PI, TAU};

/// rad/s at 500 rpm.
const SPEED: f64 = 500.0 * TAU / 60.0;
const RADIUS: f64 = 0.12;
const LENGTH: f64 = 0.6;
/// Mass of the crosshead, kg.
const CROSSHEAD: f64 = 18.0;
const GRAVITY: f64 = 9.81;
/// Housing: kg, Hz, damping ratio along x and y.
const MASS: f64 = 150.0;
const X: [f64; 2] = [320.0, 0.04];
const Y: [f64; 2] = [140.0, 0.06];

/// The shipped machine with ideal joints and a rod without mass, on its frame or without one.
fn machine(framed: bool) -> Resolved {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    for (path, value) in [("rod.mass", "1e-6 kg"), ("rod.inertia", "1e-9 kg m^2")] {
        paths::set(&mut tree, path, json!(value)).unwrap();
    }
    let swing = |[frequency, damping]: [f64; 2]| json!({"frequency": format!("{frequency} Hz"), "damping_ratio": format!("{damping} 1")});
    tree["housing"] = json!({"mass": format!("{MASS} kg"), "x": swing(X), "y": swing(Y)});
    if !framed {
        tree.as_object_mut().unwrap().remove("frame");
        tree["sensors"] = Value::Array(Vec::new());
    }
    let unbalance = json!({"rotating_unbalance": {"eccentricity": "0.3 mm", "phase": "50 deg"}});
    tree["effects"] = match framed {
        true => json!([unbalance]),
        false => json!([]),
    };
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

/// What these sensors record of four settled revolutions.
fn record(machine: &Resolved, measured: &[Measured]) -> Record {
    let sensors: Vec<_> = measured
        .iter()
        .map(|m| machine.perfect_sensor(*m))
        .collect();
    let settings = Settings {
        transient: Transient::Settled {
            change: 1e-7,
            at_most: 200,
        },
        revolutions: 4,
        tolerance: 1e-8,
        ..Settings::default()
    };
    simulate(&machine.machine, &sensors, &settings, false).unwrap()
}

/// Amplitude of an order: c of Re(c e^(ikθ)), with θ = 0 at the first sample.
fn line(samples: &[f64], order: usize) -> Complex64 {
    let n = samples.len() as f64;
    let turn = |i: usize| Complex64::cis(-TAU * 4.0 * order as f64 * i as f64 / n);
    let products = samples.iter().enumerate().map(|(i, x)| turn(i) * *x);
    products.sum::<Complex64>() * (2.0 / n)
}

/// Accelerance times mass, and transmissibility, at an order of the crank.
fn responses([frequency, damping]: [f64; 2], order: usize) -> [Complex64; 2] {
    let r = order as f64 * SPEED / (TAU * frequency);
    let damped = Complex64::new(0.0, 2.0 * damping * r);
    let below = 1.0 - r * r + damped;
    [-r * r / below, (1.0 + damped) / below]
}

fn near(found: Complex64, expected: Complex64, scale: f64, what: &str) {
    let apart = (found - expected).norm();
    assert!(apart < 2e-4 * scale, "{what}: {found} for {expected}");
}

fn greatest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

#[test]
fn the_gas_on_the_cover_shakes_the_housing_by_its_accelerance() {
    let machine = machine(false);
    let along = Measured::HousingAcceleration {
        throw: 0,
        axis: Axis::X,
    };
    let end = ChamberEnd::Head;
    let record = record(
        &machine,
        &[along, Measured::CylinderPressure { throw: 0, end }],
    );
    let area = PI * 0.05 * 0.05;
    let scale = greatest(&record.series[0]);
    for order in 1..=60 {
        let force = line(&record.series[1], order) * area;
        let expected = force / MASS * responses(X, order)[0];
        let found = line(&record.series[0], order);
        near(found, expected, scale, &format!("order {order}"));
    }
}

#[test]
fn the_crosshead_shakes_the_housing_across_the_guide() {
    let machine = machine(false);
    let across = Measured::HousingAcceleration {
        throw: 0,
        axis: Axis::Y,
    };
    let measured = [
        across,
        Measured::CrossheadAcceleration { throw: 0 },
        Measured::CylinderPressure {
            throw: 0,
            end: ChamberEnd::Head,
        },
    ];
    let record = record(&machine, &measured);
    let area = PI * 0.05 * 0.05;
    // A rod without mass pulls along itself: the guide bears what its push on the crosshead has across.
    let forces = record.series[1].iter().zip(&record.series[2]);
    let forces = forces.enumerate().map(|(i, (acceleration, pressure))| {
        let angle = SPEED * (record.start + i as f64 * 1e-4);
        let sine = -RADIUS * angle.sin() / LENGTH;
        let push = CROSSHEAD * acceleration + pressure * area;
        push * sine / (1.0 - sine * sine).sqrt() - CROSSHEAD * GRAVITY
    });
    let forces: Vec<f64> = forces.collect();
    let scale = greatest(&record.series[0]);
    for order in 1..=60 {
        let expected = line(&forces, order) / MASS * responses(Y, order)[0];
        let found = line(&record.series[0], order);
        near(found, expected, scale, &format!("order {order}"));
    }
}

#[test]
fn the_housing_rides_on_a_frame_that_gives_and_is_shaken() {
    let machine = machine(true);
    let axis = Axis::X;
    let measured = [
        Measured::HousingAcceleration { throw: 0, axis },
        Measured::FrameAcceleration { axis },
        Measured::CylinderPressure {
            throw: 0,
            end: ChamberEnd::Head,
        },
        Measured::HousingVelocity { throw: 0, axis },
        Measured::FrameVelocity { axis },
    ];
    let record = record(&machine, &measured);
    let area = PI * 0.05 * 0.05;
    let [housing, frame, pressure, housing_velocity, frame_velocity] = &record.series[..] else {
        panic!("five sensors");
    };
    let [scale, slow] = [greatest(housing), greatest(housing_velocity)];
    for order in 1..=60 {
        let [accelerance, transmissibility] = responses(X, order);
        let force = line(pressure, order) * area;
        let expected = transmissibility * line(frame, order) + accelerance * force / MASS;
        let found = line(housing, order);
        near(found, expected, scale, &format!("order {order}"));
        let turning = Complex64::new(0.0, order as f64 * SPEED);
        let velocity = line(housing_velocity, order);
        near(
            velocity,
            found / turning,
            slow,
            &format!("velocity {order}"),
        );
        let expected = line(frame, order) / turning;
        near(
            line(frame_velocity, order),
            expected,
            slow,
            &format!("frame {order}"),
        );
    }
    // The unbalance alone moves the frame by 0.3 mm.
    assert!(line(frame_velocity, 1).norm() > 0.2 * 0.3e-3 * SPEED);
}

#[test]
fn a_structure_has_swung_itself_in_where_its_record_begins() {
    let machine = machine(false);
    let along = Measured::HousingAcceleration {
        throw: 0,
        axis: Axis::X,
    };
    let record = record(&machine, &[along, Measured::CrankAngle]);
    // Its own swinging would make the first revolution another than the last.
    let samples = &record.series[0];
    let [first, last] = [&samples[..1200], &samples[3600..]];
    let apart = first.iter().zip(last).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 3e-4 * greatest(samples), "{apart}");
    // It begins where a record without it does.
    assert!(record.series[1][0] < 1e-6, "{}", record.series[1][0]);
}

#[test]
fn a_structure_that_never_settles_is_refused() {
    let mut machine = machine(false);
    let sensor = Measured::HousingAcceleration {
        throw: 0,
        axis: Axis::X,
    };
    let housing = machine.machine.throws[0].housing.as_mut().unwrap();
    housing.x.damping_ratio = 1e-9;
    let sensors = [machine.perfect_sensor(sensor)];
    let error = simulate(&machine.machine, &sensors, &Settings::default(), false).unwrap_err();
    let words = "sensor housing_acceleration: the housing swings by itself for 3.8e7 revolutions";
    assert!(error.to_string().starts_with(words), "{error}");
}
