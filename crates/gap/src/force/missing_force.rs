//! The force that is missing over a revolution, as far as it is identifiable from the recordings.
//!
//! With clearance in the joints a force on the crosshead is not seen as mass × acceleration: the contacts
//! change it. The force is taken from a machine that was fitted with all terms of the effect
//! `empirical_force`.

use crate::error::Error;
use calibrate::Problem;
use calibrate::observation::Observation;
use serde::{Deserialize, Serialize};
use simulate::{Settings, ThrowTrace, Transient, simulate};
use std::f64::consts::TAU;

/// Crank angles at which the force is given, equally spaced from top dead centre of the shaft's first
/// throw on.
pub const ANGLES: usize = 72;

/// The force of all effects on a crosshead in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissingForce {
    /// The run.
    pub run: String,
    /// The throw; empty where the machine has one that has no name.
    pub throw: String,
    /// Toward the head, N, at 72 equally spaced crank angles from top dead centre of the shaft's first throw on.
    pub force: Vec<f64>,
}

/// The force of the effects of a problem's machine at the coordinates `x` over a revolution of each of these runs.
///
/// # Errors
/// A machine that cannot be simulated.
pub(crate) fn missing_force(
    problem: &Problem,
    x: &[f64],
    runs: &[Observation],
) -> Result<Vec<MissingForce>, Error> {
    let each = runs.iter().map(|run| of_run(problem, x, run));
    Ok(each.collect::<Result<Vec<_>, Error>>()?.concat())
}

fn of_run(problem: &Problem, x: &[f64], run: &Observation) -> Result<Vec<MissingForce>, Error> {
    let machine = problem.machine(run, x)?;
    let settings = Settings {
        transient: Transient::Revolutions(10),
        revolutions: 1,
        sample_rate: 4.0 * ANGLES as f64 * run.crank.speed / TAU,
        ..Settings::default()
    };
    let record = simulate(&machine.machine, &[], &settings, true).map_err(|source| {
        calibrate::Error::Simulation {
            run: run.id.clone(),
            source,
        }
    })?;
    let Some(trace) = record.trace else {
        return Ok(Vec::new());
    };
    let names = machine.machine.throws.iter().map(|throw| &throw.name);
    let of = |(name, motion): (&String, &ThrowTrace)| MissingForce {
        run: run.id.clone(),
        throw: name.clone(),
        force: by_angle(&trace.crank_angle, &motion.effects),
    };
    Ok(names.zip(&trace.throws).map(of).collect())
}

/// Means of samples about [`ANGLES`] equally spaced angles.
fn by_angle(angles: &[f64], samples: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0_u32); ANGLES];
    for (angle, sample) in angles.iter().zip(samples) {
        let nearest = (angle / TAU * ANGLES as f64).round() as usize % ANGLES;
        sums[nearest].0 += sample;
        sums[nearest].1 += 1;
    }
    let mean = |(sum, count)| sum / f64::from(u32::max(count, 1));
    sums.into_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_found_where_it_acts() {
        let angles: Vec<f64> = (0..720).map(|i| f64::from(i) * TAU / 720.0).collect();
        let force: Vec<f64> = angles.iter().map(|a| 100.0 * a.sin()).collect();
        let found = by_angle(&angles, &force);
        assert_eq!(found.len(), ANGLES);
        for (i, force) in found.iter().enumerate() {
            let expected = 100.0 * (i as f64 * TAU / 72.0).sin();
            assert!((force - expected).abs() < 0.6, "{i}: {force} {expected}");
        }
    }
}
