//! An evaluation with derivatives counts for as many plain ones as it takes steps of the integrator.

use calibrate::likelihood::Likelihood;
use calibrate::observation::Observed;
use calibrate::optimiser::{LeastSquares, derivatives};
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use mechanism::drive::GivenSpeed;
use serde_json::json;
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::path::Path;

const RPM: [f64; 3] = [400.0, 480.0, 560.0];
const PATHS: [&str; 12] = [
    "joints.big_end.contact.stiffness",
    "joints.big_end.contact.damping",
    "joints.big_end.friction.coefficient",
    "joints.small_end.contact.stiffness",
    "joints.small_end.contact.damping",
    "joints.small_end.friction.coefficient",
    "crosshead.mass",
    "rod.mass",
    "cylinder.exponent",
    "cylinder.head_clearance",
    "cylinder.suction",
    "cylinder.discharge",
];

/// The single-stage machine with two clear joints, so many of its parameters, and what it shows itself.
fn problem(parameters: usize) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let machine = input::machine_file::read(&path).unwrap();
    let mut tree = machine.to_tree().clone();
    for joint in ["big_end", "small_end"] {
        tree["joints"][joint]["clearance"] = json!("0.1 mm");
    }
    let of = |path: &&str| Parameter::of(&tree, path).unwrap();
    let mut problem = Problem {
        parameters: PATHS[..parameters].iter().map(of).collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    for rpm in RPM {
        let observed = |lines| Observed {
            column: "crosshead_acceleration_m_s2".into(),
            lines,
            orders: (1..=50).collect(),
        };
        let mut run = Observation {
            id: format!("{rpm} rpm"),
            settings: vec![("speed".to_owned(), json!(format!("{rpm} rpm")))],
            crank: GivenSpeed {
                speed: rpm * PI / 30.0,
                fluctuation: Vec::new(),
            },
            channels: vec![observed(OrderLines {
                amplitude: Vec::new(),
                variance: Vec::new(),
                revolutions: 30,
            })],
        };
        let shown = predict(&problem, &run, &vec![0.0; parameters]).unwrap();
        assert!(shown.periodic);
        let lines = shown.lines.into_iter().next().unwrap();
        run.channels = vec![observed(OrderLines {
            variance: vec![1e-4; lines.amplitude.len()],
            revolutions: 30,
            ..lines
        })];
        problem.runs.push(run);
    }
    problem
}

#[test]
fn derivatives_count_for_what_they_cost() {
    for parameters in [3, 6, 8, 12] {
        let problem = problem(parameters).metered();
        let likelihood = Likelihood::new(&problem);
        let at = vec![0.0; parameters];
        likelihood.residuals(&at);
        let plain = problem.meter.steps();
        likelihood.jacobian(&at);
        let cost = (problem.meter.steps() - plain) as f64 / plain as f64;
        let counted = derivatives(parameters) as f64;
        assert!(
            (0.75..1.33).contains(&(cost / counted)),
            "{parameters} parameters cost {cost:.2} evaluations and count for {counted}"
        );
    }
}
