//! A search around a point of the grid.
//!
//! Between two points of the grid the energies have valleys that are a few hundredths of a clearance wide. Many motions there do
//! not repeat themselves and have no derivatives. So a cell is searched by a method that needs none, CMA-ES.

use super::descent::Led;
use super::effort::Effort;
use super::model::Model;
use super::screen::{STEP, few};
use crate::energies::Energies;
use crate::error::Error;
use crate::optimiser::Progress;
use crate::prior::WithPriors;
use crate::region::{KEPT, Region, SPREADS};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Evaluations for each coordinate of a cell, after the first and second of which a part of the cells is left.
const EACH: [u64; 3] = [12, 25, 50];
/// Cells that go on at least.
const LEAST: usize = 2;
/// Cells that are searched before the search may be stopped.
const AT_ONCE: usize = 4;

/// The best points of the cells around these, the best one first. All cells are searched for a while, the better ones for
/// longer (successive halving, Jamieson and Talwalkar 2016).
///
/// # Errors
/// An optimiser that cannot start.
pub(super) fn around(
    model: &Model,
    points: &[Vec<f64>],
    effort: &mut Effort,
) -> Result<Vec<Led>, Error> {
    let few = few(&model.problem);
    let energies = Energies::new(&few);
    let compared = WithPriors {
        inner: &energies,
        priors: &model.priors,
    };
    let at = |x: &[f64]| Progress {
        x: x.to_vec(),
        cost: f64::INFINITY,
        count: 1,
        evaluations: 0,
    };
    let cell = |x: &Vec<f64>| Region::new(&compared, x, &ranges(model, x));
    let mut cells: Vec<_> = points.iter().map(|x| (cell(x), at(x))).collect();
    let mut left = Vec::new();
    for (round, each) in EACH.into_iter().enumerate() {
        for part in cells.chunks_mut(AT_ONCE) {
            if effort.stopped {
                break;
            }
            let spent = part.par_iter_mut().map(|(cell, best)| {
                let before = best.evaluations;
                let go = &mut |_: &Progress| ControlFlow::Continue(());
                *best = cell.searched(each * cell.dimensions() as u64, go)?;
                Ok(best.evaluations - before)
            });
            effort.evaluated(spent.sum::<Result<u64, Error>>()?);
        }
        cells.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
        if round + 1 < EACH.len() {
            let kept = cells.len().div_ceil(KEPT).max(LEAST).min(cells.len());
            left.extend(cells.drain(kept..));
        }
    }
    cells.extend(left);
    let led = |(cell, best): (Region<_>, Progress)| Led {
        x: cell.whole(&best.x),
        left: 2.0 * best.cost,
    };
    let mut all: Vec<Led> = cells.into_iter().map(led).collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    Ok(all)
}

/// The coordinates that a cell of the grid around `x` moves, and within what.
fn ranges(model: &Model, x: &[f64]) -> Vec<(usize, [f64; 2])> {
    let clearances = (0..model.clear.len()).map(|place| (place, STEP));
    let priors = model.priors.iter();
    let priors = priors.map(|prior| (prior.place, SPREADS * prior.spread));
    let halves = clearances.chain(priors);
    let around = |(place, half): (usize, f64)| (place, [x[place] - half, x[place] + half]);
    halves.map(around).collect()
}
