//! Periodic motions, found by shooting: Newton's method on the map from a state to the one a period
//! later. The derivative of the map, the monodromy matrix, comes from tangents in every direction. Its
//! eigenvalues are the Floquet multipliers: what a small disturbance is multiplied by in a period
//! (Nayfeh and Balachandran 1995, sections 3.2 and 6.5).
//!
//! With a free crank the period is unknown too. The crank angle at the start is held in its place,
//! and must have grown by whole turns at the end. A shift along the orbit then neither grows nor
//! fades: the multiplier 1 that belongs to it is left out.

use crate::error::Error;
use crate::flow::Flow;
use crate::tangents::Tangents;
use nalgebra::{Complex, DMatrix, DVector, Schur};
use std::f64::consts::TAU;

/// Newton steps before a search is given up.
const STEPS: usize = 8;
/// Distance, in scales (clearances), that counts as none: what the integration leaves.
const SAME: f64 = 1e-6;
/// Distance from the start beyond which a search has lost its orbit.
const ASTRAY: f64 = 0.3;
/// Rounds of the eigenvalue iteration.
const ROUNDS: usize = 1000;

/// A periodic motion.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicOrbit {
    /// Revolutions after which it repeats.
    pub revolutions: u32,
    /// How long they take, s.
    pub period: f64,
    /// Floquet multipliers, the largest modulus first; without the 1 of a free crank.
    pub multipliers: Vec<Complex<f64>>,
    /// True where nothing dictates the crank angle.
    pub free: bool,
}

impl PeriodicOrbit {
    /// Modulus of the largest multiplier: the orbit is stable where it is below 1.
    pub fn largest_modulus(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |m| m.norm())
    }

    /// The largest Lyapunov exponent that belongs to the multipliers, 1/s.
    pub fn exponent(&self) -> f64 {
        let contraction = self.largest_modulus().ln() / self.period;
        if self.free {
            contraction.max(0.0)
        } else {
            contraction
        }
    }
}

/// A point of a periodic orbit.
pub(crate) struct Found {
    pub orbit: PeriodicOrbit,
    /// Distance of the point from where the search began, in scales.
    pub distance: f64,
}

/// The orbit of `revolutions` revolutions nearest to where `start` stands, with the mode that
/// `start` is in; `None` where there is none in reach.
///
/// # Errors
/// Where the integration cannot meet its tolerance.
pub(crate) fn shoot<F: Flow, const N: usize>(
    start: &mut Tangents<F, N>,
    revolutions: u32,
) -> Result<Option<Found>, Error> {
    let cycle = start.cycle();
    let from = start.point();
    let mut point = from.clone();
    let mut period = f64::from(revolutions) * cycle.length();
    for _ in 0..STEPS {
        let mut tangents = start.everywhere(&point);
        tangents.advance(start.time() + period, |_, _| ())?;
        let (end, monodromy) = (tangents.point(), tangents.matrix());
        if end.len() != point.len() || !monodromy.iter().all(|x| x.is_finite()) {
            return Ok(None);
        }
        // What a contact that never opens remembers keeps its value: a parameter.
        let live: Vec<usize> = (0..point.len())
            .filter(|&i| i < start.scales().len() || !keeps(&monodromy, i))
            .collect();
        let monodromy = monodromy.select_rows(&live).select_columns(&live);
        let mut missing = (&point - end).select_rows(&live);
        let mut matrix = monodromy.clone() - DMatrix::identity(live.len(), live.len());
        if let Some(i) = cycle.free {
            let scale = tangents.scales()[i];
            let turned = cycle.rate * period - cycle.rate.signum() * TAU * f64::from(revolutions);
            missing[i] -= turned / scale;
            // In place of the angle's start its column has the period.
            let mut rate = tangents.rate();
            rate[i] += cycle.rate / scale;
            matrix.set_column(i, &rate.select_rows(&live));
        }
        let Some(mut change) = matrix.lu().solve(&missing) else {
            return Ok(None);
        };
        if let Some(i) = cycle.free {
            period += change[i];
            change[i] = 0.0;
        }
        for (&i, change) in live.iter().zip(&change) {
            point[i] += change;
        }
        let distance = (&point - &from).amax();
        if distance > ASTRAY || !distance.is_finite() {
            return Ok(None);
        }
        if change.amax() < SAME && missing.amax() < SAME {
            let multipliers = multipliers(monodromy, cycle.free.is_some());
            return Ok(multipliers.map(|multipliers| Found {
                orbit: PeriodicOrbit {
                    revolutions,
                    period,
                    multipliers,
                    free: cycle.free.is_some(),
                },
                distance,
            }));
        }
    }
    Ok(None)
}

/// True where component `i` depends on its own start alone, and is the same.
pub(crate) fn keeps(monodromy: &DMatrix<f64>, i: usize) -> bool {
    let row = monodromy.row(i);
    row.iter()
        .enumerate()
        .all(|(j, x)| *x == f64::from(u8::from(i == j)))
}

/// Eigenvalues of the monodromy matrix, the largest modulus first; without the one nearest to 1
/// for a free cycle.
fn multipliers(monodromy: DMatrix<f64>, free: bool) -> Option<Vec<Complex<f64>>> {
    let schur = Schur::try_new(monodromy, f64::EPSILON, ROUNDS)?;
    let eigenvalues: DVector<Complex<f64>> = schur.complex_eigenvalues();
    let mut values: Vec<_> = eigenvalues.iter().copied().collect();
    if free {
        let off = |m: &Complex<f64>| (m - Complex::new(1.0, 0.0)).norm();
        values.sort_by(|a, b| off(a).total_cmp(&off(b)));
        values.remove(0);
    }
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im)));
    Some(values)
}
