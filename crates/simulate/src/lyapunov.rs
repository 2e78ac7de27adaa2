//! Lyapunov exponents from the equations: the tangent dynamics integrated along with the flow
//! (Benettin, Galgani, Giorgilli and Strelcyn 1980).
//!
//! Several times a revolution the tangents are made perpendicular and of length 1 again; the
//! logarithms of their growth, averaged over time, are the exponents, the largest first. Lengths are
//! measured in the integration's own scales, which changes nothing in the limit.
//!
//! A driven machine on a periodic orbit has a negative largest exponent, the orbit's contraction. A
//! free crank makes the system autonomous: a regular motion then shows 0.
//!
//! Where rigid joints catch their journals without rebound, two directions a joint are lost for
//! good. A direction that shrinks below rounding between two renormalisations has the exponent −∞. The
//! other one fades at the rate at which a following joint is drawn back onto its surface (Baumgarte
//! 1972). So do the two directions that lead off a massless link. Those exponents are not the machine's.

use crate::error::Error;
use crate::flow::Flow;
use crate::strobes::Strobes;
use crate::tangents::Tangents;

/// Renormalisations per revolution of a single tangent.
const STRETCHES: u32 = 4;
/// And of several: a stiff contact must not shrink one against another to rounding.
const MANY_STRETCHES: u32 = 64;
/// Where a revolution begins, as a share of one. No throw has a dead centre there, so that a run can go
/// on from the end of a revolution without a switch at that instant.
const OFFSET: f64 = 0.07;
/// Batches that the standard error is judged from.
const BATCHES: usize = 10;

/// How exponents are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentSettings {
    /// Revolutions that are thrown away: the motion settles and the tangents find their directions.
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

/// A Lyapunov exponent.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponent {
    /// Per second, 1/s; −∞ for a direction that a rigid impact swallows.
    pub per_second: f64,
    /// Standard error of it, 1/s, from the scatter between batches of revolutions.
    pub standard_error: f64,
    /// Length of a revolution, s.
    pub revolution: f64,
    /// The running average after each revolution, 1/s: how it converged.
    pub convergence: Vec<f64>,
}

/// The `count` largest exponents of `flow`, or all that it has where those are fewer.
///
/// # Errors
/// Where the integration cannot meet its tolerance.
pub fn exponents<F: Flow>(
    flow: &F,
    settings: &ExponentSettings,
    count: usize,
) -> Result<Vec<Exponent>, Error> {
    Ok(if count == 1 {
        Followed::<F, 1>::new(flow, settings, count)?.exponents
    } else {
        Followed::<F, 8>::new(flow, settings, count)?.exponents
    })
}

/// A trajectory that was followed with tangents, and what it showed.
pub(crate) struct Followed<F: Flow, const N: usize> {
    /// Where it ended.
    pub end: Tangents<F, N>,
    /// Its last states, once a revolution.
    pub strobes: Strobes,
    pub exponents: Vec<Exponent>,
}

impl<F: Flow, const N: usize> Followed<F, N> {
    pub fn new(flow: &F, settings: &ExponentSettings, count: usize) -> Result<Self, Error> {
        let mut tangents = Tangents::<F, N>::start(flow, count, settings.tolerance);
        let mut strobes = Strobes::new(&tangents);
        let stretches = if count == 1 {
            STRETCHES
        } else {
            MANY_STRETCHES
        };
        let revolution = tangents.cycle().length();
        let mut growth = Vec::with_capacity(settings.revolutions as usize);
        tangents.advance(OFFSET * revolution, |_, _| ())?;
        tangents.spread();
        for number in 0..settings.transient + settings.revolutions {
            if number == settings.transient / 2 {
                tangents.undisturb_memory();
            }
            let mut grown = vec![0.0; tangents.count()];
            for stretch in 1..=stretches {
                let share = f64::from(stretch) / f64::from(stretches);
                let end = (OFFSET + f64::from(number) + share) * revolution;
                tangents.advance(end, |system, step| strobes.watch(system, step))?;
                let parts = tangents.orthonormalise()?;
                grown.iter_mut().zip(parts).for_each(|(sum, g)| *sum += g);
            }
            if number >= settings.transient {
                growth.push(grown);
            }
        }
        let of = |i: usize| growth.iter().map(|grown| grown[i]).collect::<Vec<_>>();
        Ok(Self {
            exponents: (0..tangents.count())
                .map(|i| Exponent::from_growth(&of(i), revolution))
                .collect(),
            end: tangents,
            strobes,
        })
    }
}

impl Exponent {
    /// Per revolution.
    pub fn per_revolution(&self) -> f64 {
        self.per_second * self.revolution
    }

    /// From the growth over each revolution.
    fn from_growth(growth: &[f64], revolution: f64) -> Self {
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
        // Minus infinity has no scatter.
        let variance = if mean.is_finite() { variance } else { 0.0 };
        Self {
            per_second: mean / revolution,
            standard_error: (variance / n).sqrt() / revolution,
            revolution,
            convergence,
        }
    }
}
