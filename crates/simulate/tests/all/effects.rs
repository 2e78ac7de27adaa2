//! Effects on the measuring chain against what they say, and the derivatives of the whole catalogue
//! against differences.

use input::effects::{CATALOGUE, Entry, Parameter};
use input::{MachineFile, Resolved, paths};
use serde_json::{Value, json};
use simulate::{Asked, Moved, Settings, Transient, sensitivities, simulate};
use std::f64::consts::TAU;

/// The shipped machine with 0.2 mm at the small end, and a list of effects.
fn tree(effects: Value) -> Value {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    paths::set(&mut tree, "joints.small_end.clearance", json!("0.2 mm")).unwrap();
    tree["effects"] = effects;
    tree
}

fn resolve(tree: &Value) -> Resolved {
    MachineFile::from_tree(tree).unwrap().resolve().unwrap()
}

fn settings() -> Settings {
    Settings {
        transient: Transient::Revolutions(1),
        revolutions: 1,
        tolerance: 1e-11,
        ..Settings::default()
    }
}

/// Acceleration, pressure and crank angle.
fn record(tree: &Value, settings: &Settings) -> Vec<Vec<f64>> {
    let machine = resolve(tree);
    simulate(&machine.machine, &machine.sensors, settings, false)
        .unwrap()
        .series
}

#[test]
fn gain_offset_and_hum_are_what_they_say() {
    let plain = record(&tree(json!([])), &settings());
    let gain = record(
        &tree(json!([{"sensor_gain": {"error": "-8 %"}}])),
        &settings(),
    );
    for (found, plain) in gain[0].iter().zip(&plain[0]) {
        assert!((found - 0.92 * plain).abs() < 1e-9);
    }
    assert_eq!(gain[1], plain[1]);

    let offset = tree(json!([{"crank_angle_offset": {"offset": "-3 deg"}}]));
    let offset = record(&offset, &settings());
    for (found, plain) in offset[2].iter().zip(&plain[2]) {
        assert!((0.0..TAU).contains(found));
        let turned = (plain - 3_f64.to_radians() - found).rem_euclid(TAU);
        assert!(turned.min(TAU - turned) < 1e-12, "{turned}");
    }

    let section = json!({"amplitude": "4 m/s^2", "frequency": "60 Hz", "phase": "30 deg"});
    let hum = record(&tree(json!([{"mains_hum": section}])), &settings());
    for (i, (found, plain)) in hum[0].iter().zip(&plain[0]).enumerate() {
        // One revolution of 0.12 s lies before the record.
        let time = 0.12 + i as f64 * 1e-4;
        let expected = 4.0 * (TAU * 60.0 * time + TAU / 12.0).cos();
        assert!((found - plain - expected).abs() < 1e-9, "{i}");
    }
    assert_eq!(hum[1], plain[1]);
}

#[test]
fn a_drifted_zero_shifts_accelerations_and_pressures() {
    let plain = record(&tree(json!([])), &settings());
    let section = json!({"acceleration": "-3 m/s^2", "pressure": "0.1 bar"});
    let found = record(&tree(json!([{"sensor_offset": section}])), &settings());
    // Crosshead and frame, cylinder, crank.
    for (channel, offset) in [(0, -3.0), (3, -3.0), (1, 1e4), (2, 0.0)] {
        for (found, plain) in found[channel].iter().zip(&plain[channel]) {
            assert_eq!(*found, plain + offset, "{channel}");
        }
    }
}

#[test]
fn a_sensor_on_its_mount_passes_each_order_by_its_frequency_response() {
    let section = json!({"frequency": "400 Hz", "damping_ratio": "5 %"});
    let settled = Settings {
        transient: Transient::Revolutions(12),
        revolutions: 2,
        ..settings()
    };
    let order = |series: &[f64], k: f64| {
        // The mount's own ringing at the start of the record dies down in the first revolution.
        let series = &series[series.len() / 2..];
        let n = series.len() as f64;
        let part = |i: usize| TAU * k * i as f64 / n;
        let sum = |f: fn(f64) -> f64| -> f64 {
            let parts = series.iter().enumerate();
            parts.map(|(i, x)| x * f(part(i))).sum()
        };
        sum(f64::cos).hypot(sum(f64::sin))
    };
    let plain = record(&tree(json!([])), &settled);
    let mounted = record(&tree(json!([{"sensor_resonance": section}])), &settled);
    for k in [1.0, 2.0, 6.0, 12.0, 24.0, 48.0] {
        let r: f64 = k * 500.0 / 60.0 / 400.0;
        let gain = 1.0 / ((1.0 - r * r).powi(2) + (0.1 * r).powi(2)).sqrt();
        let found = order(&mounted[0], k) / order(&plain[0], k);
        assert!(
            (found / gain - 1.0).abs() < 0.01,
            "order {k}: {found} {gain}"
        );
    }
}

#[test]
fn the_sensor_on_the_crosshead_rides_on_a_frame_that_gives() {
    let plain = record(&tree(json!([])), &settings());
    let section = json!({"frame_compliance": {"mass_ratio": "4 %"}});
    let found = record(&tree(json!([section])), &settings());
    // The last sensor of the shipped machine is on the frame.
    let frame = found.last().unwrap();
    assert!(frame.iter().any(|x| x.abs() > 1.0));
    for ((found, plain), frame) in found[0].iter().zip(&plain[0]).zip(frame) {
        assert!((found - plain - frame).abs() < 1e-6);
    }
}

#[test]
fn a_fluctuating_crank_is_recorded_as_it_turns() {
    let section = json!({"first": "3 %", "first_phase": "40 deg", "second": "1 %"});
    let found = record(&tree(json!([{"speed_fluctuation": section}])), &settings());
    for (i, angle) in found[2].iter().enumerate() {
        let turned = TAU * (i as f64 * 1e-4) / 0.12;
        let phase = 40_f64.to_radians();
        let expected = turned + 0.03 * (turned + phase).sin() + 0.005 * (2.0 * turned).sin();
        let off = (angle - expected).rem_euclid(TAU);
        assert!(off.min(TAU - off) < 1e-9, "{i}: {off}");
    }
}

/// The section of `entry` at the small end, with the `index`-th parameter at `value`.
fn moved(entry: &Entry, values: &[f64], index: usize, value: f64) -> Resolved {
    let mut values = values.to_vec();
    values[index] = value;
    let joint = entry.places.iter().any(|choice| choice.key == "joint");
    let place: &[(&str, &str)] = if joint {
        &[("joint", "small_end")]
    } else {
        &[]
    };
    let mut tree = tree(json!([entry.item(place, &values)]));
    if entry.name == "guide_clearance" {
        // So that the sensor along the guide feels more than its friction.
        paths::set(&mut tree, "joints.small_end.clearance", json!("ideal")).unwrap();
    }
    resolve(&tree)
}

/// A step over which the parameter is moved either way. The usual film changes so little that over a smaller step the
/// difference is that of the integration's rounding.
fn step(entry: &Entry, parameter: &Parameter) -> f64 {
    let [low, high] = parameter.bounds;
    let size = if parameter.start == 0.0 {
        0.1 * (high - low)
    } else {
        parameter.start
    };
    let share = match entry.name {
        "squeeze_film" => 1e-3,
        _ => 1e-5,
    };
    share * size.abs()
}

#[test]
fn derivatives_of_the_whole_catalogue_equal_differences() {
    let settings = settings();
    for entry in CATALOGUE.iter() {
        // The usual form of a law is at an end of its range: there are no differences there.
        let value = |p: &Parameter| match p.shape {
            true => 0.5 * (p.bounds[0] + p.bounds[1]),
            false => p.start,
        };
        let mut values: Vec<f64> = entry.parameters.iter().map(value).collect();
        if entry.name == "thermal_clearance" {
            // At the speed of the reference the exponent would not count.
            values[1] = 40.0;
        }
        let free: Vec<usize> = (0..values.len())
            .filter(|i| !entry.parameters[*i].whole)
            .collect();
        let centre = moved(entry, &values, 0, values[0]);
        let all: Vec<Moved> = free
            .iter()
            .map(|i| {
                moved(
                    entry,
                    &values,
                    *i,
                    values[*i] + step(entry, &entry.parameters[*i]),
                )
            })
            .map(|m| Moved {
                machine: m.machine,
                sensors: m.sensors,
            })
            .collect();
        let found = sensitivities(
            &Asked::from_rest(&centre.machine, &centre.sensors, &settings),
            &all,
        )
        .unwrap();
        for (i, derivative) in free.into_iter().zip(&found.derivatives) {
            let parameter = &entry.parameters[i];
            let step = step(entry, parameter);
            let at = |sign: f64| {
                let machine = moved(entry, &values, i, values[i] + sign * step);
                simulate(&machine.machine, &machine.sensors, &settings, false)
                    .unwrap()
                    .series
            };
            let (more, less) = (at(1.0), at(-1.0));
            // Acceleration, pressure, crank angle, frame.
            for (channel, derivative) in derivative.iter().enumerate() {
                let pairs = more[channel].iter().zip(&less[channel]);
                // An angle that passes a whole turn jumps back.
                let whole = if channel == 2 { TAU } else { f64::INFINITY };
                let change = |a: f64, b: f64| a - b - ((a - b) / whole).round() * TAU;
                let expected: Vec<f64> = pairs.map(|(a, b)| change(*a, *b) / 2.0).collect();
                let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
                let apart: Vec<f64> = derivative
                    .iter()
                    .zip(&expected)
                    .map(|(a, b)| a - b)
                    .collect();
                let (apart, size) = (norm(&apart), norm(&expected));
                let name = format!("{}.{} on channel {channel}", entry.name, parameter.key);
                // What is below the rounding of the differences tells nothing.
                let floor = 1e-9 * norm(&more[channel]);
                eprintln!(
                    "{name:60} {:.1e} of {size:.1e}, floor {floor:.1e}",
                    apart / size
                );
                assert!(apart < 1e-3 * size + floor, "{name}: {apart:e} of {size:e}");
            }
        }
    }
}

#[test]
fn every_effect_is_seen_in_some_channel() {
    let settings = settings();
    let plain = record(&tree(json!([])), &settings);
    for entry in CATALOGUE.iter() {
        let values: Vec<f64> = entry.parameters.iter().map(|p| p.start).collect();
        let machine = moved(entry, &values, 0, values[0]);
        let found = simulate(&machine.machine, &machine.sensors, &settings, false).unwrap();
        let change = |channel: usize| {
            let pairs = found.series[channel].iter().zip(&plain[channel]);
            let square: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            let size: f64 = plain[channel].iter().map(|x| x * x).sum();
            (square / size).sqrt()
        };
        let seen = (0..3).map(change).fold(0.0, f64::max);
        eprintln!("{:20} {seen:.1e}", entry.name);
        assert!(seen > 2e-3, "{}: {seen:e}", entry.name);
    }
}

#[test]
fn an_amplitude_of_nothing_gives_the_same_bytes() {
    let settings = settings();
    let plain = record(&tree(json!([])), &settings);
    let none: Vec<Value> = CATALOGUE
        .iter()
        .filter(|entry| entry.amplitudes().next().is_some())
        .map(|entry| {
            let values: Vec<f64> = entry
                .parameters
                .iter()
                .map(|p| p.absent.unwrap_or(p.start))
                .collect();
            let joint = entry.places.iter().any(|choice| choice.key == "joint");
            let place: &[(&str, &str)] = if joint {
                &[("joint", "small_end")]
            } else {
                &[]
            };
            entry.item(place, &values)
        })
        .collect();
    assert_eq!(record(&tree(json!(none)), &settings), plain);
}
