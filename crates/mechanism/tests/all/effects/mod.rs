//! Each effect of the catalogue against what its law says in closed form, or by quadrature.

mod frame;
mod gas;
mod joint;
mod running_gear;

use crate::common::{REVOLUTION, Run, single_stage};
use mechanism::effects::Law;
use mechanism::{Evaluation, Machine};
use std::f64::consts::TAU;

const PS: f64 = 0.105e6;
const PD: f64 = 0.393e6;
const M: f64 = 1.4;
const DEAD: f64 = 0.024;
const STROKE: f64 = 0.24;
const RADIUS: f64 = 0.12;
const LENGTH: f64 = 0.6;
const PISTON: f64 = 0.05;

/// The ideal single-stage machine with an effect.
fn ideal(law: Law) -> Machine {
    Machine {
        effects: vec![law.everywhere()],
        ..single_stage()
    }
}

/// What `look` finds at crank angles (degrees) that follow each other from the start on.
fn at_angles<T>(
    machine: Machine,
    degrees: &[f64],
    mut look: impl FnMut(&Evaluation<f64>) -> T,
) -> Vec<T> {
    let mut run = Run::start(machine, 1e-11, true);
    let each = degrees.iter().map(|degrees| {
        run.advance(degrees / 360.0 * REVOLUTION);
        look(run.now())
    });
    each.collect()
}

fn pressure(at: &Evaluation<f64>) -> f64 {
    at.throws[0].gas.head_end.pressure
}

/// Distance of the ideal piston from the head, m.
fn distance(angle: f64) -> f64 {
    let rod = (LENGTH * LENGTH - (RADIUS * angle.sin()).powi(2)).sqrt();
    DEAD + RADIUS + LENGTH - RADIUS * angle.cos() - rod
}

/// Speed of the ideal piston away from the head, over the crank pin's.
fn speed(angle: f64) -> f64 {
    let ratio = RADIUS / LENGTH;
    let rod = (1.0 - (ratio * angle.sin()).powi(2)).sqrt();
    angle.sin() + ratio * angle.sin() * angle.cos() / rod
}

fn near(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{found} against {expected}, {off:.1e}");
}

/// Cosine and sine part of order `k` of samples over one revolution.
fn order(samples: &[f64], k: f64) -> [f64; 2] {
    let n = samples.len() as f64;
    let mut parts = [0.0; 2];
    for (i, x) in samples.iter().enumerate() {
        let (sine, cosine) = (TAU * k * i as f64 / n).sin_cos();
        parts[0] += 2.0 / n * x * cosine;
        parts[1] += 2.0 / n * x * sine;
    }
    parts
}

fn size(parts: [f64; 2]) -> f64 {
    parts[0].hypot(parts[1])
}

/// Angles of the second revolution, degrees.
fn revolution(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| 360.0 + 360.0 * i as f64 / count as f64)
        .collect()
}
