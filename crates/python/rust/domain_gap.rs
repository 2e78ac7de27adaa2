//! Simulated windows beside measured ones.

use crate::interruptible::interruptible;
use classify::{DomainGap, Matrix, Sample};
use cli::Failure;
use pyo3::prelude::*;
use sweep::domain_gap::between;

/// Columns of numbers, and a name for each row's group.
type Rows = (Vec<Vec<f64>>, Vec<String>);

/// A feature: its name, its area alone, its loss, and both medians.
type Telling = (String, f64, f64, Option<f64>, Option<f64>);

fn sample((columns, groups): Rows) -> Sample {
    Sample {
        values: Matrix::new(columns, groups.len()),
        groups,
    }
}

/// Whether a classifier tells two samples apart: the area under its curve, that of each fold, and the features.
///
/// # Errors
/// Too few groups for so many folds, or Ctrl-C.
#[pyfunction]
pub fn domain_gap(
    py: Python<'_>,
    names: Vec<String>,
    simulated: Rows,
    measured: Rows,
    folds: usize,
    seed: u64,
) -> PyResult<(f64, Vec<f64>, Vec<Telling>)> {
    let gap = interruptible(py, None, |_| {
        let (simulated, measured) = (sample(simulated), sample(measured));
        between(&names, &simulated, &measured, folds, seed).map_err(Failure::input)
    })?;
    let DomainGap {
        auc,
        folds,
        features,
        ..
    } = gap;
    let features = features.into_iter();
    let features = features.map(|f| (f.feature, f.auc, f.loss, f.simulated, f.measured));
    Ok((auc, folds, features.collect()))
}
