//! The largest Lyapunov exponent from the equations: the tangent dynamics integrated along with
//! the flow (Benettin, Galgani, Giorgilli and Strelcyn 1980).
//!
//! The tangent is the dual part of the one right-hand side; where the mode switches, the integrator
//! carries the derivative of the switch's time, so that jumps of the force count in full. Four times
//! a revolution the tangent is brought back to length 1; the logarithms of its growth, averaged over
//! time, are the exponent. The length is measured in the integration's own scales (clearances for
//! offsets), which changes nothing in the limit.
//!
//! A driven machine on a periodic orbit has a negative exponent, the orbit's contraction. A free
//! crank makes the system autonomous: a regular motion then shows 0.

use crate::record::Error;
use integrate::{Integrator, System};
use mechanism::{Dynamics, Machine, lift};
use scalar::Dual;
use std::f64::consts::TAU;

/// Renormalisations of the tangent per revolution.
const STRETCHES: u32 = 4;
/// Batches that the standard error is judged from.
const BATCHES: usize = 10;
/// Longest step, as a share of a revolution.
const LONGEST_STEP: f64 = 0.05;

/// A state whose dual part is the tangent.
type Tangent = Dual<f64, 1>;

/// How an exponent is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentSettings {
    /// Revolutions that are thrown away: the motion settles and the tangent finds its direction.
    pub transient: u32,
    /// Revolutions that are averaged over; at least as many as there are batches.
    pub revolutions: u32,
    /// Relative local error of the integration.
    pub tolerance: f64,
}

impl Default for ExponentSettings {
    fn default() -> Self {
        Self {
            transient: 50,
            revolutions: 200,
            tolerance: 1e-9,
        }
    }
}

/// A largest Lyapunov exponent.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponent {
    /// Per second, 1/s.
    pub per_second: f64,
    /// Standard error of it, 1/s, from the scatter between batches of revolutions.
    pub standard_error: f64,
    /// Length of a revolution, s.
    pub revolution: f64,
    /// The running average after each revolution, 1/s: how it converged.
    pub convergence: Vec<f64>,
}

impl Exponent {
    /// Per revolution.
    pub fn per_revolution(&self) -> f64 {
        self.per_second * self.revolution
    }
}

/// The largest exponent of `machine`; `None` where nothing moves freely (all joints ideal, speed
/// given): there is no perturbation to follow.
///
/// # Errors
/// Where the integration cannot meet its tolerance.
pub fn largest_exponent(
    machine: &Machine,
    settings: &ExponentSettings,
) -> Result<Option<Exponent>, Error> {
    // The frame only listens, and its own decay is no part of the machine's motion.
    let mut machine = machine.clone();
    machine.frame = None;
    let mut dynamics = Dynamics::<Tangent>::new(lift::constants(&machine), false);
    if dynamics.dimension() == 0 {
        return Ok(None);
    }
    let revolution = TAU / machine.drive.reference_speed().abs();
    let mut tangent = TangentRun::start(&mut dynamics, settings.tolerance, revolution);
    for _ in 0..settings.transient {
        tangent.revolve(&mut dynamics)?;
    }
    let mut growth = Vec::with_capacity(settings.revolutions as usize);
    for _ in 0..settings.revolutions {
        growth.push(tangent.revolve(&mut dynamics)?);
    }
    Ok(Some(Exponent::of(&growth, revolution)))
}

/// A trajectory with a tangent, renormalised as it goes.
struct TangentRun {
    integrator: Integrator<Tangent>,
    scales: Vec<f64>,
    stretch: f64,
    stretches: u64,
}

impl TangentRun {
    fn start(dynamics: &mut Dynamics<Tangent>, tolerance: f64, revolution: f64) -> Self {
        let scales: Vec<f64> = dynamics.scales().iter().map(|s| s.value).collect();
        let mut state = dynamics.initial_state();
        // Any direction will do that is not special: all components alike.
        let share = 1.0 / (scales.len() as f64).sqrt();
        for (y, scale) in state.iter_mut().zip(&scales) {
            y.tangent[0] = scale * share;
        }
        let longest = LONGEST_STEP * revolution;
        Self {
            integrator: Integrator::new(dynamics, 0.0, &state, tolerance, longest),
            scales,
            stretch: revolution / f64::from(STRETCHES),
            stretches: 0,
        }
    }

    /// Goes on for one revolution; the logarithm of the tangent's growth.
    fn revolve(&mut self, dynamics: &mut Dynamics<Tangent>) -> Result<f64, Error> {
        let mut growth = 0.0;
        for _ in 0..STRETCHES {
            self.stretches += 1;
            let end = self.stretches as f64 * self.stretch;
            self.integrator.advance(dynamics, end, |_, _| ())?;
            growth += self.renormalise(dynamics)?;
        }
        Ok(growth)
    }

    /// Brings the tangent back to length 1; the logarithm of what it had.
    fn renormalise(&mut self, dynamics: &mut Dynamics<Tangent>) -> Result<f64, Error> {
        let mut state = self.integrator.state().to_vec();
        let parts = state.iter().zip(&self.scales);
        let length = parts
            .map(|(y, scale)| (y.tangent[0] / scale).powi(2))
            .sum::<f64>()
            .sqrt();
        if !(length.is_finite() && length > 0.0) {
            let time = self.integrator.time();
            return Err(Error::NotFinite { time });
        }
        for y in &mut state {
            y.tangent[0] /= length;
        }
        self.integrator.set_state(dynamics, &state);
        Ok(length.ln())
    }
}

impl Exponent {
    fn of(growth: &[f64], revolution: f64) -> Self {
        let count = growth.len() as f64;
        let mean = growth.iter().sum::<f64>() / count;
        let mut sum = 0.0;
        let convergence = growth.iter().enumerate().map(|(i, g)| {
            sum += g;
            sum / ((i + 1) as f64 * revolution)
        });
        let convergence = convergence.collect();
        let size = (growth.len() / BATCHES).max(1);
        let batches: Vec<f64> = growth
            .chunks_exact(size)
            .map(|batch| batch.iter().sum::<f64>() / size as f64)
            .collect();
        let n = batches.len() as f64;
        let middle = batches.iter().sum::<f64>() / n;
        let variance = batches.iter().map(|b| (b - middle).powi(2)).sum::<f64>() / (n - 1.0);
        Self {
            per_second: mean / revolution,
            standard_error: (variance / n).sqrt() / revolution,
            revolution,
            convergence,
        }
    }
}
