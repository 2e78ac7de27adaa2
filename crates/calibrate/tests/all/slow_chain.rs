//! What of a measuring chain takes longer than a period: predicted lines against recorded samples, and derivatives against
//! differences.

use crate::own_recordings::{machine, problem};
use calibrate::Problem;
use calibrate::prediction::{Prediction, predict, predict_with_derivatives};
use input::MachineFile;
use serde_json::{Value, json};
use signal::Complex64;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use signal::order_lines::{OrderLines, order_lines};
use simulate::{Settings, Transient};
use std::f64::consts::TAU;

const RPM: f64 = 600.0;
const ORDERS: usize = 40;

fn coupled() -> Value {
    let mut tree = machine(["0.1 mm", "0 mm"]);
    let chain = [
        (
            "sensor_delay",
            json!({"measure": "crosshead_acceleration", "delay": "0.7 ms"}),
        ),
        (
            "sensor_highpass",
            json!({"measure": "crosshead_acceleration", "cutoff": "4 Hz"}),
        ),
    ];
    let item = |(name, section): (&str, Value)| json!({ name: section });
    tree["speed"] = json!(format!("{RPM} rpm"));
    tree["effects"] = chain.into_iter().map(item).collect();
    tree
}

fn problem_of(tree: Value) -> Problem {
    let truth = [
        ("effects.0.sensor_delay.delay", 0.0),
        ("effects.1.sensor_highpass.cutoff", 0.0),
    ];
    problem(tree, &truth, &[RPM], ORDERS, 1e-4)
}

/// The lines of the acceleration in 20 recorded revolutions of the machine.
fn recorded(tree: &Value) -> OrderLines {
    recorded_of(tree, "crosshead_acceleration")
}

/// The lines of the first channel whose column begins with `name`.
fn recorded_of(tree: &Value, name: &str) -> OrderLines {
    let machine = MachineFile::from_tree(tree).unwrap().resolve().unwrap();
    let settings = Settings {
        transient: Transient::Revolutions(15),
        revolutions: 20,
        sample_rate: 1024.0 * RPM / 60.0,
        tolerance: 1e-8,
        ..Settings::default()
    };
    let record = simulate::simulate(&machine.machine, &machine.sensors, &settings, false).unwrap();
    let columns = machine
        .sensors
        .iter()
        .map(|sensor| sensor.measured.column(&[""]));
    let of = |name: &str| {
        let index = columns.clone().position(|column| column.starts_with(name));
        &record.series[index.unwrap()]
    };
    let angle: Vec<f64> = (0..record.series[0].len())
        .map(|i| TAU * (i as f64 / 1024.0).fract())
        .collect();
    let angle = CrankAngle::from_encoder(&angle).unwrap();
    let grid = AngleGrid::new(&angle, 1024).unwrap();
    let samples = grid.resample(of(name)).unwrap();
    order_lines(&samples, ORDERS).unwrap()
}

fn apart(a: &[Complex64], b: &[Complex64]) -> f64 {
    let pairs = a.iter().zip(b).take(ORDERS + 1).skip(1);
    let [apart, size] = pairs.fold([0.0, 0.0], |[apart, size], (a, b)| {
        [apart + (a - b).norm_sqr(), size + b.norm_sqr()]
    });
    (apart / size).sqrt()
}

#[test]
fn predicted_lines_are_those_of_a_record() {
    let tree = coupled();
    let problem = problem_of(tree.clone());
    let shown = predict(&problem, &problem.runs[0], &[0.0; 2]).unwrap();
    let lines = recorded(&tree);
    let error = apart(&shown.lines[0].amplitude, &lines.amplitude);
    assert!(error < 2e-3, "{error:.1e}");
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let problem = problem_of(coupled());
    let at = |x: [f64; 2]| predict(&problem, &problem.runs[0], &x).unwrap();
    let found: Prediction =
        predict_with_derivatives(&problem, &problem.runs[0], &[0.0; 2]).unwrap();
    let step = 1e-3;
    for i in 0..2 {
        let moved = |by: f64| {
            let mut x = [0.0; 2];
            x[i] += by;
            at(x)
        };
        let (more, less) = (moved(step), moved(-step));
        let pairs = more.lines[0].amplitude.iter().zip(&less.lines[0].amplitude);
        let expected: Vec<_> = pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect();
        let error = apart(&found.derivatives[i][0], &expected);
        assert!(error < 1e-3, "{i}: {error:.1e}");
    }
}

/// A worn machine whose guide swings on its frame.
fn housed() -> Value {
    let mut tree = machine(["0.1 mm", "0 mm"]);
    tree["speed"] = json!(format!("{RPM} rpm"));
    let swing = |frequency: &str| json!({"frequency": frequency, "damping_ratio": "6 %"});
    tree["housing"] = json!({"mass": "150 kg", "x": swing("300 Hz"), "y": swing("180 Hz")});
    tree["sensors"] = json!([{"measure": "housing_acceleration", "axis": "y"}]);
    tree
}

#[test]
fn the_housing_of_a_guide_is_predicted_as_it_is_recorded() {
    let tree = housed();
    let mut problem = problem(
        tree.clone(),
        &[("housing.y.frequency", 0.0)],
        &[RPM],
        ORDERS,
        1e-4,
    );
    problem.runs[0].channels[0].column = "housing_acceleration_y_m_s2".into();
    let at = |x: f64| predict(&problem, &problem.runs[0], &[x]).unwrap();
    let lines = recorded_of(&tree, "housing_acceleration");
    let shown = at(0.0);
    let error = apart(&shown.lines[0].amplitude, &lines.amplitude);
    assert!(error < 2e-3, "{error:.1e}");
    // The derivative has a part of the structure and one of what drives it.
    let found = predict_with_derivatives(&problem, &problem.runs[0], &[0.0]).unwrap();
    let step = 1e-3;
    let (more, less) = (at(step), at(-step));
    let pairs = more.lines[0].amplitude.iter().zip(&less.lines[0].amplitude);
    let expected: Vec<_> = pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect();
    let error = apart(&found.derivatives[0][0], &expected);
    assert!(error < 1e-3, "{error:.1e}");
}
