//! An evaluation with derivatives counts for as many plain ones as it takes steps of the integrator.

use crate::own_recordings;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::{LeastSquares, derivatives};

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
    let truth: Vec<(&str, f64)> = PATHS[..parameters]
        .iter()
        .map(|path| (*path, 0.0))
        .collect();
    own_recordings::problem(
        own_recordings::machine(["0.1 mm"; 2]),
        &truth,
        &RPM,
        50,
        1e-4,
    )
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
            (0.75..1.4).contains(&(cost / counted)),
            "{parameters} parameters cost {cost:.2} evaluations and count for {counted}"
        );
    }
}
