//! A search around a point of the grid.
//!
//! Between two points of the grid the energies have valleys that are a few hundredths of a clearance wide. Many motions there do
//! not repeat themselves and have no derivatives. So a cell is searched by a method that needs none, CMA-ES.

use super::descent::{KEPT, Led};
use super::effort::Effort;
use super::model::Model;
use super::prior::WithPriors;
use super::screen::{STEP, few};
use crate::energies::Energies;
use crate::error::Error;
use crate::optimiser::{LeastSquares, Progress, cma_es};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// Evaluations for each coordinate of a cell, after the first and second of which a part of the cells is left.
const EACH: [u64; 3] = [12, 25, 50];
/// Cells that go on at least.
const LEAST: usize = 2;
/// Half the width of a cell along a coordinate that has a prior, in standard deviations of that.
const SPREADS: f64 = 2.0;
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
    let mut cells: Vec<_> = points
        .iter()
        .map(|x| (Cell::new(model, &compared, x), at(x)))
        .collect();
    let mut left = Vec::new();
    for (round, each) in EACH.into_iter().enumerate() {
        for part in cells.chunks_mut(AT_ONCE) {
            if effort.stopped {
                break;
            }
            let spent = part.par_iter_mut().map(|(cell, best)| {
                let before = best.evaluations;
                *best = cell.searched(each * cell.halves.len() as u64)?;
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
    let led = |(cell, best): (Cell<_>, Progress)| Led {
        x: cell.whole(&best.x),
        left: 2.0 * best.cost,
    };
    let mut all: Vec<Led> = cells.into_iter().map(led).collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    Ok(all)
}

/// What is compared, around the coordinates `x`.
struct Cell<'a, T> {
    inner: &'a T,
    x: &'a [f64],
    /// The coordinates that move, and by how much at most.
    halves: Vec<(usize, f64)>,
    /// Residuals that were found so far: a search that goes on repeats its way.
    known: Mutex<HashMap<Vec<u64>, Vec<f64>>>,
}

impl<'a, T> Cell<'a, T> {
    /// The cell of the grid around `x`.
    fn new(model: &Model, inner: &'a T, x: &'a [f64]) -> Self {
        let clearances = (0..model.clear.len()).map(|place| (place, STEP));
        let priors = model.priors.iter();
        let priors = priors.map(|prior| (prior.place, SPREADS * prior.spread));
        Self {
            inner,
            x,
            halves: clearances.chain(priors).collect(),
            known: Mutex::default(),
        }
    }

    /// The best that so many evaluations lead to.
    fn searched(&self, most: u64) -> Result<Progress, Error>
    where
        T: LeastSquares,
    {
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        cma_es(self, &self.middle(), 0, most, go)
    }

    fn middle(&self) -> Vec<f64> {
        self.halves
            .iter()
            .map(|(place, _)| self.x[*place])
            .collect()
    }

    /// All coordinates with these in their places.
    fn whole(&self, moved: &[f64]) -> Vec<f64> {
        let mut x = self.x.to_vec();
        for ((place, _), moved) in self.halves.iter().zip(moved) {
            x[*place] = *moved;
        }
        x
    }
}

impl<T: LeastSquares> LeastSquares for Cell<'_, T> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        let bounds = self.inner.bounds();
        let of = |(place, half): &(usize, f64)| {
            let ([low, high], x) = (bounds[*place], self.x[*place]);
            [(x - half).max(low), (x + half).min(high)]
        };
        self.halves.iter().map(of).collect()
    }

    fn count(&self) -> usize {
        self.inner.count()
    }

    fn residuals(&self, moved: &[f64]) -> Vec<f64> {
        let bits: Vec<u64> = moved.iter().map(|x| x.to_bits()).collect();
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(residuals) = known().get(&bits) {
            return residuals.clone();
        }
        let residuals = self.inner.residuals(&self.whole(moved));
        known().insert(bits, residuals.clone());
        residuals
    }

    fn jacobian(&self, moved: &[f64]) -> DMatrix<f64> {
        let all = self.inner.jacobian(&self.whole(moved));
        all.select_columns(self.halves.iter().map(|(place, _)| place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A valley of many ripples, whose bottom is at (0.1, 2, 0.05).
    struct Ripples;

    impl LeastSquares for Ripples {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-1.0, 1.0], [0.0, 3.0], [-1.0, 1.0]]
        }
        fn count(&self) -> usize {
            4
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            let apart = [x[0] - 0.1, x[2] - 0.05];
            let ripple = |d: f64| 0.3 * (60.0 * d).sin();
            vec![
                10.0 * apart[0],
                10.0 * apart[1],
                ripple(apart[0]),
                ripple(apart[1]),
            ]
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(4, 3)
        }
    }

    #[test]
    fn the_bottom_of_a_cell_is_found_without_derivatives_and_what_is_held_stays() {
        let cell = Cell {
            inner: &Ripples,
            x: &[0.0, 2.5, 0.0],
            halves: vec![(0, 0.2), (2, 0.2)],
            known: Mutex::default(),
        };
        assert_eq!(cell.bounds(), [[-0.2, 0.2]; 2]);
        let x = cell.whole(&cell.searched(200).unwrap().x);
        assert!((x[0] - 0.1).abs() < 0.01, "{x:?}");
        assert_eq!(x[1], 2.5);
        assert!((x[2] - 0.05).abs() < 0.01, "{x:?}");
    }
}
