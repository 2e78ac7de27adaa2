//! A region of the coordinates that is searched without derivatives.

use crate::error::Error;
use crate::likelihood::FAILED;
use crate::optimiser::{LeastSquares, Progress, Watch, cma_es};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Half the width of a region along a coordinate that has a prior, in standard deviations of that.
pub const SPREADS: f64 = 2.0;

/// What is compared, with some of the coordinates within a region and the others held.
pub struct Region<'a, T> {
    inner: &'a T,
    x: Vec<f64>,
    /// The coordinates that move, and between what.
    ranges: Vec<(usize, [f64; 2])>,
    /// Residuals that were found so far: a search that goes on repeats its way.
    known: Mutex<HashMap<Vec<u64>, Vec<f64>>>,
}

impl<'a, T: LeastSquares> Region<'a, T> {
    /// The region around `x`, a coordinate each, in which the coordinates of these places move within these ranges. Where the
    /// bounds of `inner` are narrower, they count; what cannot move within both is held.
    pub fn new(inner: &'a T, x: &[f64], ranges: &[(usize, [f64; 2])]) -> Self {
        let bounds = inner.bounds();
        let within = |(place, [low, high]): &(usize, [f64; 2])| {
            let [least, greatest] = bounds[*place];
            let range = [low.max(least), high.min(greatest)];
            (range[0] < range[1]).then_some((*place, range))
        };
        Self {
            inner,
            x: x.to_vec(),
            ranges: ranges.iter().filter_map(within).collect(),
            known: Mutex::default(),
        }
    }

    fn bounds(&self) -> Vec<[f64; 2]> {
        self.ranges.iter().map(|(_, range)| *range).collect()
    }

    fn all_known(&self) -> MutexGuard<'_, HashMap<Vec<u64>, Vec<f64>>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn known(&self, moved: &[f64]) -> Option<Vec<f64>> {
        self.all_known().get(&bits(moved)).cloned()
    }

    /// How many coordinates move.
    pub fn dimensions(&self) -> usize {
        self.ranges.len()
    }

    /// The best of so many evaluations (CMA-ES, Hansen 2016), from where the region is around: the coordinates that move. More
    /// evaluations continue a search of fewer. `watch` is told after each generation.
    ///
    /// The points of a generation are evaluated together, though a search asks for one after another: it is begun again for
    /// each generation, finds all before that known, and notes the points that it asks for then.
    ///
    /// # Errors
    /// As [`cma_es`].
    pub fn searched(&self, most: u64, watch: Watch) -> Result<Progress, Error> {
        let start = |(place, [low, high]): &(usize, [f64; 2])| self.x[*place].clamp(*low, *high);
        let start: Vec<f64> = self.ranges.iter().map(start).collect();
        loop {
            let ahead = Ahead {
                region: self,
                asked: RefCell::default(),
            };
            let mut until_drawn = |_: &Progress| match ahead.is_drawn() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let progress = cma_es(&ahead, &start, 0, most, &mut until_drawn)?;
            let asked = ahead.asked.into_inner();
            if asked.is_empty() || watch(&progress).is_break() {
                return Ok(progress);
            }
            self.evaluate(asked);
        }
    }

    /// Finds the residuals at these points, which are not known.
    fn evaluate(&self, points: Vec<Vec<f64>>) {
        let whole: Vec<Vec<f64>> = points.iter().map(|moved| self.whole(moved)).collect();
        let found = self.inner.residuals_of_all(&whole);
        let points = points.iter().map(|moved| bits(moved));
        self.all_known().extend(points.zip(found));
    }

    /// All coordinates, with these in the places that move.
    pub fn whole(&self, moved: &[f64]) -> Vec<f64> {
        let mut x = self.x.clone();
        for ((place, _), moved) in self.ranges.iter().zip(moved) {
            x[*place] = *moved;
        }
        x
    }
}

/// A region of which only what is known is evaluated.
struct Ahead<'a, T> {
    region: &'a Region<'a, T>,
    /// The other points that were asked for.
    asked: RefCell<Vec<Vec<f64>>>,
}

impl<T: LeastSquares> Ahead<'_, T> {
    /// Whether a generation of the usual size was asked for (Hansen 2016, eq. 48), and its mean.
    fn is_drawn(&self) -> bool {
        let dimensions = self.region.dimensions() as f64;
        let generation = 4.0 + (3.0 * dimensions.ln()).floor();
        self.asked.borrow().len() > generation as usize
    }
}

impl<T: LeastSquares> LeastSquares for Ahead<'_, T> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.region.bounds()
    }

    fn count(&self) -> usize {
        self.region.inner.count()
    }

    /// What is not known is not the best.
    fn residuals(&self, moved: &[f64]) -> Vec<f64> {
        self.region.known(moved).unwrap_or_else(|| {
            self.asked.borrow_mut().push(moved.to_vec());
            vec![FAILED; self.count()]
        })
    }

    fn jacobian(&self, moved: &[f64]) -> DMatrix<f64> {
        let all = self.region.inner.jacobian(&self.region.whole(moved));
        all.select_columns(self.region.ranges.iter().map(|(place, _)| place))
    }
}

/// The bits of coordinates, which are equal where these are the same.
fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    /// A valley of many ripples, whose bottom is at (0.1, 2, 0.05); and how many points were asked for at a time.
    #[derive(Default)]
    struct Ripples(RefCell<Vec<usize>>);

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
        fn residuals_of_all(&self, all: &[Vec<f64>]) -> Vec<Vec<f64>> {
            self.0.borrow_mut().push(all.len());
            all.iter().map(|x| self.residuals(x)).collect()
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(4, 3)
        }
    }

    fn go(_: &Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[test]
    fn the_points_of_a_generation_are_evaluated_together_and_the_search_is_the_same() {
        let ripples = Ripples::default();
        let all = ripples.bounds();
        let start = [0.0, 2.5, 0.0];
        let region = Region::new(&ripples, &start, &[(0, all[0]), (1, all[1]), (2, all[2])]);
        let together = region.searched(100, &mut go).unwrap();
        assert_eq!(together, cma_es(&ripples, &start, 0, 100, &mut go).unwrap());
        // Seven points and their mean; what is left at the end.
        let calls = ripples.0.borrow();
        assert_eq!(calls[..], [[8; 12].as_slice(), &[4]].concat());
    }

    #[test]
    fn the_bottom_of_a_region_is_found_without_derivatives_and_what_is_held_stays() {
        let ranges = [(0, [-0.2, 0.2]), (1, [3.5, 4.0]), (2, [-5.0, 0.2])];
        let ripples = Ripples::default();
        let region = Region::new(&ripples, &[0.0, 2.5, 0.0], &ranges);
        assert_eq!(region.bounds(), [[-0.2, 0.2], [-1.0, 0.2]]);
        let x = region.whole(&region.searched(300, &mut go).unwrap().x);
        assert!((x[0] - 0.1).abs() < 0.01, "{x:?}");
        assert_eq!(x[1], 2.5);
        assert!((x[2] - 0.05).abs() < 0.01, "{x:?}");
    }
}
