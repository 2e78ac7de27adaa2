//! Derivatives of a record against differences of records.

use input::{MachineFile, Resolved};
use serde_json::Value;
use simulate::{Asked, Moved, Settings, Transient, sensitivities, simulate};
use std::f64::consts::TAU;

/// The shipped machine with 0.1 mm at both ends: a periodic motion.
fn tree() -> Value {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    for (path, value) in [
        ("joints.big_end.clearance", "0.1 mm"),
        ("joints.small_end.clearance", "0.1 mm"),
        ("sensors.crosshead_acceleration.mounting", ""),
    ] {
        let value = match value {
            "" => serde_json::json!({"frequency": "3 kHz", "damping_ratio": "5 %"}),
            text => text.into(),
        };
        input::paths::set(&mut tree, path, value).unwrap();
    }
    tree
}

fn with(path: &str, value: &str) -> Resolved {
    let mut tree = tree();
    let value = value.parse::<f64>().map_or(value.into(), Value::from);
    input::paths::set(&mut tree, path, value).unwrap();
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

/// A path, its value a little below and above, and the step in the middle.
const STEPS: [(&str, &str, &str); 9] = [
    (
        "joints.big_end.contact.stiffness",
        "23.99 GN/m^1.5",
        "24.01 GN/m^1.5",
    ),
    (
        "joints.small_end.contact.damping",
        "1.999e4 N s/m",
        "2.001e4 N s/m",
    ),
    ("joints.big_end.friction.coefficient", "0.04995", "0.05005"),
    ("joints.small_end.clearance", "0.09999 mm", "0.10001 mm"),
    ("cylinder.exponent", "1.3999", "1.4001"),
    ("cylinder.head_clearance", "23.999 mm", "24.001 mm"),
    ("crosshead.mass", "17.999 kg", "18.001 kg"),
    ("sensors.crosshead_acceleration.gain", "0.9999", "1.0001"),
    (
        "sensors.crosshead_acceleration.mounting.frequency",
        "2999.9 Hz",
        "3000.1 Hz",
    ),
];

/// The machine, and one for each of the steps above it.
fn centre_and_moved() -> (Resolved, Vec<Moved>) {
    let centre = MachineFile::from_tree(&tree()).unwrap().resolve().unwrap();
    let moved = STEPS.iter().map(|(path, _, above)| {
        let machine = with(path, above);
        Moved {
            machine: machine.machine,
            sensors: machine.sensors,
        }
    });
    (centre, moved.collect())
}

#[test]
fn derivatives_equal_differences_of_records() {
    let settings = Settings {
        transient: Transient::Revolutions(25),
        revolutions: 1,
        tolerance: 1e-11,
        ..Settings::default()
    };
    let (centre, moved) = centre_and_moved();
    let found = sensitivities(
        &Asked::from_rest(&centre.machine, &centre.sensors, &settings),
        &moved,
    )
    .unwrap();
    let plain = simulate(&centre.machine, &centre.sensors, &settings, false).unwrap();
    // The last of all revolutions, evaluated at every instant, and by polynomials one from where the motion repeats itself:
    // steps are others there, so that they differ by what the integration errs (an RMS of eight times the tolerance,
    // `tests/peers`).
    let series = found.series.iter().zip(&plain.series);
    for ((found, plain), sensor) in series.zip(&centre.sensors) {
        // Where an angle begins anew, a rounding makes a turn.
        let turn = match sensor.measured.column(&[]).as_str() {
            "crank_angle_rad" => TAU,
            _ => f64::INFINITY,
        };
        let largest = plain.iter().fold(0.0_f64, |l, x| l.max(x.abs()));
        let off = found.iter().zip(plain).map(|(a, b)| (a - b).abs());
        let off = off.map(|off| off.min((turn - off).abs()));
        let off = off.fold(0.0, f64::max);
        let most = 8.0 * settings.tolerance * largest;
        assert!(off <= most, "{off:e} of {largest}");
    }
    for ((path, below, above), derivative) in STEPS.iter().zip(&found.derivatives) {
        let [below, above] = [below, above].map(|value| {
            let machine = with(path, value);
            simulate(&machine.machine, &machine.sensors, &settings, false).unwrap()
        });
        // The acceleration of the crosshead.
        let differences = above.series[0].iter().zip(&below.series[0]);
        let expected: Vec<f64> = differences.map(|(a, b)| (a - b) / 2.0).collect();
        let size = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
        let apart = derivative[0].iter().zip(&expected);
        let apart = apart.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        // A filter is moved by a difference, everything else by exact derivatives.
        let bound = if path.ends_with("frequency") {
            2e-3
        } else {
            2e-5
        };
        assert!(apart < bound * size, "{path}: {:.1e}", apart / size);
    }
}

/// Fits take long steps.
#[test]
fn derivatives_at_the_tolerance_of_fits_are_near_those_at_a_fine_one() {
    let (centre, moved) = centre_and_moved();
    let found = |tolerance| {
        let settings = Settings {
            transient: Transient::Revolutions(5),
            revolutions: 1,
            tolerance,
            ..Settings::default()
        };
        let asked = Asked::from_rest(&centre.machine, &centre.sensors, &settings);
        sensitivities(&asked, &moved).unwrap().derivatives
    };
    let (coarse, fine) = (found(1e-6), found(1e-11));
    for ((path, ..), (coarse, fine)) in STEPS.iter().zip(coarse.iter().zip(&fine)) {
        // The acceleration of the crosshead.
        let apart = coarse[0].iter().zip(&fine[0]).map(|(a, b)| (a - b).powi(2));
        let size = fine[0].iter().map(|x| x * x).sum::<f64>();
        let apart = (apart.sum::<f64>() / size).sqrt();
        eprintln!("{path} {apart:.1e}");
        assert!(apart < 1e-3, "{path}: {apart:.1e}");
    }
}

/// What the tangents have settled to after many revolutions follows from a single one.
#[test]
fn derivatives_of_a_settled_motion_are_those_of_its_orbit() {
    let settings = |transient| Settings {
        transient,
        revolutions: 1,
        tolerance: 1e-11,
        // A whole number of samples in a revolution.
        sample_rate: 1024.0 * 500.0 / 60.0,
        ..Settings::default()
    };
    let (centre, moved) = centre_and_moved();
    let found = |transient| {
        let settings = settings(transient);
        sensitivities(
            &Asked::from_rest(&centre.machine, &centre.sensors, &settings),
            &moved,
        )
        .unwrap()
    };
    let from_start = found(Transient::Revolutions(25));
    let of_orbit = found(Transient::Settled {
        change: 1e-10,
        at_most: 60,
    });
    assert!(of_orbit.settled);
    assert!(of_orbit.steps < from_start.steps / 4);
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let apart = |a: &[f64], b: &[f64]| {
        let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        norm(&differences) / norm(b)
    };
    for (channel, series) in of_orbit.series.iter().enumerate() {
        let apart = apart(series, &from_start.series[channel]);
        assert!(apart < 1e-6, "channel {channel}: {apart:.1e}");
    }
    for (i, (path, _, _)) in STEPS.iter().enumerate() {
        let apart = apart(&of_orbit.derivatives[i][0], &from_start.derivatives[i][0]);
        assert!(apart < 1e-5, "{path}: {apart:.1e}");
    }
}
