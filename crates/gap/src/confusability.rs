//! Which candidates the recordings hardly tell from an effect: the confusability of their signatures.
//!
//! A signature is the change Δ that an effect makes in the predicted features, over their noise. What
//! the calibrated parameters can imitate of it is projected out (P, as in the [score
//! test](crate::screening)). Of what is left of the effect's, a candidate imitates the share
//!
//! ```text
//! ρ² = |Q P Δe|² / |P Δe|²
//! ```
//!
//! where Q projects on what the candidate can do: its own change and those by its parameters, projected
//! likewise. ρ is the canonical correlation of the effect's signature with the candidate's (Hotelling
//! 1936), the cosine of the angle between them. With the candidate in the effect's place, whose model
//! leaves the misfit m of n residuals, they would leave
//!
//! ```text
//! m'² = m² + (1 − ρ²) |P Δe|² / n
//! ```
//!
//! as long as the changes are small; where they are not, a fit of the candidate tells what it leaves.

use crate::candidate::Candidate;
use crate::decision::{Evidence, NOISE, RIVAL, evidence, rival};
use crate::error::{Error, possible};
use crate::explain::{Search, Tried, effects};
use crate::journal::Finished;
use crate::model::Model;
use crate::projector::Projector;
use crate::screening::Screened;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use nalgebra::DVector;
use rayon::prelude::*;
use serde::Serialize;

/// Signatures as near as this are one where more is missing than the effect: what is left over hides
/// the difference (the same limit as for groups of sensitivities in model updating).
const ALIKE: f64 = 0.9;
/// Share of what the effect explains that a rival explains at least.
const AS_MUCH: f64 = 0.5;
/// Candidates whose parameters are looked at, too, of those whose change is nearest to the effect's.
const NEAREST: usize = 8;
/// Change of a coordinate by which a candidate's parameter is looked at.
const STEP: f64 = 0.02;
/// A direction this near to those before it is none, as a share of its length.
const DEPENDENT: f64 = 1e-6;

/// How like an effect's a candidate's signature is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Likeness {
    /// Correlation ρ of the signatures, 0 to 1.
    pub correlation: f64,
    /// Misfit that the candidate would leave in place of the effect, in standard deviations of the
    /// noise, as far as changes are small.
    pub leaves: f64,
}

/// A candidate, with values (SI) at which it changes something.
struct Other<'a> {
    candidate: &'a Candidate,
    values: Vec<f64>,
}

/// The point at which signatures are compared: the machine without the effect, as it was calibrated
/// with it.
struct Point<'a> {
    problem: &'a Problem,
    x: Vec<f64>,
    residual: DVector<f64>,
    projector: Projector,
    /// P Δe.
    signature: DVector<f64>,
}

impl Search<'_> {
    /// Of the candidates that were looked at in a few runs, those that cannot be told from the effect
    /// `best`, for which `effect` speaks, the nearest first. `before` has these runs without it, `after`
    /// all runs with it; `tried` were fitted.
    pub(crate) fn rivals(
        &self,
        before: &Model,
        after: &Model,
        best: &Candidate,
        effect: &Evidence,
        screened: &[Screened],
        tried: Vec<Tried>,
    ) -> Result<Vec<Tried>, Error> {
        let metered = before.problem.metered();
        let point = Point::of(&metered, after)?;
        let of_fit = |candidate: &Candidate| tried.iter().find(|t| t.candidate == *candidate);
        let others = screened.iter().filter(|s| s.candidate != *best);
        let others: Vec<Other> = others
            .filter_map(|s| {
                let values = match of_fit(&s.candidate) {
                    Some(fitted) => fitted.values.clone(),
                    None => s.starts.first()?.values.clone(),
                };
                let candidate = &s.candidate;
                Some(Other { candidate, values })
            })
            .collect();
        (self.say)("comparing signatures", after.fitted);
        let named = |other: &Other| (other.candidate.label(), other.values.clone());
        let named: Vec<_> = others.iter().map(named).collect();
        let input = ("alike", &before.problem, &after.x, best.label(), named);
        let watch = self.watch;
        let correlations = self.effort.journal.once(&input, || {
            let changes = others.par_iter().map(|other| {
                let stopped = watch().is_break();
                if stopped {
                    Err(Error::Stopped)
                } else {
                    Ok(point.change(other))
                }
            });
            let mut changes = changes.collect::<Result<Vec<_>, Error>>()?;
            let mut order: Vec<usize> = (0..others.len()).collect();
            order.sort_by(|a, b| {
                let near = |i: &usize| point.correlation(&changes[*i]);
                near(b).total_cmp(&near(a))
            });
            let nearest: Vec<(usize, Vec<DVector<f64>>)> = order
                .into_par_iter()
                .take(NEAREST)
                .map(|i| (i, point.by_parameters(&others[i])))
                .collect();
            for (i, more) in nearest {
                changes[i].extend(more);
            }
            Ok(Finished {
                numbers: changes.iter().map(|c| point.correlation(c)).collect(),
                cost: metered.meter.steps(),
            })
        })?;
        let count = point.signature.len() as f64;
        let size = point.signature.norm_squared() / count;
        let of = |(other, correlation): (Other, f64)| {
            let leaves = (after.fitted.powi(2) + (1.0 - correlation.powi(2)) * size).sqrt();
            let likeness = Likeness {
                correlation,
                leaves,
            };
            let score = screened.iter().find(|s| s.candidate == *other.candidate);
            match of_fit(other.candidate) {
                Some(fitted) => Tried {
                    likeness: Some(likeness),
                    ..fitted.clone()
                },
                None => Tried {
                    candidate: other.candidate.clone(),
                    values: other.values,
                    evidence: Evidence {
                        score: score.map_or(0.0, |s| s.score),
                        misfit: [before.fitted, leaves],
                        heldout_misfit: None,
                        delta_bic: before.bic_with(leaves, other.candidate.free().count() as f64),
                    },
                    by_run: Vec::new(),
                    likeness: Some(likeness),
                    model: None,
                },
            }
        };
        let mut rivals: Vec<Tried> = others.into_iter().zip(correlations).map(of).collect();
        rivals.retain(|tried| is_rival(tried, effect, after.fitted));
        rivals.sort_by(|a, b| a.leaves().total_cmp(&b.leaves()));
        // What to measure next is asked of models.
        if rivals.iter().all(|rival| rival.model.is_none()) && self.effort.goes_on() {
            for nearest in rivals.iter_mut().take(1) {
                self.fit_rival(before, after, nearest)?;
            }
        }
        Ok(rivals)
    }

    /// Fits a rival to the runs of `before`, from where `after` has the calibrated parameters.
    pub(crate) fn fit_rival(
        &self,
        before: &Model,
        after: &Model,
        rival: &mut Tried,
    ) -> Result<(), Error> {
        let added = rival.candidate.added(&before.problem, &rival.values)?;
        let mut x = after.x[..before.x.len()].to_vec();
        x.resize(added.parameters.len(), 0.0);
        let Some(model) = possible(self.rough(added, &x))? else {
            return Ok(());
        };
        rival.values = rival.candidate.values(&model, effects(&before.problem));
        rival.evidence = evidence(before, &model, rival.evidence.score);
        rival.by_run = model.misfits();
        rival.model = Some(model);
        Ok(())
    }
}

/// Whether the recordings do not tell a candidate from the effect for which `effect` speaks and whose
/// model leaves `least`: hardly more is left with it, of which it explains most; or, where more than noise
/// is left anyway, it does the same and leaves not much more.
pub(crate) fn is_rival(tried: &Tried, effect: &Evidence, least: f64) -> bool {
    let near = tried.leaves() < rival(least) && tried.explains(effect) > AS_MUCH;
    near || (tried.is_alike() && least > NOISE && tried.leaves() < RIVAL * least)
}

impl Tried {
    /// Whether its signature is nearly that of the effect that was added.
    pub(crate) fn is_alike(&self) -> bool {
        self.likeness.is_some_and(|l| l.correlation > ALIKE)
    }

    /// Misfit that it leaves, by its fit or as far as signatures tell, whichever is less: a fit may have
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

impl<'a> Point<'a> {
    /// The point without the effect of `after`, in the runs of `problem`, which does not have it.
    fn of(problem: &'a Problem, after: &Model) -> Result<Self, Error> {
        let x = after.x[..problem.parameters.len()].to_vec();
        let likelihood = Likelihood::new(problem);
        let residual = DVector::from_vec(likelihood.residuals(&x));
        let projector = Projector::new(&likelihood.jacobian(&x));
        let same = |run: &str| problem.runs.iter().any(|own| own.id == run);
        let with = after.problem.with_runs(|run| same(&run.id));
        let there = DVector::from_vec(Likelihood::new(&with).residuals(&after.x));
        let signature = projector.apply(&(there - &residual));
        Ok(Self {
            problem,
            x,
            residual,
            projector,
            signature,
        })
    }

    /// What a candidate changes here; nothing where it cannot be simulated.
    fn change(&self, other: &Other) -> Vec<DVector<f64>> {
        let change = self.residuals(other, None);
        change
            .map(|r| self.projector.apply(&(r - &self.residual)))
            .into_iter()
            .collect()
    }

    /// What each of a candidate's parameters changes there.
    fn by_parameters(&self, other: &Other) -> Vec<DVector<f64>> {
        let Some(here) = self.residuals(other, None) else {
            return Vec::new();
        };
        let count = other.values.len();
        let moved = (0..count).filter_map(|i| self.residuals(other, Some(i)));
        moved.map(|r| self.projector.apply(&(r - &here))).collect()
    }

    /// The residuals with a candidate, one of its free parameters moved a little.
    fn residuals(&self, other: &Other, moved: Option<usize>) -> Option<DVector<f64>> {
        let added = other.candidate.added(self.problem, &other.values).ok()?;
        let own = self.x.len();
        let mut x = self.x.clone();
        x.resize(added.parameters.len(), 0.0);
        if let Some(i) = moved {
            *x.get_mut(own + i)? = STEP;
        }
        Some(DVector::from_vec(Likelihood::new(&added).residuals(&x)))
    }

    /// Canonical correlation of the effect's signature with a space of changes.
    fn correlation(&self, changes: &[DVector<f64>]) -> f64 {
        correlation(&self.signature, changes)
    }
}

/// Cosine of the angle between a vector and what others span (Gram and Schmidt's method).
fn correlation(vector: &DVector<f64>, others: &[DVector<f64>]) -> f64 {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for other in others {
        let mut rest = other.clone();
        // Twice, for rounding.
        for _ in 0..2 {
            for direction in &basis {
                let along = direction.dot(&rest);
                rest.axpy(-along, direction, 1.0);
            }
        }
        let length = rest.norm();
        if length > DEPENDENT * other.norm() {
            basis.push(rest / length);
        }
    }
    let along: f64 = basis.iter().map(|b| b.dot(vector).powi(2)).sum();
    let whole = vector.norm_squared();
    if whole > 0.0 {
        (along / whole).sqrt().min(1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_span_is_imitated_and_the_rest_is_not() {
        let vector = DVector::from_vec(vec![3.0, 4.0, 12.0]);
        let x = DVector::from_vec(vec![2.0, 0.0, 0.0]);
        let same = DVector::from_vec(vec![-1.0, 0.0, 0.0]);
        let y = DVector::from_vec(vec![5.0, 0.1, 0.0]);
        assert_eq!(correlation(&vector, &[]), 0.0);
        assert!((correlation(&vector, std::slice::from_ref(&x)) - 3.0 / 13.0).abs() < 1e-12);
        let all = [x, same, y];
        assert!((correlation(&vector, &all) - 5.0 / 13.0).abs() < 1e-12);
        let itself = [-2.0 * &vector];
        assert!((correlation(&vector, &itself) - 1.0).abs() < 1e-12);
    }

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
            by_run: Vec::new(),
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
        // Nearly the same signature, and yet told apart: the effect is far above the noise.
        assert!(!is_rival(tried(8.0, 0.95, 9.0), 1.0));
        // Hardly the same, and not told apart: it is small.
        assert!(is_rival(tried(f64::INFINITY, 0.3, 1.9), 1.0));
        // What is left over hides the difference.
        assert!(is_rival(tried(9.5, 0.95, 9.8), 7.0));
        assert!(!is_rival(tried(9.5, 0.8, 9.8), 7.0));
        // Nor does it hide one as great as this.
        assert!(!is_rival(tried(9.5, 0.95, 9.8), 2.0));
    }
}
