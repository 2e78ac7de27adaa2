//! The combined rod load at the crosshead pin, and its reversal (API 618).
//!
//! API Standard 618, 5th edition: the combined rod load is the sum of the gas load, with the pressures in
//! the cylinder, and the inertia load of all reciprocating masses at the crosshead pin, in the direction
//! of the piston rod. Paragraph 6.6.4: for the pin to be lubricated, it must reverse in every turn of the
//! crank, for at least 15° of crank angle, and the peak of the reversed load must be at least 3 % of the
//! load in the opposite direction.

use crate::indicator_card::grid;
use crate::slider_crank::SliderCrank;
use crate::trace::Trace;
use mechanism::Machine;
use std::f64::consts::{PI, TAU};

/// Shortest reversal that API 618 allows, rad: 15°.
pub const SHORTEST_REVERSAL: f64 = 15.0 * PI / 180.0;

/// Lowest peak of the reversed load that API 618 allows, as a share of the opposite one.
pub const LOWEST_REVERSED_SHARE: f64 = 0.03;

/// Loads at the crosshead pin along the piston rod over a revolution, the mean over the record, at the
/// crank angles 2πj/n. Tension is positive.
#[derive(Clone, Debug, PartialEq)]
pub struct RodLoad {
    /// Of the gas, with the pressures in the cylinder, N.
    pub gas: Vec<f64>,
    /// Of the reciprocating masses, −m ẍ with the ideal motion of crank and rod, N.
    pub inertia: Vec<f64>,
    /// Their sum, N.
    pub combined: Vec<f64>,
}

/// The combined load in one of its two directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Its peak, N, at least 0.
    pub peak: f64,
    /// The longest crank angle without a change of direction, rad; 0 where the load never has this direction.
    pub angle: f64,
}

/// How the combined load reverses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversal {
    /// In tension.
    pub tension: Side,
    /// In compression.
    pub compression: Side,
}

impl Reversal {
    /// The shorter of the two angles, rad.
    pub fn angle(&self) -> f64 {
        self.tension.angle.min(self.compression.angle)
    }

    /// The smaller of the two peaks over the larger; 0 where there is no load.
    pub fn share(&self) -> f64 {
        let (tension, compression) = (self.tension.peak, self.compression.peak);
        let largest = tension.max(compression);
        match largest > 0.0 {
            true => tension.min(compression) / largest,
            false => 0.0,
        }
    }

    /// Whether API 618 accepts it.
    pub fn is_sufficient(&self) -> bool {
        self.angle() >= SHORTEST_REVERSAL && self.share() >= LOWEST_REVERSED_SHARE
    }
}

impl RodLoad {
    /// Of each throw of a run.
    ///
    /// The inertia load takes the mass of crosshead, piston rod and piston, and the acceleration that they
    /// have without clearance, at the speed of the crank at each instant. Impacts in a worn joint are not
    /// in it: the rule is about the load that opens and closes the bearing.
    ///
    /// # Errors
    /// A trace of less than one revolution, or of a crank that turns back.
    pub fn of_run(machine: &Machine, trace: &Trace) -> Result<Vec<Self>, signal::Error> {
        let grid = grid(trace)?;
        let mean = |x: &[f64]| Ok(grid.resample(x)?.synchronous_mean());
        let throws = machine.throws.iter().zip(&trace.throws);
        throws
            .map(|(throw, traced)| {
                let mechanism = SliderCrank::from_throw(throw);
                let turning = trace.crank_speed.iter().zip(&trace.crank_acceleration);
                let at = trace.crank_angle.iter().zip(turning);
                let inertia = at.map(|(angle, (speed, angular))| {
                    let local = throw.local_angle(*angle);
                    -throw.crosshead.mass * mechanism.acceleration(local, *speed, *angular)
                });
                let inertia: Vec<f64> = inertia.collect();
                Ok(Self::new(mean(&traced.gas_force)?, mean(&inertia)?))
            })
            .collect()
    }

    /// Of gas and inertia load at the same crank angles.
    pub fn new(gas: Vec<f64>, inertia: Vec<f64>) -> Self {
        let combined = gas.iter().zip(&inertia).map(|(gas, inertia)| gas + inertia);
        Self {
            combined: combined.collect(),
            gas,
            inertia,
        }
    }

    /// Largest tension of the combined load, N; negative where it never is in tension.
    pub fn max(&self) -> f64 {
        self.combined
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest compression of the combined load, N, as a negative number.
    pub fn min(&self) -> f64 {
        self.combined.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// How the combined load reverses.
    pub fn reversal(&self) -> Reversal {
        let [compressed, stretched] = self.longest();
        Reversal {
            tension: Side {
                peak: self.max().max(0.0),
                angle: stretched,
            },
            compression: Side {
                peak: (-self.min()).max(0.0),
                angle: compressed,
            },
        }
    }

    /// The crank angles at which the combined load changes its direction, rad from 0 to 2π, in order.
    pub fn zeros(&self) -> Vec<f64> {
        self.changes().into_iter().map(|(angle, _)| angle).collect()
    }

    /// Where the combined load changes its direction, rad, and whether tension follows. The load is a
    /// straight line between two points.
    fn changes(&self) -> Vec<(f64, bool)> {
        let (load, n) = (&self.combined, self.combined.len());
        let step = TAU / n as f64;
        let change = |j: usize| {
            let (before, after) = (load[j], load[(j + 1) % n]);
            let angle = (j as f64 + before / (before - after)) * step;
            ((before > 0.0) != (after > 0.0)).then_some((angle, after > 0.0))
        };
        (0..n).filter_map(change).collect()
    }

    /// The longest crank angles without a change of direction, in compression and in tension, rad.
    fn longest(&self) -> [f64; 2] {
        let changes = self.changes();
        if changes.is_empty() {
            return match self.max() > 0.0 {
                true => [0.0, TAU],
                false => [TAU, 0.0],
            };
        }
        let ends = changes.iter().skip(1).map(|(angle, _)| *angle);
        let ends = ends.chain(changes.first().map(|(angle, _)| angle + TAU));
        let mut longest = [0.0_f64; 2];
        for ((start, tension), end) in changes.iter().zip(ends) {
            let longest = &mut longest[usize::from(*tension)];
            *longest = longest.max(end - start);
        }
        longest
    }
}
