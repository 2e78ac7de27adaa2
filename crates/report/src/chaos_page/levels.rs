//! The values of an axis as a few names.

/// Values that an axis of names can hold; with more it has bins.
const MOST_LEVELS: usize = 12;
const BINS: usize = 8;

/// The places of an axis: single values, or bins of equal width.
pub(super) struct Levels {
    /// Single values, or the lower edges of bins.
    lows: Vec<f64>,
    /// Width of a bin; 0 for single values.
    pub(super) width: f64,
}

impl Levels {
    /// Of all finite values.
    pub(super) fn from_values(values: impl Iterator<Item = f64>) -> Self {
        let mut lows: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        lows.sort_by(f64::total_cmp);
        lows.dedup();
        if lows.len() <= MOST_LEVELS {
            return Self { lows, width: 0.0 };
        }
        let (low, high) = (lows[0], lows[lows.len() - 1]);
        let width = (high - low) / BINS as f64;
        Self {
            lows: (0..BINS).map(|i| low + width * i as f64).collect(),
            width,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.lows.len()
    }

    /// Where the value belongs.
    pub(super) fn index(&self, value: f64) -> Option<usize> {
        if self.width == 0.0 {
            return self.lows.iter().position(|low| *low == value);
        }
        let at = self.lows.partition_point(|low| *low <= value);
        at.checked_sub(1).filter(|_| value.is_finite())
    }

    /// The values, or the middles of the bins, times `factor`.
    pub(super) fn names(&self, factor: f64) -> Vec<String> {
        let digits = if self.width == 0.0 { 4 } else { 2 };
        let middles = self
            .lows
            .iter()
            .map(|low| (low + 0.5 * self.width) * factor);
        middles.map(|middle| text::number(middle, digits)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_are_levels_and_many_are_bins() {
        let few = Levels::from_values([3e-4, 1e-4, 3e-4, f64::NAN].into_iter());
        assert_eq!(few.names(1e3), ["0.1", "0.3"]);
        assert_eq!((few.index(3e-4), few.index(2e-4)), (Some(1), None));
        let many = Levels::from_values((0..=80).map(f64::from));
        assert_eq!((many.count(), many.width), (8, 10.0));
        let places = [0.0, 9.9, 10.0, 80.0].map(|v| many.index(v));
        assert_eq!(places, [Some(0), Some(0), Some(1), Some(7)]);
        assert_eq!(many.names(1.0)[0], "5");
        assert_eq!(Levels::from_values(std::iter::empty()).count(), 0);
    }
}
