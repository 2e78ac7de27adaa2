//! Effects that were tried and found.

use crate::candidate::Candidate;
use crate::criteria::{Evidence, NOISE, RIVAL, evidence, rival};
use crate::error::Error;
use crate::fitter::Fitter;
use crate::model::{Gap, Model};
use calibrate::Problem;

/// Signatures as near as this are one where more is missing than the effect. What is left over then hides
/// the difference (the same limit as for groups of sensitivities in model updating).
const ALIKE: f64 = 0.9;
/// Share of what the effect explains that a rival explains at least.
const AS_MUCH: f64 = 0.5;

/// A candidate that was looked at.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect.
    pub candidate: Candidate,
    /// Its parameters, SI.
    pub values: Vec<f64>,
    /// How well it did.
    pub evidence: Evidence,
    /// How like that of the effect that was added its signature is, where it was compared.
    pub likeness: Option<Likeness>,
    /// The model with it, fitted to some or all runs; none where it was not fitted.
    pub model: Option<Model>,
}

/// An effect that was added.
#[derive(Clone, Debug)]
pub struct Found {
    /// The effect as it was added, with the model with which that was decided; none where its parameters
    /// are no model's.
    pub effect: Tried,
    /// What the full model was left with once it had been added; none where that was not looked at by
    /// itself.
    pub gap: Option<Gap>,
    /// What else might have been.
    pub rivals: Vec<Tried>,
}

/// A model with the effects that were found.
#[derive(Clone, Debug)]
pub(crate) struct Explained {
    pub model: Model,
    /// The effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// What was tried last and did not earn its place.
    pub refused: Vec<Tried>,
}

/// How like an effect's a candidate's signature is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// Correlation ρ of the signatures, 0 to 1.
    pub correlation: f64,
    /// Misfit that the candidate would leave in place of the effect, in standard deviations of the
    /// noise, as far as changes are small.
    pub leaves: f64,
}

impl Tried {
    /// The candidate as `after` has it, whose machine has it and that of `before` has not; both of the
    /// same runs.
    pub(crate) fn fitted(candidate: Candidate, before: &Model, after: &Model, score: f64) -> Self {
        Self {
            values: candidate.values(after, effects(&before.problem)),
            candidate,
            evidence: evidence(before, after, score),
            likeness: None,
            model: Some(after.clone()),
        }
    }

    /// Whether its signature is nearly that of the effect that was added.
    pub(crate) fn is_alike(&self) -> bool {
        self.likeness.is_some_and(|l| l.correlation > ALIKE)
    }

    /// Misfit that it leaves, by its fit or by the signatures, whichever is less: a fit may have
    /// ended in a local minimum.
    pub fn leaves(&self) -> f64 {
        let fitted = self.evidence.misfit[1];
        self.likeness.map_or(fitted, |l| l.leaves.min(fitted))
    }

    /// How much it explains, over what the effect does that has this evidence: shares of the squared
    /// misfit.
    pub fn explains(&self, effect: &Evidence) -> f64 {
        let share = |before: f64, after: f64| 1.0 - (after / before).powi(2);
        let own = share(self.evidence.misfit[0], self.leaves());
        own / share(effect.misfit[0], effect.misfit[1])
    }
}

impl Found {
    /// An effect with which `after` was left with that.
    pub(crate) fn new(effect: Tried, after: &Model, rivals: Vec<Tried>) -> Self {
        Self {
            effect,
            gap: Some(after.gap()),
            rivals,
        }
    }

    /// Its effect at its place.
    pub fn candidate(&self) -> &Candidate {
        &self.effect.candidate
    }
}

/// Whether the recordings do not distinguish a candidate from an effect. `effect` is the evidence for the effect,
/// and `least` the misfit that its model leaves. Either hardly more is left with the candidate, and it explains most
/// of the effect's share; or more than noise is left anyway, and it does the same and leaves not much more.
pub(crate) fn is_rival(tried: &Tried, effect: &Evidence, least: f64) -> bool {
    let near = tried.leaves() < rival(least) && tried.explains(effect) > AS_MUCH;
    near || (tried.is_alike() && least > NOISE && tried.leaves() < RIVAL * least)
}

/// The problem with these effects in its machine.
///
/// # Errors
/// A machine that cannot have them.
pub(crate) fn added<'a>(
    problem: &Problem,
    effects: impl IntoIterator<Item = &'a Tried>,
) -> Result<Problem, Error> {
    let with = |problem: Problem, effect: &Tried| effect.candidate.added(&problem, &effect.values);
    effects.into_iter().try_fold(problem.clone(), with)
}

/// Index of the first item of the effect `found[which]` in a machine of `problem` that has them all.
pub fn first_item(problem: &Problem, found: &[Found], which: usize) -> usize {
    let before = found[..which].iter();
    let items = before.map(|found| found.candidate().items().len());
    effects(problem) + items.sum::<usize>()
}

/// The model with these effects and no others.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub(crate) fn with_only(
    fitter: &Fitter,
    problem: &Problem,
    baseline: &Model,
    found: &[Found],
) -> Result<Model, Error> {
    if found.is_empty() {
        return Ok(baseline.clone());
    }
    let with = added(problem, found.iter().map(|found| &found.effect))?;
    fitter.fit(with, &baseline.x[..problem.parameters.len()])
}

/// The machine of `problem` with the effects of `model` but `found[which]`, and the coordinates there of
/// the free parameters of `problem`. The other effects stand at their fitted values, where their coordinates are 0.
pub(crate) fn without(
    problem: &Problem,
    model: &Model,
    found: &[Found],
    which: usize,
) -> Result<(Problem, Vec<f64>), Error> {
    let mut without = problem.clone();
    for (i, other) in found.iter().enumerate().filter(|(i, _)| *i != which) {
        let other = other.candidate();
        let values = other.values(model, first_item(problem, found, i));
        without = other.added(&without, &values)?;
    }
    Ok((without, model.x[..problem.parameters.len()].to_vec()))
}

/// How many effects a problem's machine has.
pub(crate) fn effects(problem: &Problem) -> usize {
    problem.tree["effects"].as_array().map_or(0, Vec::len)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(fitted: f64, correlation: f64, leaves: f64) -> Tried {
        let candidate = Candidate {
            entry: input::effects::entry("valve_loss").unwrap(),
            place: Vec::new(),
            fixed: Vec::new(),
            ends: &[],
        };
        Tried {
            candidate,
            values: Vec::new(),
            evidence: Evidence {
                score: 0.0,
                misfit: [10.0, fitted],
                heldout_misfit: None,
                delta_bic: 0.0,
            },
            likeness: Some(Likeness {
                correlation,
                leaves,
            }),
            model: None,
        }
    }

    #[test]
    fn at_the_noise_it_decides_and_above_it_likeness_does() {
        let is_rival = |tried: Tried, least: f64| {
            let misfit = [10.0, least];
            let effect = Evidence {
                misfit,
                ..tried.evidence.clone()
            };
            is_rival(&tried, &effect, least)
        };
        // Nearly the same signature, but distinguished: the effect is far above the noise.
        assert!(!is_rival(tried(8.0, 0.95, 9.0), 1.0));
        // Hardly the same, but not distinguished: the effect is small.
        assert!(is_rival(tried(f64::INFINITY, 0.3, 1.9), 1.0));
        // What is left over hides the difference.
        assert!(is_rival(tried(9.5, 0.95, 9.8), 7.0));
        assert!(!is_rival(tried(9.5, 0.8, 9.8), 7.0));
        // Nor does it hide one as great as this.
        assert!(!is_rival(tried(9.5, 0.95, 9.8), 2.0));
    }
}
