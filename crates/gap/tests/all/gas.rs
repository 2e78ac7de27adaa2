//! Effects of the gas, hidden in pressures without a recording's noise, are named again.

use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use gap::{Effort, Verdict, explain};
use input::effects::entry;
use mechanism::drive::GivenSpeed;
use serde_json::{Value, json};
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

const COLUMN: &str = "cylinder_pressure_pa";
const ORDERS: usize = 60;
/// Standard deviation of a line's noise, Pa: a thousandth of the swing.
pub(crate) const NOISE: f64 = 200.0;

/// The single-stage machine with ideal joints.
pub(crate) fn machine() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let machine = input::machine_file::read(&path).unwrap();
    let mut tree = machine.to_tree().clone();
    tree["effects"] = json!([]);
    for joint in ["big_end", "small_end"] {
        tree["joints"][joint]["clearance"] = json!("ideal");
    }
    tree
}

pub(crate) fn problem(tree: Value, runs: Vec<Observation>) -> Problem {
    let offset = Parameter::named(&tree, &[], CRANK_ANGLE_OFFSET, None).unwrap();
    Problem {
        tree,
        parameters: vec![offset],
        runs,
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    }
}

/// What the machine with these effects shows at a speed and a discharge pressure.
pub(crate) fn recorded(effects: &Value, id: &str, rpm: f64, discharge: &str) -> Observation {
    let observed = |lines| Observed {
        scatter: Vec::new(),
        column: COLUMN.into(),
        lines,
        orders: (0..=ORDERS).collect(),
    };
    let mut run = Observation {
        id: id.into(),
        settings: vec![
            ("speed".to_owned(), json!(format!("{rpm} rpm"))),
            ("cylinder.discharge".to_owned(), json!(discharge)),
        ],
        crank: GivenSpeed {
            speed: rpm * PI / 30.0,
            fluctuation: Vec::new(),
        },
        channels: vec![observed(OrderLines {
            amplitude: Vec::new(),
            variance: Vec::new(),
            revolutions: 30,
        })],
        warm_start: None,
    };
    let mut tree = machine();
    tree["effects"] = effects.clone();
    let shown = predict(&problem(tree, Vec::new()), &run, &[0.0]).unwrap();
    let lines = shown.lines.into_iter().next().unwrap();
    run.channels = vec![observed(OrderLines {
        variance: vec![NOISE * NOISE; lines.amplitude.len()],
        revolutions: 30,
        ..lines
    })];
    run
}

fn explained(effects: &Value) -> gap::Explanation {
    let runs = runs(effects);
    explained_of(&problem(machine(), runs.to_vec()))
}

/// What the machine with these effects shows at several speeds and loads.
pub(crate) fn runs(effects: &Value) -> [Observation; 4] {
    let runs = [
        ("a", 400.0, "0.4 MPa"),
        ("b", 600.0, "0.4 MPa"),
        ("c", 500.0, "0.5 MPa"),
        ("d", 550.0, "0.45 MPa"),
    ];
    runs.map(|(id, rpm, discharge)| recorded(effects, id, rpm, discharge))
}

/// The explanation of a problem whose run `d` is held out.
pub(crate) fn explained_of(problem: &Problem) -> gap::Explanation {
    let effort = Effort {
        held_out: vec!["d".into()],
        evaluations: 120,
        chaotic: false,
        journal: gap::Journal::default(),
    };
    explain(problem, None, &[], &effort, &|_| (), &|| {
        ControlFlow::Continue(())
    })
    .unwrap()
}

#[test]
fn nothing_hidden_is_no_gap() {
    let found = explained(&json!([]));
    assert_eq!(found.verdict, Verdict::NoGap);
    assert!(found.found.is_empty() && found.chain.is_empty());
}

#[test]
fn a_valve_loss_is_named_with_its_coefficients() {
    let entry = entry("valve_loss").unwrap();
    let found = explained(&json!([entry.item(&[], &[0.12, 0.2])]));
    assert_eq!(found.verdict, Verdict::Explained);
    let names: Vec<_> = found.found.iter().map(|f| f.candidate().label()).collect();
    assert_eq!(names, ["valve_loss"]);
    for (value, truth) in found.found[0].effect.values.iter().zip([0.12, 0.2]) {
        assert!((value / truth - 1.0).abs() < 0.01, "{value}");
    }
    assert!(found.explained.held_out.unwrap() < 0.1);
}

#[test]
fn an_encoder_that_is_set_wrong_is_reported_as_such() {
    let entry = entry("crank_angle_offset").unwrap();
    let found = explained(&json!([entry.item(&[], &[0.03])]));
    assert_eq!(found.verdict, Verdict::Explained);
    assert!(found.found.is_empty());
    let names: Vec<_> = found.chain.iter().map(|f| f.candidate().label()).collect();
    assert_eq!(names, ["crank_angle_offset"]);
    assert!((found.chain[0].effect.values[0] - 0.03).abs() < 1e-4);
    assert!(found.baseline.fitted > 5.0 * found.explained.fitted);
}

/// What is named where an effect of this name has these values, and what it leaves of the fitted and the held-out runs.
fn named(name: &str, values: &[f64]) -> (Vec<String>, [f64; 2]) {
    let item = entry(name).unwrap().item(&[], values);
    let found = explained(&json!([item]));
    let labels = found.found.iter().map(|f| f.candidate().label());
    let left = [found.explained.fitted, found.explained.held_out.unwrap()];
    (labels.collect(), left)
}

#[test]
#[ignore = "minutes: tests/nightly/run pressures"]
fn valves_that_overshoot_where_they_open_are_no_other_effect() {
    let (labels, left) = named("valve_loss", &[0.06, 0.05, 0.04, 0.03, 0.12, 0.1, 0.26]);
    assert_eq!(labels, ["valve_loss"]);
    assert!(left.iter().all(|left| *left < 1.0), "{left:?}");
}
