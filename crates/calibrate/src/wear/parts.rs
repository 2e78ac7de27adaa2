//! Parts of a machine that are searched by themselves.
//!
//! Throws of a shaft in an ideal bearing hardly act on each other. Where each has an accelerometer of its own, the clearances of one
//! throw are searched without those of another.

use super::model::Model;
use crate::cloud_descent::Led;
use crate::error::Error;
use crate::prior::Prior;
use crate::problem::Problem;
use crate::throw_alone::{ThrowAlone, throws_alone};

/// Ends of each part that are combined with those of the others.
const COMBINED: usize = 2;

/// A part of a model.
pub(super) struct Part {
    /// How many parts there are.
    pub of: usize,
    /// Its own model.
    pub model: Model,
    /// The places of its coordinates among those of the whole.
    places: Vec<usize>,
}

/// The parts of a model; itself where it cannot be taken apart.
///
/// # Errors
/// An invalid machine.
pub(super) fn parts(model: &Model) -> Result<Vec<Part>, Error> {
    let throws = throws_alone(&model.problem)?;
    let shown = |throw: &ThrowAlone| shows_motion(&throw.problem);
    let held: Vec<usize> = throws.iter().flat_map(|t| t.parameters.clone()).collect();
    let whole = (0..model.problem.parameters.len()).all(|place| held.contains(&place));
    if throws.is_empty() || !whole || !throws.iter().all(shown) {
        return Ok(vec![Part {
            of: 1,
            places: (0..model.problem.parameters.len()).collect(),
            model: model.clone(),
        }]);
    }
    let of = throws.len();
    let parts = throws.into_iter().map(|throw| part(model, throw, of));
    Ok(parts.collect())
}

/// Whether every run has a channel that shows clearances.
fn shows_motion(problem: &Problem) -> bool {
    let mut runs = problem.runs.iter();
    runs.all(|run| run.channels.iter().any(|c| !c.quantity().is_pressure()))
}

fn part(model: &Model, throw: ThrowAlone, of: usize) -> Part {
    let places = throw.parameters;
    let clear = places.iter().filter_map(|place| model.clear.get(*place));
    let prior = |(place, whole): (usize, &usize)| {
        let mut priors = model.priors.iter();
        let known = priors.find(|prior| prior.place == *whole)?;
        Some(Prior {
            place,
            spread: known.spread,
        })
    };
    Part {
        of,
        model: Model {
            clear: clear.copied().collect(),
            contacts: model.contacts,
            priors: places.iter().enumerate().filter_map(prior).collect(),
            problem: throw.problem,
        },
        places,
    }
}

impl Part {
    /// The coordinates of the part at those of the whole.
    pub fn of_whole(&self, x: &[f64]) -> Vec<f64> {
        self.places.iter().map(|place| x[*place]).collect()
    }
}

/// Combinations of the best ends of each part, the best one first. What several parts share is in the middle of their values.
pub(super) fn joined(parts: &[Part], ends: &[Vec<Led>], x: &[f64]) -> Vec<Led> {
    if let [only] = ends {
        return only.clone();
    }
    let mut combined: Vec<Vec<&Led>> = vec![Vec::new()];
    for ends in ends {
        let each = combined.iter().flat_map(|before| {
            let ends = ends.iter().take(COMBINED);
            ends.map(|end| before.iter().copied().chain([end]).collect())
        });
        combined = each.collect();
    }
    let mut all: Vec<Led> = combined.iter().map(|ends| join(parts, ends, x)).collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    all
}

fn join(parts: &[Part], ends: &[&Led], x: &[f64]) -> Led {
    let mut found = vec![Vec::new(); x.len()];
    for (part, end) in parts.iter().zip(ends) {
        for (place, x) in part.places.iter().zip(&end.x) {
            found[*place].push(*x);
        }
    }
    let middle = |(found, x): (&Vec<f64>, &f64)| match found.len() {
        0 => *x,
        count => found.iter().sum::<f64>() / count as f64,
    };
    Led {
        x: found.iter().zip(x).map(middle).collect(),
        left: ends.iter().map(|end| end.left).sum(),
    }
}
