//! The default search out of a local minimum of all runs together.

use crate::own_recordings;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::{Problem, calibrate};
use serde_json::json;
use std::ops::ControlFlow;

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
    let mut tree = own_recordings::machine(["ideal", "0.1 mm"]);
    tree["effects"] = json!([{"misalignment": {
        "first": "700 N", "first_phase": "3.2 rad", "second": "450 N", "second_phase": "2.1 rad",
    }}]);
    own_recordings::problem(tree, &TRUTH, &RPM, 200, VARIANCE)
}

#[test]
#[ignore = "minutes: tests/nightly/run calibrations"]
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
