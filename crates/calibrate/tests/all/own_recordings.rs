//! Problems whose recordings the model itself has made, without noise.

use calibrate::meter::Meter;
use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use mechanism::drive::GivenSpeed;
use serde_json::{Value, json};
use signal::Complex64;
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
    let of = |(path, _): &(&str, f64)| Parameter::at(&tree, path).unwrap();
    let mut problem = Problem {
        parameters: truth.iter().map(of).collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    };
    let truth: Vec<f64> = truth.iter().map(|(_, x)| *x).collect();
    let observed = |lines| Observed {
        scatter: Vec::new(),
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
            warm_start: None,
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

/// The acceleration of the crosshead of a machine at 500 rpm whose motion does not repeat itself: means over 24 revolutions, and
/// their scatter.
pub fn scattering(tree: Value) -> Problem {
    let mut problem = problem(tree, &[], &[], 0, 0.0);
    let channel = |lines, orders| Observed {
        scatter: Vec::new(),
        column: "crosshead_acceleration_m_s2".into(),
        lines,
        orders,
    };
    let scattering = OrderLines {
        amplitude: vec![Complex64::ONE; 2],
        variance: vec![1.0; 2],
        revolutions: 24,
    };
    let mut run = Observation {
        id: "500 rpm".into(),
        settings: vec![("speed".to_owned(), json!("500 rpm"))],
        crank: GivenSpeed {
            speed: 500.0 * PI / 30.0,
            fluctuation: Vec::new(),
        },
        channels: vec![channel(scattering, vec![1])],
        warm_start: None,
    };
    let shown = predict(&problem, &run, &[]).unwrap();
    assert!(!shown.periodic);
    let lines = shown.lines.into_iter().next().unwrap();
    run.channels = vec![channel(lines, (1..=200).collect())];
    problem.runs.push(run);
    problem
}
