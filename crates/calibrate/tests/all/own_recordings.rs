//! Problems whose recordings the model itself has made, without noise.

use calibrate::meter::Meter;
use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use mechanism::drive::GivenSpeed;
use serde_json::{Value, json};
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::path::Path;

/// The tree of the single-stage machine with these clearances of the big end and the small end.
pub fn machine(clearances: [&str; 2]) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let mut tree = input::machine_file::read(&path).unwrap().to_tree().clone();
    for (joint, clearance) in ["big_end", "small_end"].into_iter().zip(clearances) {
        tree["joints"][joint]["clearance"] = json!(clearance);
    }
    tree
}

/// The acceleration of the crosshead in a run at each speed, in orders up to `highest` whose lines have
/// the `variance`, (m/s²)², of the machine at the true coordinates of its parameters.
pub fn problem(
    tree: Value,
    truth: &[(&str, f64)],
    rpm: &[f64],
    highest: usize,
    variance: f64,
) -> Problem {
    let of = |(path, _): &(&str, f64)| Parameter::of(&tree, path).unwrap();
    let mut problem = Problem {
        parameters: truth.iter().map(of).collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    };
    let truth: Vec<f64> = truth.iter().map(|(_, x)| *x).collect();
    let observed = |lines| Observed {
        column: "crosshead_acceleration_m_s2".into(),
        lines,
        orders: (1..=highest).collect(),
    };
    for rpm in rpm {
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
        let shown = predict(&problem, &run, &truth).unwrap();
        assert!(shown.periodic);
        let lines = shown.lines.into_iter().next().unwrap();
        run.channels = vec![observed(OrderLines {
            variance: vec![variance; lines.amplitude.len()],
            revolutions: 30,
            ..lines
        })];
        problem.runs.push(run);
    }
    problem
}
