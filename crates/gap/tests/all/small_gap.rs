//! Small effects in pressures alone: a gap between the noise and twice of it is looked into like any other.

use crate::gas::{NOISE, explained_of, machine, problem, runs};
use calibrate::Observation;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::optimiser::LeastSquares;
use gap::Verdict;
use input::effects::entry;
use serde_json::json;
use std::f64::consts::TAU;

/// Loss coefficient that is scaled down.
const LOSS: f64 = 0.02;

/// Adds noise of the stated variance to the lines.
fn with_noise(mut runs: [Observation; 4]) -> [Observation; 4] {
    let mut state = 11_u64;
    // Uniform from 0 to 1, by a linear congruential generator (Knuth's MMIX).
    let mut uniform = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let channels = runs.iter_mut().flat_map(|run| &mut run.channels);
    for line in channels.flat_map(|channel| &mut channel.lines.amplitude) {
        // Box and Muller: a complex normal number of mean square NOISE².
        let size = NOISE * (-uniform().ln()).sqrt();
        let (sine, cosine) = (TAU * uniform()).sin_cos();
        line.re += size * cosine;
        line.im += size * sine;
    }
    runs
}

/// The effect of a valve loss of so much.
fn loss(coefficient: f64) -> serde_json::Value {
    let entry = entry("valve_loss").unwrap();
    json!([entry.item(&[], &[coefficient, coefficient])])
}

fn is_explained(gap: f64) {
    // What the effect leaves by itself grows in proportion to it.
    let without_noise = problem(machine(), runs(&loss(LOSS)).to_vec());
    let alone = misfit(&Likelihood::new(&without_noise).residuals(&[0.0]));
    let coefficient = LOSS * (gap * gap - 1.0).sqrt() / alone;
    let problem = problem(machine(), with_noise(runs(&loss(coefficient))).to_vec());
    let explanation = explained_of(&problem);
    let before = explanation.baseline.fitted;
    assert!((1.25..1.85).contains(&before), "{gap}: {before}");
    let found: Vec<String> = explanation
        .found
        .iter()
        .map(|found| found.candidate().label())
        .collect();
    let tried: Vec<(String, f64)> = explanation
        .refused
        .iter()
        .map(|tried| (tried.candidate.label(), tried.probability))
        .collect();
    assert_eq!(found, ["valve_loss"], "{gap}, {before}: {tried:?}");
    assert_eq!(explanation.verdict, Verdict::Explained);
}

#[test]
#[ignore = "minutes: tests/nightly/run pressures"]
fn a_gap_of_1_4_times_the_noise_is_explained() {
    is_explained(1.4);
}

#[test]
#[ignore = "minutes: tests/nightly/run pressures"]
fn a_gap_of_1_75_times_the_noise_is_explained() {
    is_explained(1.75);
}

#[test]
fn noise_alone_is_no_gap() {
    let problem = problem(machine(), with_noise(runs(&json!([]))).to_vec());
    let explanation = explained_of(&problem);
    assert_eq!(explanation.verdict, Verdict::NoGap);
    assert!((0.85..1.15).contains(&explanation.baseline.fitted));
    assert!(explanation.found.is_empty());
}
