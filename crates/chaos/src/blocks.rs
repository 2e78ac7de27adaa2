//! Means of successive blocks of a series, for the standard error of its mean.

/// Blocks of a series.
pub(crate) const BLOCKS: usize = 20;

/// The means of [`BLOCKS`] blocks of equal length; what is left over at the end makes further blocks of that
/// length. A series of fewer values has one block per value.
pub(crate) fn block_means(series: &[f64]) -> Vec<f64> {
    let length = (series.len() / BLOCKS).max(1);
    series.chunks_exact(length).map(mean).collect()
}

/// The mean of some values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
