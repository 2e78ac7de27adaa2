//! What a value would close of a misfit, to first order.

use crate::likelihood::misfit;
use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the greatest are rounding.
const RANK: f64 = 1e-9;

/// The first columns, and the others.
pub(crate) fn split(jacobian: &DMatrix<f64>, known: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let doubted = jacobian.ncols() - known;
    let part = |first, count| jacobian.columns(first, count).into_owned();
    (part(0, known), part(known, doubted))
}

/// What each value in doubt promises to first order, the known parameters adapting. It is the misfit that it leaves,
/// and the length of the part of its derivative that they cannot imitate. None for a value without any effect.
///
/// A column of `known` and of `doubted` is the derivative of the residuals by one value.
pub(crate) fn promises(
    residuals: &DVector<f64>,
    known: DMatrix<f64>,
    doubted: &DMatrix<f64>,
) -> Vec<Option<(f64, f64)>> {
    let svd = known.svd(true, false);
    let least = RANK * svd.singular_values.max();
    let directions = svd.u.into_iter().flat_map(|u| {
        let kept = (0..u.ncols()).filter(|i| svd.singular_values[*i] > least);
        kept.map(|i| u.column(i).into_owned()).collect::<Vec<_>>()
    });
    let directions: Vec<DVector<f64>> = directions.collect();
    let free = |v: DVector<f64>| {
        let along = directions.iter();
        along.fold(v, |v, u| {
            let share = u.dot(&v);
            v - u * share
        })
    };
    let left = free(residuals.clone());
    let of = |column: DVector<f64>| {
        let own = free(column.clone());
        let length = own.norm();
        (length > RANK * column.norm()).then(|| {
            let step = -own.dot(&left) / length.powi(2);
            let after = &left + &own * step;
            (misfit(after.as_slice()), length)
        })
    };
    let columns = doubted.column_iter().map(|column| column.into_owned());
    columns.map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_promises_what_the_known_ones_cannot_close() {
        // The residuals are 3 along the first axis, which is known, and 4 along the second.
        let residuals = DVector::from_vec(vec![3.0, 4.0, 0.0]);
        let known = DMatrix::from_column_slice(3, 1, &[2.0, 0.0, 0.0]);
        let doubted =
            DMatrix::from_column_slice(3, 3, &[1.0, 1.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
        let promises = promises(&residuals, known, &doubted);
        let (misfit, length) = promises[0].unwrap();
        assert!(misfit < 1e-12 && (length - 1.0).abs() < 1e-12);
        assert!(promises[1].is_none());
        let (misfit, _) = promises[2].unwrap();
        assert!((misfit - 4.0 / 3.0_f64.sqrt()).abs() < 1e-12);
    }
}
