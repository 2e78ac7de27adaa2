//! Correlation dimension (Grassberger and Procaccia 1983).

use crate::bits::{WORD, below};
use crate::error::{Error, checked};
use crate::neighbours::Delays;
use scalar::Scalar;

/// The dimension with a measure of how straight the fit is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrelationDimension {
    /// Slope of the logarithm of the correlation sum against that of the radius.
    pub value: f64,
    /// Standard deviation of the local slopes over the fit.
    pub scatter: f64,
}

/// Vectors that distances are counted from.
const REFERENCES: usize = 500;
/// Correlation sums between which the slope is taken, and the points there.
const LOW: f64 = 5e-4;
const HIGH: f64 = 2e-2;
const POINTS: usize = 9;
/// Distances that are computed at a time.
const AT_A_TIME: usize = 512;

/// The correlation dimension of the delay vectors, from pairs more than `theiler` samples apart.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for `delays` and `theiler`, or vectors of which too many
/// coincide for a slope.
pub fn correlation_dimension(
    delays: &Delays,
    theiler: usize,
) -> Result<CorrelationDimension, Error> {
    checked(delays.signal)?;
    let count = delays.count();
    let needed = delays.span() + 2 * theiler + 100;
    if delays.signal.len() < needed {
        return Err(Error::TooShort {
            found: delays.signal.len(),
            needed,
        });
    }
    let references = || (0..count).step_by(count.div_ceil(REFERENCES));
    let pairs: usize = references()
        .map(|a| count - (a + theiler + 1).min(count) + a.saturating_sub(theiler))
        .sum();
    let rank = |sum: f64| (sum * pairs as f64) as usize;
    let mut nearest = Nearest::new(rank(HIGH) + 1);
    let mut block = [0.0; AT_A_TIME];
    for a in references() {
        let others = [0..a.saturating_sub(theiler), a + theiler + 1..count];
        for (first, end) in others.map(|range| (range.start, range.end)) {
            for start in (first..end).step_by(AT_A_TIME) {
                let block = &mut block[..AT_A_TIME.min(end - start)];
                delays.squared_distances(a, start, block);
                nearest.extend(block);
            }
        }
    }
    // Points (ln r, ln C) at correlation sums in even ratios.
    let sums: [f64; POINTS] =
        std::array::from_fn(|i| LOW * (HIGH / LOW).powf(i as f64 / (POINTS - 1) as f64));
    let squares = nearest.of_ranks(&sums.map(rank));
    let points: Vec<(f64, f64)> = squares
        .iter()
        .zip(sums)
        .map(|(square, sum)| (0.5 * square.ln(), sum.ln()))
        .collect();
    let slopes: Vec<f64> = points
        .windows(2)
        .map(|p| (p[1].1 - p[0].1) / (p[1].0 - p[0].0))
        .collect();
    if slopes.iter().any(|s| !s.is_finite()) {
        return Err(Error::NoScalingRegion {
            reason: "many vectors coincide",
        });
    }
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let square = slopes.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / slopes.len() as f64;
    let rise = points[POINTS - 1].1 - points[0].1;
    let value = rise / (points[POINTS - 1].0 - points[0].0);
    Ok(CorrelationDimension {
        value,
        scatter: square.sqrt(),
    })
}

/// The least of many numbers: long signals have more pairs than fit into memory.
struct Nearest {
    most: usize,
    kept: Vec<f64>,
    /// As many as are wanted are no greater.
    limit: f64,
}

impl Nearest {
    fn new(most: usize) -> Self {
        Self {
            most,
            kept: Vec::with_capacity(2 * most),
            limit: f64::INFINITY,
        }
    }

    fn extend(&mut self, numbers: &[f64]) {
        for numbers in numbers.chunks(WORD) {
            let limit = self.limit;
            let mut less = f64::vectorised(
                #[inline(always)]
                || below(numbers, limit),
            );
            while less != 0 {
                self.push(numbers[less.trailing_zeros() as usize]);
                less &= less - 1;
            }
        }
    }

    fn push(&mut self, number: f64) {
        if self.kept.len() == 2 * self.most {
            let least = self
                .kept
                .select_nth_unstable_by(self.most - 1, f64::total_cmp);
            self.limit = *least.1;
            self.kept.truncate(self.most);
        }
        self.kept.push(number);
    }

    /// Those of these ranks, which ascend, from 0 for the least.
    fn of_ranks(mut self, ranks: &[usize]) -> Vec<f64> {
        let mut left = &mut self.kept[..];
        let mut found: Vec<f64> = ranks
            .iter()
            .rev()
            .map(|rank| {
                let (_, number, _) = left.select_nth_unstable_by(*rank, f64::total_cmp);
                let number = *number;
                left = &mut std::mem::take(&mut left)[..=*rank];
                number
            })
            .collect();
        found.reverse();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, System};

    #[test]
    fn dimensions_of_known_sets() {
        // Grassberger and Procaccia 1983, table 1: Hénon 1.21, Lorenz 2.05. A sine is a circle;
        // white noise fills the three dimensions that it is given.
        let sine: Vec<f64> = (0..6000).map(|i| (f64::from(i) * 0.1).sin()).collect();
        let cases = [
            (System::Henon.samples(6000, 1), 2, 1, 1.21, 0.08),
            (System::Lorenz.samples(6000, 1), 3, 4, 2.05, 0.15),
            (sine, 3, 15, 1.0, 0.05),
            (Noise::White.samples(6000, 1), 3, 1, 3.0, 0.3),
        ];
        for (signal, dimension, delay, expected, tolerance) in cases {
            let delays = Delays {
                signal: &signal,
                dimension,
                delay,
            };
            let found = correlation_dimension(&delays, 20 * delay).unwrap();
            assert!(
                (found.value - expected).abs() < tolerance,
                "{expected} {found:?}"
            );
        }
    }

    #[test]
    fn the_nearest_are_kept() {
        let mut nearest = Nearest::new(5);
        (0..1000).for_each(|i| nearest.extend(&[f64::from(i * 617 % 1000)]));
        assert_eq!(
            nearest.of_ranks(&[0, 1, 3, 3, 4]),
            [0.0, 1.0, 3.0, 3.0, 4.0]
        );
        let mut few = Nearest::new(5);
        few.extend(&[2.0, 1.0]);
        assert_eq!(few.of_ranks(&[0, 1]), [1.0, 2.0]);
    }

    #[test]
    fn coinciding_vectors_are_refused() {
        let signal: Vec<f64> = (0..500).map(|i| f64::from(i % 5)).collect();
        let delays = Delays {
            signal: &signal,
            dimension: 2,
            delay: 1,
        };
        assert!(matches!(
            correlation_dimension(&delays, 2),
            Err(Error::NoScalingRegion { .. })
        ));
    }
}
