//! What calibrated parameters can imitate: the nuisance of a score test, projected out.

use nalgebra::{DMatrix, DVector};

/// Takes from residuals what a step of the calibrated parameters can, with a prior of one unit of
/// their coordinates.
pub(crate) struct Projector {
    jacobian: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl Projector {
    /// Of calibrated parameters with these derivatives: a row per residual, a column per parameter.
    pub fn new(jacobian: &DMatrix<f64>) -> Self {
        let count = jacobian.ncols();
        let mut normal = jacobian.tr_mul(jacobian);
        for i in 0..count {
            normal[(i, i)] += 1.0;
        }
        Self {
            jacobian: jacobian.clone(),
            inverse: normal
                .try_inverse()
                .unwrap_or_else(|| DMatrix::zeros(count, count)),
        }
    }

    /// What they cannot imitate of a residual.
    pub fn apply(&self, residual: &DVector<f64>) -> DVector<f64> {
        let step = &self.inverse * self.jacobian.tr_mul(residual);
        residual - &self.jacobian * step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_parameters_can_imitate_is_taken_out() {
        let jacobian = DMatrix::from_row_slice(3, 1, &[1e4, 0.0, 1e4]);
        let projector = Projector::new(&jacobian);
        let left = projector.apply(&DVector::from_vec(vec![2.0, 5.0, 4.0]));
        // The mean of the first and the last is a step of the parameter.
        for (left, expected) in left.iter().zip([-1.0, 5.0, 1.0]) {
            assert!((left - expected).abs() < 1e-6, "{left}");
        }
    }

    #[test]
    fn a_weak_parameter_imitates_no_more_than_its_prior_lets_it() {
        let jacobian = DMatrix::from_row_slice(2, 1, &[1e-3, 0.0]);
        let left = Projector::new(&jacobian).apply(&DVector::from_vec(vec![3.0, 1.0]));
        assert!((left[0] - 3.0).abs() < 1e-5);
    }
}
