//! Means, medians, quartiles and ranks.

/// Half of the interval that holds 95 % of a normal distribution, in standard deviations.
pub const HALF: f64 = 1.96;

/// The value below which the share `part` of the finite values lies, linear between neighbours
/// (Hyndman and Fan 1996, definition 7); none where there is no value.
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut values: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let place = part * values.len().checked_sub(1)? as f64;
    let (below, above) = (place.floor() as usize, place.ceil() as usize);
    Some(values[below] + (values[above] - values[below]) * (place - place.floor()))
}

/// Mean and standard deviation of a sample; the latter 0 for a single value.
pub(crate) fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

/// Spearman's rank correlation of the pairs, equal values sharing their mean rank; none where
/// there are fewer than three pairs or all of one side are equal.
pub(crate) fn rank_correlation(pairs: &[[f64; 2]]) -> Option<f64> {
    let ranks = [0, 1].map(|side| ranks(&pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>()));
    let count = pairs.len() as f64;
    let middle = (count + 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| -> f64 {
        let parts = a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle));
        parts.sum()
    };
    let scale = (product(&ranks[0], &ranks[0]) * product(&ranks[1], &ranks[1])).sqrt();
    (pairs.len() > 2 && scale > 0.0).then(|| product(&ranks[0], &ranks[1]) / scale)
}

/// The rank of each value from 1, equal values sharing their mean.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        for &i in equal {
            ranks[i] = before as f64 + (equal.len() + 1) as f64 / 2.0;
        }
        before += equal.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_between_neighbours() {
        assert_eq!(quantile(&[4.0, 1.0, f64::NAN, 3.0, 2.0], 0.5), Some(2.5));
        assert_eq!(quantile(&[4.0, 1.0, 3.0, 2.0], 0.25), Some(1.75));
        assert_eq!(quantile(&[f64::NAN], 0.5), None);
    }

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        assert_eq!(mean_and_deviation(&[1.0, 2.0, 3.0]), (2.0, 1.0));
        assert_eq!(mean_and_deviation(&[4.0]), (4.0, 0.0));
        assert!(mean_and_deviation(&[]).0.is_nan());
    }

    /// By hand: ranks 1, 2.5, 2.5, 4 and 1, 3, 2, 4 about 2.5 have the products 2.25, 0, 0 and 2.25
    /// and the squares 4.5 and 5.
    #[test]
    fn equal_values_share_their_rank() {
        let pairs = [[1.0, 10.0], [2.0, 30.0], [2.0, 20.0], [9.0, 40.0]];
        let rho = rank_correlation(&pairs).unwrap();
        assert!((rho - 4.5 / 22.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(
            rank_correlation(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]),
            None
        );
        assert_eq!(
            rank_correlation(&[[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]]),
            Some(-1.0)
        );
    }
}
