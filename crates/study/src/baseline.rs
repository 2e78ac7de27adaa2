//! How well a classifier that is trained on a dataset does on its other cases.

use crate::Error;
use classify::{Baseline, Sample};
use sweep::reader::Dataset;

/// Windows that are trained on, and tested: the work grows with them, and the shares do not.
const MOST: usize = 2000;

/// Gradient boosting on the features, trained on the split `train` and tested on `test`, or on `validation` where there is no
/// test; none where either is missing or there is one class alone.
///
/// # Errors
/// A table that cannot be read.
pub fn baseline(dataset: &Dataset) -> Result<Option<Baseline>, Error> {
    let splits = dataset.splits();
    let split = |name: &str| splits.iter().find(|split| *split == name);
    let tested = split("test").or(split("validation"));
    let (Some(trained), Some(tested)) = (split("train"), tested) else {
        return Ok(None);
    };
    let [train, test] = [trained, tested].map(|split| some(dataset, split));
    let ((train, of), (test, truth)) = (train?, test?);
    Ok(classify::baseline((&train, &of), (&test, &truth)))
}

/// So many rows of a split as are worked on, evenly over all, with their faults.
fn some(dataset: &Dataset, split: &str) -> Result<(Sample, Vec<String>), Error> {
    let all = dataset.sample(Some(split), "fault")?;
    let step = all.labels.len().div_ceil(MOST).max(1);
    let rows: Vec<usize> = (0..all.labels.len()).step_by(step).collect();
    let pick = |names: &[String]| rows.iter().map(|row| names[*row].clone()).collect();
    let sample = Sample {
        values: all.sample.values.select(&rows),
        groups: pick(&all.sample.groups),
    };
    Ok((sample, pick(&all.labels)))
}
