//! Machines that were recorded at one clearance or at two, under a relation of our choice.

use calibrate::CrankMotion;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::relation::exponents;
use calibrate::transfer::{Basis, Hypothesis};
use calibrate::{
    ClearJoint, Fit, Observation, Parameter, Problem, Relation, Transfer, calibrate, transfer,
};
use input::paths;
use serde_json::{Value, json};
use signal::order_lines::OrderLines;
use std::ops::ControlFlow;
use std::path::Path;

const COLUMN: &str = "crosshead_acceleration_m_s2";
const STIFFNESS: &str = "joints.small_end.contact.stiffness";
const DAMPING: &str = "joints.small_end.contact.damping";
/// Standard deviation of every line, m/s²: about 0.1 % of the acceleration.
const NOISE: f64 = 0.2;
/// Orders that are compared.
const ORDERS: usize = 120;

/// The single-stage machine with a small end of 0.1 mm and 15 GN/m^1.5, 26 kN s/m there, and a
/// stiffness that stays and a damping that falls with this power of the clearance.
fn truth(power: f64) -> Value {
    let mut tree = nominal();
    let contact = "joints.small_end.contact";
    for (key, value) in [
        ("stiffness", json!("15 GN/m^1.5")),
        ("damping", json!("26 kN s/m")),
        ("relation", json!({ "damping": power })),
        ("at_clearance", json!("0.1 mm")),
    ] {
        paths::set(&mut tree, &format!("{contact}.{key}"), value).unwrap();
    }
    tree
}

fn nominal() -> Value {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let mut tree = input::machine_file::read(Path::new(file))
        .unwrap()
        .to_tree()
        .clone();
    paths::set(&mut tree, "joints.small_end.clearance", json!("0.1 mm")).unwrap();
    tree
}

/// What `tree` shows at this speed and clearance of the small end.
fn recording(tree: &Value, id: &str, speed: &str, clearance: &str) -> Observation {
    let settings = [("speed", speed), ("joints.small_end.clearance", clearance)];
    let channel = |lines| Observed {
        scatter: Vec::new(),
        column: COLUMN.into(),
        lines,
        orders: (1..=ORDERS).collect(),
    };
    let mut run = Observation {
        id: id.into(),
        settings: settings
            .map(|(path, value)| (path.to_owned(), json!(value)))
            .to_vec(),
        crank: mechanism::drive::GivenSpeed {
            speed: 0.0,
            fluctuation: Vec::new(),
        },
        channels: vec![channel(OrderLines {
            amplitude: Vec::new(),
            variance: Vec::new(),
            revolutions: 30,
        })],
        warm_start: None,
    };
    let machine = Problem {
        tree: tree.clone(),
        parameters: Vec::new(),
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    let shown = predict(&machine, &run, &[]).unwrap().lines.remove(0);
    run.channels = vec![channel(OrderLines {
        variance: vec![NOISE * NOISE; shown.amplitude.len()],
        ..shown
    })];
    run
}

fn fitted(runs: Vec<Observation>, relation: Relation, held_out: &[&str]) -> (Fit, Transfer) {
    let mut tree = nominal();
    let settings = runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::in_runs(&tree, settings).unwrap();
    assert_eq!(joints.len(), 1);
    assert_eq!(joints[0].clearance, 1e-4);
    relation.set(&mut tree, &joints).unwrap();
    let mut parameters = vec![
        Parameter::at(&tree, STIFFNESS).unwrap(),
        Parameter::at(&tree, DAMPING).unwrap(),
    ];
    if relation == Relation::Fitted {
        parameters.extend(exponents(&tree).unwrap());
    }
    let problem = Problem {
        tree,
        parameters,
        runs,
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    let settings = FitSettings {
        optimiser: Optimiser::LevenbergMarquardt,
        seed: 0,
        evaluations: 200,
        held_out: held_out.iter().map(|id| (*id).to_owned()).collect(),
        start: None,
    };
    let fit = calibrate(&problem, &settings, |_| ControlFlow::Continue(())).unwrap();
    let transfer = transfer(&problem, &fit, |_| ControlFlow::Continue(()))
        .unwrap()
        .unwrap();
    (fit, transfer)
}

fn hypothesis(transfer: &Transfer, relation: Relation) -> &Hypothesis {
    let mut all = transfer.relations.iter();
    all.find(|h| h.relation == relation).unwrap()
}

#[test]
fn two_clearances_tell_the_exponents() {
    let truth = truth(-0.4);
    let runs = vec![
        recording(&truth, "wide", "500 rpm", "0.3 mm"),
        recording(&truth, "normal", "500 rpm", "0.1 mm"),
    ];
    let (fit, transfer) = fitted(runs, Relation::Fitted, &[]);
    let found: Vec<(&str, f64)> = fit
        .estimates
        .iter()
        .map(|e| (e.parameter.path.as_str(), e.value))
        .collect();
    let expected: [(&str, f64); 4] = [
        (STIFFNESS, 15e9),
        (DAMPING, 26e3),
        ("joints.*.contact.relation.stiffness", 0.0),
        ("joints.*.contact.relation.damping", -0.4),
    ];
    for ((path, value), (expected_path, expected)) in found.into_iter().zip(expected) {
        assert_eq!(path, expected_path);
        let within = 1e-3 * f64::max(expected.abs(), 1.0);
        assert!((value - expected).abs() < within, "{path}: {value}");
    }
    assert_eq!(transfer.decision.runs, Basis::Fitted);
    assert_eq!(transfer.decision.relations, [Relation::Fitted]);
    let by_data = hypothesis(&transfer, Relation::Fitted);
    assert!(by_data.fitted < 0.1, "{by_data:?}");
    for (path, exponent) in &by_data.exponents {
        let expected = if path.contains("damping") { -0.4 } else { 0.0 };
        assert!((exponent.value - expected).abs() < 1e-3, "{exponent:?}");
        assert!(exponent.low < expected && exponent.high > expected);
    }
    // Eq. (5) is nearer to the truth than a constant, and the conformal stiffness far from it.
    let [eq5, constant, conformal] = [Relation::Equation5, Relation::Constant, Relation::Conformal]
        .map(|relation| hypothesis(&transfer, relation).fitted);
    assert!(
        eq5 > 1.0 && eq5 < constant && eq5 < conformal,
        "{transfer:?}"
    );
}

#[test]
fn one_clearance_leaves_the_relation_open() {
    let truth = truth(-0.2);
    let runs = vec![recording(&truth, "normal", "500 rpm", "0.1 mm")];
    let (fit, transfer) = fitted(runs, Relation::Fitted, &[]);
    let exponents = &fit.estimates[2..];
    for (exponent, nominal) in exponents.iter().zip([0.0, -0.2]) {
        assert_eq!((exponent.value, exponent.interval), (nominal, None));
    }
    assert!(fit.estimates[..2].iter().all(|e| e.interval.is_some()));
    assert_eq!(transfer.decision.runs, Basis::None);
    assert_eq!(transfer.decision.relations, []);
    // Three predictions of the small end at 0.3 mm, of which that by Eq. (5) holds the truth: its
    // damping is that of this machine but for 0.1 %, its stiffness but for 0.2 %.
    assert_eq!(transfer.predictions.len(), 3);
    let run = recording(&truth, "wide", "500 rpm", "0.3 mm");
    let lines = &run.channels[0].lines.amplitude;
    let squares: f64 = lines[1..].iter().map(|c| 0.5 * c.norm_sqr()).sum();
    for prediction in &transfer.predictions {
        let joint = "joints.small_end";
        assert!((prediction.clearance_m[joint] / 3e-4 - 1.0).abs() < 1e-9);
        let shown = &prediction.channels[COLUMN];
        assert!(!prediction.recorded && shown.difference.is_none());
        let [low, high] = [shown.rms.low, shown.rms.high];
        assert!(low < shown.rms.value && shown.rms.value < high);
        let apart = (shown.rms.value / squares.sqrt() - 1.0).abs();
        if prediction.relation == Relation::Equation5 {
            assert!(apart < 2e-4, "{apart}");
        }
    }
}

#[test]
fn held_out_runs_of_another_clearance_decide_where_the_fitted_ones_cannot() {
    let truth = truth(-0.2);
    let runs = vec![
        recording(&truth, "normal", "500 rpm", "0.1 mm"),
        recording(&truth, "wide", "500 rpm", "0.3 mm"),
    ];
    let (_, transfer) = fitted(runs, Relation::Constant, &["wide"]);
    assert_eq!(transfer.decision.runs, Basis::HeldOut);
    assert_eq!(transfer.decision.relations, [Relation::Equation5]);
    let recorded: Vec<_> = transfer.predictions.iter().filter(|p| p.recorded).collect();
    assert_eq!(recorded.len(), 3);
    for prediction in recorded {
        let hypothesis = hypothesis(&transfer, prediction.relation);
        assert_eq!(prediction.misfit, hypothesis.held_out);
        let shown = &prediction.channels[COLUMN];
        let difference = shown.difference.unwrap();
        let near = prediction.relation == Relation::Equation5;
        assert_eq!(difference < 1e-2, near, "{prediction:?}");
    }
}
