//! What kind of motion a flow settles to, judged from the equations.

use crate::error::Error;
use crate::flow::Flow;
use crate::lyapunov::{Exponent, ExponentSettings, Followed, exponents};
use crate::periodic_orbit::{PeriodicOrbit, shoot};
use integrate::System;
use mechanism::Machine;

/// Standard errors by which an exponent must be clear of a limit: one in a hundred by chance, by
/// Student's distribution for ten batches.
const CLEAR: f64 = 2.82;
/// Distance of two states, in scales (clearances), within which one may repeat the other.
const CLOSE: f64 = 1e-2;
/// Distance within which a trajectory lies on an orbit.
const REACHED: f64 = 1e-3;
/// Periods that are tried.
const TRIES: usize = 3;

/// A kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// It repeats: the trajectory lies on a stable periodic orbit.
    Periodic {
        /// Revolutions after which it repeats.
        revolutions: u32,
    },
    /// It never repeats, and neighbours neither part nor meet: the largest exponent (of a free
    /// crank: the two largest) is 0 within what a regular motion can show.
    QuasiPeriodic,
    /// Neighbours part: the largest exponent is positive.
    Chaotic,
    /// Neither of these is clear.
    Undecided,
}

impl Regime {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Regime::Periodic { .. } => "periodic",
            Regime::QuasiPeriodic => "quasi-periodic",
            Regime::Chaotic => "chaotic",
            Regime::Undecided => "undecided",
        }
    }
}

/// A motion that was followed long enough to be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Lyapunov exponents, the largest first; one, or all of them.
    pub exponents: Vec<Exponent>,
    /// The periodic orbit that it settled to.
    pub orbit: Option<PeriodicOrbit>,
    /// What kind of motion it is.
    pub regime: Regime,
}

/// How much of a motion is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The largest exponent.
    Largest,
    /// All exponents; of n states it takes about n/2 times as long.
    Spectrum,
}

/// [`motion`] of a machine: not generic, so that it is compiled here, and optimised in the dev
/// profile too.
///
/// # Errors
/// Where the integration cannot meet its tolerance.
pub fn machine_motion(
    machine: &Machine,
    settings: &ExponentSettings,
    extent: Extent,
) -> Result<Option<Motion>, Error> {
    motion(machine, settings, extent)
}

/// Follows the motion of `flow` and judges it; `None` where nothing moves freely (all joints
/// ideal, speed given): there is nothing to disturb.
///
/// # Errors
/// Where the integration cannot meet its tolerance.
pub fn motion<F: Flow>(
    flow: &F,
    settings: &ExponentSettings,
    extent: Extent,
) -> Result<Option<Motion>, Error> {
    let states = System::<f64>::dimension(&flow.start().0);
    if states == 0 {
        return Ok(None);
    }
    let motion = match extent {
        Extent::Largest => judge(Followed::<F, 1>::new(flow, settings, 1)?, flow, settings),
        Extent::Spectrum => judge(
            Followed::<F, 8>::new(flow, settings, states)?,
            flow,
            settings,
        ),
    };
    motion.map(Some)
}

fn judge<F: Flow, const N: usize>(
    mut followed: Followed<F, N>,
    flow: &F,
    settings: &ExponentSettings,
) -> Result<Motion, Error> {
    let limits = Limits::after(settings.revolutions);
    let largest = followed.exponents[0].clone();
    let mut orbit = None;
    let regime = if limits.is_positive(&largest) {
        Regime::Chaotic
    } else if let Some(found) = settled_orbit(&mut followed)? {
        let revolutions = found.revolutions;
        orbit = Some(found);
        Regime::Periodic { revolutions }
    } else if !limits.is_zero(&largest) {
        Regime::Undecided
    } else if flow.cycle().free.is_none() {
        Regime::QuasiPeriodic
    } else {
        // A free crank's first exponent is 0 for any regular motion; the second decides.
        let second = match followed.exponents.get(1) {
            Some(second) => second.clone(),
            None => exponents(flow, settings, 2)?.swap_remove(1),
        };
        if limits.is_zero(&second) {
            Regime::QuasiPeriodic
        } else {
            Regime::Undecided
        }
    };
    Ok(Motion {
        exponents: followed.exponents,
        orbit,
        regime,
    })
}

/// The stable periodic orbit that the trajectory has reached. Three things must hold:
///
/// 1. the trajectory repeats from period to period;
/// 2. Newton's method from its end finds an orbit there, not elsewhere;
/// 3. that orbit is attractive.
fn settled_orbit<F: Flow, const N: usize>(
    followed: &mut Followed<F, N>,
) -> Result<Option<PeriodicOrbit>, Error> {
    for period in followed.strobes.periods(CLOSE).take(TRIES) {
        if let Some(found) = shoot(&mut followed.end, period as u32)?
            && found.distance < REACHED
            && found.orbit.largest_modulus() < 1.0
        {
            return Ok(Some(found.orbit));
        }
    }
    Ok(None)
}

/// What separates an exponent from 0.
struct Limits {
    /// The tangent of a regular motion grows at most in proportion to time: after n revolutions
    /// the average of its logarithm is at most ln n / n per revolution.
    regular: f64,
}

impl Limits {
    fn after(revolutions: u32) -> Self {
        let n = f64::from(revolutions);
        Self {
            regular: n.ln() / n,
        }
    }

    fn is_positive(&self, exponent: &Exponent) -> bool {
        let low = exponent.per_second - CLEAR * exponent.standard_error;
        low * exponent.revolution > self.regular
    }

    fn is_zero(&self, exponent: &Exponent) -> bool {
        let error = exponent.standard_error * exponent.revolution;
        exponent.per_revolution().abs() < self.regular && error < self.regular
    }
}
