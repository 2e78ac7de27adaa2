//! What is known of a parameter before the recordings are looked at.
//!
//! A search compares much at once: without it, parameters that the recordings hardly show wander off and imitate clearances. The
//! intervals of the results do not rest on it.

use crate::optimiser::LeastSquares;
use nalgebra::DMatrix;

/// Standard deviation of the logarithm of a machine's own parameter before the recordings are looked at: design values are 10 to
/// 40 % off.
pub const DESIGN: f64 = 0.3;

/// A normal distribution of a coordinate around 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// The coordinate.
    pub place: usize,
    /// Its standard deviation.
    pub spread: f64,
}

impl Prior {
    fn residual(&self, x: &[f64]) -> f64 {
        x[self.place] / self.spread
    }
}

/// The sum of squares that priors add at `x`.
pub(crate) fn squares(priors: &[Prior], x: &[f64]) -> f64 {
    priors.iter().map(|p| p.residual(x).powi(2)).sum()
}

/// Residuals, and those of the priors.
pub struct WithPriors<'a, T> {
    /// What is compared with the recordings.
    pub inner: &'a T,
    /// What is known before.
    pub priors: &'a [Prior],
}

impl<T: LeastSquares> LeastSquares for WithPriors<'_, T> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.inner.bounds()
    }

    fn count(&self) -> usize {
        self.inner.count() + self.priors.len()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.residuals_of_all(&[x.to_vec()]).concat()
    }

    fn residuals_of_all(&self, all: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut residuals = self.inner.residuals_of_all(all);
        for (residuals, x) in residuals.iter_mut().zip(all) {
            residuals.extend(self.priors.iter().map(|prior| prior.residual(x)));
        }
        residuals
    }

    fn mixed(&self, all: &[Vec<f64>], first: usize) -> Vec<(Vec<f64>, f64)> {
        let mixed = self.inner.mixed(all, first).into_iter();
        let with_priors = |(x, left): (Vec<f64>, f64)| {
            let left = left + squares(self.priors, &x);
            (x, left)
        };
        mixed.map(with_priors).collect()
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let inner = self.inner.jacobian(x);
        let rows = inner.nrows();
        let mut all = inner.resize(rows + self.priors.len(), x.len(), 0.0);
        for (row, prior) in self.priors.iter().enumerate() {
            all[(rows + row, prior.place)] = 1.0 / prior.spread;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::Progress;
    use crate::secant::secant;
    use std::ops::ControlFlow;

    /// One measurement of the sum of two values.
    struct Sum;

    impl LeastSquares for Sum {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-5.0, 5.0]; 2]
        }
        fn count(&self) -> usize {
            1
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            vec![x[0] + x[1] - 1.0]
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(1, 2, &[1.0, 1.0])
        }
    }

    #[test]
    fn what_is_not_identifiable_stays_where_the_prior_has_it() {
        let priors = [Prior {
            place: 1,
            spread: 0.5,
        }];
        let both = WithPriors {
            inner: &Sum,
            priors: &priors,
        };
        assert_eq!(both.residuals(&[0.5, 0.75]), [0.25, 1.5]);
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        let found = secant(&both, &[3.0, 2.0], 1e-12, 100, go);
        assert!(
            (found.x[0] - 1.0).abs() < 1e-6 && found.x[1].abs() < 1e-6,
            "{found:?}"
        );
        assert_eq!(squares(&priors, &[9.0, 1.0]), 4.0);
    }
}
