//! An effect of the catalogue in the place of a force of no name.
//!
//! In a wrong machine neither the score of the true effect nor a descent with it need lead anywhere. The
//! contacts change what a recording shows of a force. A force of no name that reduces the residual far leaves
//! the joints near their true motion. There, an effect that acts on the crosshead can be compared with the
//! force itself. Its parameters are fitted to the force, without any local minimum on the way.

use crate::candidate::Candidate;
use crate::error::Error;
use crate::finding::effects;
use crate::fitter::Fitter;
use crate::model::Model;
use crate::moves::missing_force::missing_force;
use calibrate::Problem;
use calibrate::observation::Observation;
use calibrate::optimiser::{LeastSquares, levenberg_marquardt};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Share of the force, of its sum of squares, that an effect must make to be tried in its place.
const MAKES: f64 = 0.5;
/// An effect that makes less than this of it, by root mean squares, is no force on a crosshead.
const NONE: f64 = 1e-3;
/// Step of a coordinate for a derivative of the force.
const STEP: f64 = 1e-4;
/// Relative change of the sum of squares at which the force is met, and most evaluations.
const CHANGE: f64 = 1e-4;
const EVALUATIONS: u64 = 60;

/// An effect held against a force.
pub(crate) struct Matched {
    pub candidate: Candidate,
    /// Its parameters, SI.
    pub values: Vec<f64>,
    /// How much of the force's sum of squares it makes.
    pub share: f64,
}

/// Those of the candidates that make most of the force, with the values with which they do.
pub(crate) fn matched(
    fitter: &Fitter,
    start: &Model,
    with_force: &Model,
    candidates: &[Candidate],
) -> Result<Vec<Matched>, Error> {
    let x = &with_force.x[..start.x.len()];
    let runs = &fitter.few(start)?.problem.runs;
    let without = force(&start.problem, x, runs)?;
    let with = force(&with_force.problem, &with_force.x, runs)?;
    let size = squares(&with, &without).sqrt();
    if size == 0.0 {
        return Ok(Vec::new());
    }
    let asked = Asked {
        runs,
        x,
        size,
        without,
        with,
    };
    let matched = candidates.par_iter().map(|candidate| {
        if (fitter.watch)().is_break() {
            return Err(Error::Stopped);
        }
        asked.matched(start, candidate)
    });
    let matched = matched.collect::<Result<Vec<_>, Error>>()?;
    let mut matched: Vec<Matched> = matched.into_iter().flatten().collect();
    matched.retain(|matched| matched.share > MAKES);
    Ok(matched)
}

/// A force that is asked for.
struct Asked<'a> {
    runs: &'a [Observation],
    /// Coordinates of the machine that it was found with.
    x: &'a [f64],
    /// The force of all effects without it, and with it, N.
    without: Vec<f64>,
    with: Vec<f64>,
    /// Root of the sum of its squares, N.
    size: f64,
}

impl Asked<'_> {
    /// A candidate, with the values with which it makes as much of the force as it can. None where it is
    /// no force on a crosshead.
    fn matched(&self, start: &Model, candidate: &Candidate) -> Result<Option<Matched>, Error> {
        let mut nearest: Option<(f64, Problem)> = None;
        for values in candidate.probes(&start.problem) {
            let Ok(problem) = candidate.added(&start.problem, &values) else {
                return Ok(None);
            };
            let mut x = self.x.to_vec();
            x.resize(problem.parameters.len(), 0.0);
            let Ok(made) = force(&problem, &x, self.runs) else {
                return Ok(None);
            };
            if squares(&made, &self.without).sqrt() < NONE * self.size {
                return Ok(None);
            }
            let left = squares(&made, &self.with);
            if nearest.as_ref().is_none_or(|(least, _)| left < *least) {
                nearest = Some((left, problem));
            }
        }
        let Some((_, problem)) = nearest else {
            return Ok(None);
        };
        let matching = Matching {
            problem: &problem,
            asked: self,
        };
        let from = vec![0.0; problem.parameters.len() - self.x.len()];
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        let found = levenberg_marquardt(&matching, &from, CHANGE, EVALUATIONS, go_on)?;
        let there = Model {
            x: [self.x, &found.x].concat(),
            problem,
            ..start.clone()
        };
        Ok(Some(Matched {
            values: candidate.values(&there, effects(&start.problem)),
            candidate: candidate.clone(),
            share: 1.0 - 2.0 * found.cost,
        }))
    }
}

/// The force of all effects on the crossheads over a revolution of each of these runs, N.
fn force(problem: &Problem, x: &[f64], runs: &[Observation]) -> Result<Vec<f64>, Error> {
    let each = missing_force(problem, x, runs)?;
    Ok(each.into_iter().flat_map(|of_run| of_run.force).collect())
}

/// Sum of the squares of a difference.
fn squares(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// The force that an effect makes less the one that is asked for, over the size of that, as a function of
/// the effect's coordinates.
struct Matching<'a> {
    /// The problem with the effect.
    problem: &'a Problem,
    asked: &'a Asked<'a>,
}

impl LeastSquares for Matching<'_> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        let own = &self.problem.parameters[self.asked.x.len()..];
        own.iter().map(|p| p.box_bounds()).collect()
    }

    fn count(&self) -> usize {
        self.asked.with.len()
    }

    fn residuals(&self, own: &[f64]) -> Vec<f64> {
        let asked = self.asked;
        let made = force(self.problem, &[asked.x, own].concat(), asked.runs);
        // What cannot be simulated makes nothing.
        let made = made.unwrap_or_else(|_| asked.without.clone());
        let less = |(made, with): (&f64, &f64)| (made - with) / asked.size;
        made.iter().zip(&asked.with).map(less).collect()
    }

    fn jacobian(&self, own: &[f64]) -> DMatrix<f64> {
        let here = self.residuals(own);
        let slopes = (0..own.len()).flat_map(|i| {
            let mut moved = own.to_vec();
            moved[i] += STEP;
            let there = self.residuals(&moved);
            let slope = |(there, here): (f64, &f64)| (there - here) / STEP;
            there
                .into_iter()
                .zip(&here)
                .map(slope)
                .collect::<Vec<f64>>()
        });
        DMatrix::from_iterator(self.count(), own.len(), slopes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use input::effects::entry;
    use serde_json::json;

    #[test]
    fn a_force_by_the_rings_is_theirs() {
        let problem = problem().with_runs(|run| run.id == "400 rpm");
        let mut with_force = problem.clone();
        let law = json!({"velocity_sign": "-150 N", "pressure_sign": "-40 N"});
        with_force.tree["effects"] = json!([{"empirical_force": law}]);
        let x = [0.02];
        let [without, with] = [&problem, &with_force].map(|p| force(p, &x, &p.runs).unwrap());
        let asked = Asked {
            runs: &problem.runs,
            x: &x,
            size: squares(&with, &without).sqrt(),
            without,
            with,
        };
        let start = Model {
            x: x.to_vec(),
            fitted: 9.0,
            held_out: None,
            by_run: Vec::new(),
            problem: problem.clone(),
        };
        let matched = |name: &str| {
            let mut candidates = Candidate::all(&problem).into_iter();
            let candidate = candidates
                .find(|c| c.entry == entry(name).unwrap())
                .unwrap();
            asked.matched(&start, &candidate).unwrap()
        };
        let rings = matched("ring_friction").unwrap();
        assert!(rings.share > 0.999, "{}", rings.share);
        let [constant, by_pressure, _] = rings.values[..] else {
            panic!("{:?}", rings.values);
        };
        assert!((constant - 150.0).abs() < 1.0, "{constant}");
        assert!((by_pressure * 1e5 - 40.0).abs() < 0.5, "{by_pressure}");
        // A force of orders one and two makes a part of it, clearance none.
        let orders = matched("misalignment").unwrap().share;
        assert!((MAKES..0.95).contains(&orders), "{orders}");
        assert!(matched("extra_clearance").is_none());
    }
}
