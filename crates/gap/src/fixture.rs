//! A problem whose recordings are simulated here, for tests.

use crate::fitter::Fitter;
use crate::fitter::effort::Effort;
use crate::fitter::journal::Journal;
use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use serde_json::{Value, json};
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

/// A fitter that is never stopped and reports nothing.
pub(crate) fn fitter(effort: &Effort) -> Fitter<'_> {
    Fitter {
        effort,
        watch: &|| ControlFlow::Continue(()),
        say: &|_, _| (),
    }
}

/// All runs of a problem fitted to, with few evaluations.
pub(crate) fn effort() -> Effort {
    Effort {
        held_out: Vec::new(),
        evaluations: 40,
        chaotic: false,
        journal: Journal::default(),
    }
}

/// The single-stage machine with a loose crosshead pin, and what it shows with a friction of 150 N.
pub(crate) fn problem() -> Problem {
    problem_of(json!([{"empirical_force": {"velocity_sign": "-150 N"}}]))
}

/// The same machine, and what it shows with these effects.
pub(crate) fn problem_of(effects: Value) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let machine = input::machine_file::read(&path).unwrap();
    let mut tree = machine.to_tree().clone();
    tree["joints"]["big_end"]["clearance"] = json!("ideal");
    tree["joints"]["small_end"]["clearance"] = json!("0.1 mm");
    let stiffness = Parameter::at(&tree, "joints.small_end.contact.stiffness").unwrap();
    let mut problem = Problem {
        parameters: vec![stiffness],
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    let mut truth = problem.clone();
    truth.tree["effects"] = effects;
    for rpm in [400.0, 560.0] {
        let observed = |lines| Observed {
            scatter: Vec::new(),
            column: "crosshead_acceleration_m_s2".into(),
            lines,
            orders: (1..=50).collect(),
        };
        let mut run = Observation {
            id: format!("{rpm} rpm"),
            settings: vec![("speed".to_owned(), json!(format!("{rpm} rpm")))],
            crank: mechanism::drive::GivenSpeed {
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
        let shown = predict(&truth, &run, &[0.0]).unwrap();
        let lines = shown.lines.into_iter().next().unwrap();
        run.channels = vec![observed(OrderLines {
            variance: vec![0.02; lines.amplitude.len()],
            revolutions: 30,
            ..lines
        })];
        problem.runs.push(run);
    }
    problem
}
