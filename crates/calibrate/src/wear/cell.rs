//! A search around a point of the grid.
//!
//! Between two points of the grid the energies have valleys that are a few hundredths of a clearance wide. Many motions there do
//! not repeat themselves and have no derivatives. So a cell is searched by a method that needs none, CMA-ES.

use super::descent::Led;
use super::effort::Effort;
use super::model::Model;
use super::prior::WithPriors;
use super::screen::{STEP, few};
use crate::energies::Energies;
use crate::optimiser::{LeastSquares, Progress, cma_es};
use crate::problem::Problem;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Evaluations for each coordinate of a cell.
const EACH: u64 = 50;
/// Half the width of a cell along a coordinate that has a prior, in standard deviations of that.
const SPREADS: f64 = 2.0;
/// Cells that are searched before the search may be stopped.
const AT_ONCE: usize = 4;

/// The best points of the cells around these, the best one first.
pub(super) fn around(model: &Model, points: Vec<Vec<f64>>, effort: &mut Effort) -> Vec<Led> {
    let few = few(&model.problem);
    let mut all: Vec<Led> = Vec::new();
    for part in points.chunks(AT_ONCE) {
        if effort.stopped {
            break;
        }
        let ends = part.par_iter().map(|x| searched(model, &few, x));
        let ends: Vec<(Led, u64)> = ends.collect();
        effort.evaluated(ends.iter().map(|(_, spent)| spent).sum());
        all.extend(ends.into_iter().map(|(led, _)| led));
    }
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    all
}

/// The best point of the cell around `x`, and the evaluations that it took.
fn searched(model: &Model, few: &Problem, x: &[f64]) -> (Led, u64) {
    let energies = Energies::new(few);
    let compared = WithPriors {
        inner: &energies,
        priors: &model.priors,
    };
    let clearances = (0..model.clear.len()).map(|place| (place, STEP));
    let priors = model.priors.iter();
    let cell = Cell {
        inner: &compared,
        x,
        halves: clearances
            .chain(priors.map(|prior| (prior.place, SPREADS * prior.spread)))
            .collect(),
    };
    let go = &mut |_: &Progress| ControlFlow::Continue(());
    let most = EACH * cell.halves.len() as u64;
    match cma_es(&cell, &cell.middle(), 0, most, go) {
        Ok(found) => {
            let led = Led {
                x: cell.whole(&found.x),
                left: 2.0 * found.cost,
            };
            (led, found.evaluations)
        }
        Err(_) => {
            let led = Led {
                x: x.to_vec(),
                left: f64::INFINITY,
            };
            (led, most)
        }
    }
}

/// What is compared, around the coordinates `x`.
struct Cell<'a, T> {
    inner: &'a T,
    x: &'a [f64],
    /// The coordinates that move, and by how much at most.
    halves: Vec<(usize, f64)>,
}

impl<T> Cell<'_, T> {
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
        self.inner.residuals(&self.whole(moved))
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
        };
        assert_eq!(cell.bounds(), [[-0.2, 0.2]; 2]);
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        let found = cma_es(&cell, &cell.middle(), 0, 200, go).unwrap();
        let x = cell.whole(&found.x);
        assert!((x[0] - 0.1).abs() < 0.01, "{x:?}");
        assert_eq!(x[1], 2.5);
        assert!((x[2] - 0.05).abs() < 0.01, "{x:?}");
    }
}
