//! The default search out of a local minimum of all runs together.

use calibrate::fit::{FitSettings, Optimiser};
use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem, calibrate};
use mechanism::drive::GivenSpeed;
use serde_json::json;
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

/// Of the small end's contact and of a misalignment, with their true values over, or less, those with which the
/// search begins.
const TRUTH: [(&str, f64); 7] = [
    ("joints.small_end.contact.stiffness", -0.34),
    ("joints.small_end.contact.damping", -0.13),
    ("joints.small_end.friction.coefficient", 0.065),
    ("effects.misalignment.first", -0.25),
    ("effects.misalignment.first_phase", 0.175),
    ("effects.misalignment.second", 0.265),
    ("effects.misalignment.second_phase", -0.14),
];
const RPM: [f64; 3] = [350.0, 500.0, 650.0];
/// Variance of a line, (m/s²)²: of 30 revolutions with noise of some 5 % of the acceleration.
const VARIANCE: f64 = 2e-3;

/// A machine whose forces on the crosshead move the impacts of its small end, and what it shows itself.
fn problem() -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let mut tree = input::machine_file::read(&path).unwrap().to_tree().clone();
    tree["joints"]["big_end"]["clearance"] = json!("ideal");
    tree["joints"]["small_end"]["clearance"] = json!("0.1 mm");
    tree["effects"] = json!([{"misalignment": {
        "first": "700 N", "first_phase": "3.2 rad", "second": "450 N", "second_phase": "2.1 rad",
    }}]);
    let of = |(path, _): &(&str, f64)| Parameter::of(&tree, path).unwrap();
    let mut problem = Problem {
        parameters: TRUTH.iter().map(of).collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    let observed = |lines| Observed {
        column: "crosshead_acceleration_m_s2".into(),
        lines,
        orders: (1..=200).collect(),
    };
    for rpm in RPM {
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
        let shown = predict(&problem, &run, &TRUTH.map(|(_, x)| x)).unwrap();
        assert!(shown.periodic);
        let lines = shown.lines.into_iter().next().unwrap();
        run.channels = vec![observed(OrderLines {
            variance: vec![VARIANCE; lines.amplitude.len()],
            revolutions: 30,
            ..lines
        })];
        problem.runs.push(run);
    }
    problem
}

#[test]
fn parts_of_the_runs_lead_to_where_all_agree() {
    let problem = problem();
    let fitted = |optimiser| {
        let settings = FitSettings {
            optimiser,
            seed: 0,
            evaluations: 400,
            held_out: Vec::new(),
            start: None,
        };
        calibrate(&problem, &settings, |_| ControlFlow::Continue(())).unwrap()
    };
    let misfits =
        |fit: &calibrate::Fit| -> Vec<f64> { fit.runs.iter().map(|run| run.calibrated).collect() };
    let descent = misfits(&fitted(Optimiser::LevenbergMarquardt));
    assert!(descent.iter().all(|m| *m > 3.0), "{descent:.2?}");
    let search = misfits(&fitted(Optimiser::Default));
    assert!(search.iter().all(|m| *m < 0.5), "{search:.2?}");
}
