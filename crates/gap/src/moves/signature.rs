//! Which candidates the recordings hardly distinguish from an effect: the confusability of their signatures.
//!
//! A signature is the change Δ that an effect makes in the predicted features, over their noise. What
//! the calibrated parameters can imitate of it is projected out (P, as in the [score
//! test](super::screen)). Of what is left of the effect's, a candidate imitates the share
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
//! as long as the changes are small. Where they are not, a fit of the candidate shows what it leaves.

use crate::candidate::Candidate;
use crate::criteria::Evidence;
use crate::error::{Error, possible};
use crate::finding::{Likeness, Tried, is_rival};
use crate::fitter::Fitter;
use crate::journal::Finished;
use crate::model::Model;
use crate::moves::projector::Projector;
use crate::moves::screen::Screened;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use nalgebra::DVector;
use rayon::prelude::*;

/// Candidates whose parameters are looked at, too, of those whose change is nearest to the effect's.
const NEAREST: usize = 8;
/// Change of a coordinate by which a candidate's parameter is looked at.
const STEP: f64 = 0.02;
/// A direction this near to those before it is left out, as a share of its length.
const DEPENDENT: f64 = 1e-6;

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

/// Of the candidates that were screened in a few runs, those that cannot be distinguished from the effect
/// `best`, the nearest first. `before` has these runs without it, `after`
/// all runs with it; `tried` were fitted.
pub(crate) fn rivals(
    fitter: &Fitter,
    before: &Model,
    after: &Model,
    best: &Tried,
    screened: &[Screened],
    tried: &[Tried],
) -> Result<Vec<Tried>, Error> {
    let metered = before.problem.metered();
    let point = Point::new(&metered, after)?;
    let of_fit = |candidate: &Candidate| tried.iter().find(|t| t.candidate == *candidate);
    let others = screened.iter().filter(|s| s.candidate != best.candidate);
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
    (fitter.say)("comparing signatures", after.fitted);
    let named = |other: &Other| (other.candidate.label(), other.values.clone());
    let named: Vec<_> = others.iter().map(named).collect();
    let input = (
        "alike",
        &before.problem,
        &after.x,
        best.candidate.label(),
        named,
    );
    let watch = fitter.watch;
    let correlations = fitter.effort.journal.once(&input, || {
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
                likeness: Some(likeness),
                model: None,
            },
        }
    };
    let mut rivals: Vec<Tried> = others.into_iter().zip(correlations).map(of).collect();
    rivals.retain(|tried| is_rival(tried, &best.evidence, after.fitted));
    rivals.sort_by(|a, b| a.leaves().total_cmp(&b.leaves()));
    // What to measure next is asked of models.
    if rivals.iter().all(|rival| rival.model.is_none()) && fitter.effort.goes_on() {
        for nearest in rivals.iter_mut().take(1) {
            fit_rival(fitter, before, after, nearest)?;
        }
    }
    Ok(rivals)
}

/// Fits a rival to the runs of `before`, from where `after` has the calibrated parameters.
pub(crate) fn fit_rival(
    fitter: &Fitter,
    before: &Model,
    after: &Model,
    rival: &mut Tried,
) -> Result<(), Error> {
    let added = rival.candidate.added(&before.problem, &rival.values)?;
    if let Some(model) = possible(fitter.rough(added, &after.x[..before.x.len()]))? {
        let candidate = rival.candidate.clone();
        *rival = Tried {
            likeness: rival.likeness,
            ..Tried::fitted(candidate, before, &model, rival.evidence.score)
        };
    }
    Ok(())
}

impl<'a> Point<'a> {
    /// The point without the effect of `after`, in the runs of `problem`, which does not have it.
    fn new(problem: &'a Problem, after: &Model) -> Result<Self, Error> {
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
}
