//! Bins of equal width, and how many values are in each.

const MOST_BINS: usize = 30;

/// Edges of equal bins from the lowest to the highest of the finite values; none where there are no values. There are 2∛n
/// bins for n values (D. Lane's rule of Rice University), and not too many.
pub(crate) fn edges(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (mut low, mut high, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0_usize);
    for value in finite {
        (low, high, count) = (low.min(value), high.max(value), count + 1);
    }
    if low > high {
        return Vec::new();
    }
    let bins = (2.0 * (count as f64).cbrt()).ceil() as usize;
    let bins = bins.min(MOST_BINS);
    let (low, width) = match high > low {
        true => (low, (high - low) / bins as f64),
        false => (low - 0.5, 1.0 / bins as f64),
    };
    (0..=bins).map(|i| low + width * i as f64).collect()
}

/// How many of the finite values lie between each two edges. A value on an edge is above it, and the highest edge closes the
/// last bin.
pub(crate) fn counts(edges: &[f64], values: impl Iterator<Item = f64>) -> Vec<usize> {
    let bins = edges.len().saturating_sub(1);
    let mut counts = vec![0; bins];
    if bins == 0 {
        return counts;
    }
    let (low, width) = (edges[0], edges[1] - edges[0]);
    for value in values.filter(|value| value.is_finite()) {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(values: &[f64]) -> (Vec<f64>, Vec<usize>) {
        let edges = edges(values.iter().copied());
        let counts = counts(&edges, values.iter().copied());
        (edges, counts)
    }

    #[test]
    fn every_finite_value_falls_into_one_bin() {
        let values = (0..=300).map(|i| f64::from(i) * 0.1).chain([f64::NAN]);
        let (edges, counts) = counted(&values.collect::<Vec<f64>>());
        assert_eq!((edges[0], edges[edges.len() - 1].round()), (0.0, 30.0));
        assert_eq!(counts.iter().sum::<usize>(), 301);
        assert_eq!(counted(&[2.0, 2.0]).1.iter().sum::<usize>(), 2);
        assert!(counted(&[f64::INFINITY]).1.is_empty());
    }
}
