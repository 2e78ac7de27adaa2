//! Whether an effect has earned its place, and what an explanation comes to.

pub use calibrate::likelihood::NOISE;

use crate::model::{Gap, Model};
use calibrate::Problem;
use serde::{Deserialize, Serialize};

/// A model this near to the noise explains what was missing.
pub const EXPLAINED: f64 = 1.5;
/// An effect is named where it is more probable than not.
pub(crate) const NAMED: f64 = 0.5;
/// By what share of its own signature the law of the right effect is off, as a standard deviation: the laws that the
/// literature has for one effect differ from each other by as much.
const OFF: f64 = 0.35;
/// Odds that a gap has an effect of the catalogue behind it, before it is looked at; and another one beside those that
/// are believed: two faults at once are rare.
const FIRST: f64 = 1.0;
const ANOTHER: f64 = 1.0 / 3.0;

/// What an explanation comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The calibrated model fits within the noise.
    NoGap,
    /// With the effects it is.
    Explained,
    /// With the effects it is much nearer, and something is left.
    PartlyExplained,
    /// Nothing in the catalogue brings it near.
    Unexplained,
}

impl Verdict {
    /// It as results name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no-gap",
            Self::Explained => "explained",
            Self::PartlyExplained => "partly-explained",
            Self::Unexplained => "unexplained",
        }
    }
}

/// What speaks for an effect.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Evidence {
    /// By how much likelier the recordings are with it than without, in nats.
    pub log_odds: f64,
    /// Misfit of the fitted runs without and with it, in standard deviations of the noise.
    pub misfit: [f64; 2],
    /// The same of the held-out runs.
    pub heldout_misfit: Option<[f64; 2]>,
    /// Size of the discrepancy that is left with it: the standard deviation of the crank angle at which features
    /// stand, rad.
    pub timing: f64,
    /// What energies leave without and with it, where they decide: no fit follows the ringing then.
    #[serde(default)]
    pub energies: Option<[Gap; 2]>,
}

/// What speaks for `after`, which has an effect that `before` has not.
pub(crate) fn evidence(before: &Model, after: &Model) -> Evidence {
    let held_out = before.held_out.zip(after.held_out);
    Evidence {
        log_odds: nats(before) - nats(after),
        misfit: [before.fitted, after.fitted],
        heldout_misfit: held_out.map(|(before, after)| [before, after]),
        timing: after.timing,
        energies: None,
    }
}

/// Lines of one channel, run and octave of orders that count as one complex number: what a wrong law leaves in them
/// is no independent noise.
fn octaves(problem: &Problem) -> f64 {
    let channels = problem.runs.iter().flat_map(|run| &run.channels);
    let octaves = channels.map(|channel| {
        channel
            .orders
            .last()
            .map_or(1, |last| (last + 1).ilog2() + 1)
    });
    f64::from(octaves.sum::<u32>())
}

/// Residuals to one that is independent of the others.
fn dependence(problem: &Problem) -> f64 {
    let channels = problem.runs.iter().flat_map(|run| &run.channels);
    let lines: usize = channels.map(|channel| channel.orders.len()).sum();
    lines as f64 / octaves(problem).max(1.0)
}

/// Negative logarithm of the likelihood of all runs of a model, those held out included, as if each octave of each
/// channel were one observation.
pub(crate) fn nats(model: &Model) -> f64 {
    0.5 * (model.deviance + model.heldout_deviance) / dependence(&model.problem)
}

/// The same where energies are compared and leave this misfit, in standard deviations of what a law somewhat off leaves.
pub(crate) fn nats_of_energies(problem: &Problem, misfit: f64) -> f64 {
    0.5 * octaves(problem) * misfit * misfit
}

/// What so many free parameters cost, in nats (Schwarz 1978).
pub(crate) fn freedom(problem: &Problem, parameters: usize) -> f64 {
    0.5 * parameters as f64 * (2.0 * octaves(problem)).ln()
}

/// Share of the distance to the noise that is left of fitted or held-out runs, whichever is more.
pub(crate) fn left(before: &Gap, after: &Gap) -> f64 {
    let above = |misfit: f64| (misfit * misfit - 1.0).max(0.0).sqrt();
    let share = |before: f64, after: f64| match above(before) > 0.0 {
        true => above(after) / above(before),
        false => 1.0,
    };
    let held_out = before.held_out.zip(after.held_out);
    let fitted = share(before.fitted, after.fitted);
    held_out
        .map_or(fitted, |(before, after)| fitted.max(share(before, after)))
        .min(1.0)
}

/// Probability that amendments which leave this share of the gap are of the right kinds, where `others` were believed
/// before and `more` have been added. The right kinds leave what their laws are off by; wrong ones that do best leave
/// any share, a great one sooner.
pub(crate) fn probability(left: f64, others: usize, more: usize) -> f64 {
    let further = (others + more).saturating_sub(1).min(more);
    let odds = FIRST.powi(i32::from(others == 0)) * ANOTHER.powi(further as i32);
    let right = (2.0 / std::f64::consts::PI).sqrt() / OFF * (-0.5 * (left / OFF).powi(2)).exp();
    let wrong = 2.0 * left;
    odds * right / (odds * right + wrong)
}

/// Whether a model leaves hardly more than noise of fitted and held-out runs.
pub(crate) fn explains(model: &Model) -> bool {
    let held_out = model.held_out.unwrap_or(model.fitted);
    model.fitted.max(held_out) <= EXPLAINED
}

/// What a model with so many effects comes to.
pub(crate) fn verdict(baseline: &Model, model: &Model, effects: usize) -> Verdict {
    match effects {
        0 if baseline.fitted <= NOISE => Verdict::NoGap,
        0 => Verdict::Unexplained,
        _ if explains(model) => Verdict::Explained,
        _ => Verdict::PartlyExplained,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_is_named_where_it_leaves_what_its_law_may_be_off_by() {
        assert!(probability(0.0, 0, 1) > 0.99);
        assert!((0.8..0.9).contains(&probability(0.2, 0, 1)));
        assert!(probability(0.5, 0, 1) < NAMED && probability(0.9, 0, 1) < 0.05);
        // A second one has to leave less, and two at once as little.
        assert!(probability(0.3, 1, 1) < probability(0.3, 0, 1));
        assert_eq!(probability(0.3, 0, 2), probability(0.3, 1, 1));
    }
}
