//! Recurrence quantification (Zbilut and Webber 1992; Marwan, Romano, Thiel and Kurths 2007).

use crate::error::{Error, checked};
use crate::neighbours::Delays;

/// Measures of the recurrence plot. Lengths are in vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recurrence {
    /// Share of pairs that are close.
    pub rate: f64,
    /// Share of the close pairs in diagonal lines of at least 2.
    pub determinism: f64,
    /// Mean length of these lines.
    pub mean_diagonal: f64,
    /// Length of the longest.
    pub longest_diagonal: usize,
    /// Entropy of their lengths (nats).
    pub diagonal_entropy: f64,
    /// Share of the close pairs in vertical lines of at least 2.
    pub laminarity: f64,
    /// Mean length of the vertical lines.
    pub trapping_time: f64,
}

/// Shortest line.
const SHORTEST: usize = 2;
/// Most vectors in the plot.
pub const MOST_VECTORS: usize = 4000;

/// Measures of the plot of the first [`MOST_VECTORS`] delay vectors. Pairs closer than `radius` count;
/// those within `theiler` samples of each other do not.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for `delays` and `theiler`.
pub fn recurrence(delays: &Delays, theiler: usize, radius: f64) -> Result<Recurrence, Error> {
    checked(delays.signal)?;
    let needed = delays.span() + theiler + 100;
    if delays.signal.len() < needed {
        return Err(Error::TooShort {
            found: delays.signal.len(),
            needed,
        });
    }
    let count = delays.count().min(MOST_VECTORS);
    // One lag after the other. Along a lag run the diagonal lines. From lag to lag the column of a
    // pair's later vector is extended upwards, and that of its earlier vector downwards (which is
    // the row of the same plot mirrored). The band about the diagonal ends a line.
    let mut diagonals = Lines::new(count);
    let mut verticals = Lines::new(count);
    let (mut above, mut below) = (vec![0; count], vec![0; count]);
    let mut squares = vec![0.0; count + delays.span()];
    let mut sums = vec![0.0; count];
    for lag in theiler + 1..count {
        let ends = delays.signal.iter().zip(&delays.signal[lag..]);
        for (square, (a, b)) in squares.iter_mut().zip(ends) {
            *square = (a - b) * (a - b);
        }
        let sums = &mut sums[..count - lag];
        sums.fill(0.0);
        for axis in 0..delays.dimension {
            for (sum, square) in sums.iter_mut().zip(&squares[axis * delays.delay..]) {
                *sum += square;
            }
        }
        let mut along = 0;
        let columns = above[lag..].iter_mut().zip(&mut below);
        for (sum, (above, below)) in sums.iter().zip(columns) {
            let close = *sum < radius * radius;
            diagonals.extend(&mut along, close);
            verticals.extend(above, close);
            verticals.extend(below, close);
        }
        diagonals.extend(&mut along, false);
    }
    for length in above.iter_mut().chain(&mut below) {
        verticals.extend(length, false);
    }
    let pairs = (theiler + 1..count).map(|lag| count - lag).sum::<usize>();
    Ok(Recurrence {
        rate: diagonals.points(1) as f64 / pairs as f64,
        determinism: diagonals.share(),
        mean_diagonal: diagonals.mean(),
        longest_diagonal: diagonals.longest(),
        diagonal_entropy: diagonals.entropy(),
        laminarity: verticals.share(),
        trapping_time: verticals.mean(),
    })
}

/// How many lines there are of each length.
struct Lines(Vec<usize>);

impl Lines {
    fn new(longest: usize) -> Self {
        Self(vec![0; longest + 1])
    }

    /// Makes a line that has `length` points longer, or ends it.
    fn extend(&mut self, length: &mut usize, close: bool) {
        if close {
            *length += 1;
        } else if *length > 0 {
            self.0[*length] += 1;
            *length = 0;
        }
    }

    fn points(&self, shortest: usize) -> usize {
        (shortest..self.0.len())
            .map(|length| length * self.0[length])
            .sum()
    }

    fn count(&self) -> usize {
        self.0[SHORTEST..].iter().sum()
    }

    fn share(&self) -> f64 {
        self.points(SHORTEST) as f64 / self.points(1).max(1) as f64
    }

    fn mean(&self) -> f64 {
        self.points(SHORTEST) as f64 / self.count().max(1) as f64
    }

    fn longest(&self) -> usize {
        (1..self.0.len())
            .rev()
            .find(|&length| self.0[length] > 0)
            .unwrap_or(0)
    }

    fn entropy(&self) -> f64 {
        let count = self.count().max(1) as f64;
        let shares = self.0[SHORTEST..]
            .iter()
            .filter(|n| **n > 0)
            .map(|n| *n as f64 / count);
        shares.map(|p| -p * p.ln()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::Noise;

    #[test]
    fn a_cycle_of_five_is_all_diagonals() {
        let signal: Vec<f64> = (0..200).map(|i| f64::from(i % 5)).collect();
        let delays = Delays {
            signal: &signal,
            dimension: 1,
            delay: 1,
        };
        let found = recurrence(&delays, 0, 0.5).unwrap();
        // Lags 5, 10, ..., 195 are close throughout: 3900 of 19 900 pairs in 39 lines.
        assert!((found.rate - 3900.0 / 19_900.0).abs() < 1e-12, "{found:?}");
        assert_eq!((found.determinism, found.longest_diagonal), (1.0, 195));
        assert!((found.mean_diagonal - 100.0).abs() < 1e-12, "{found:?}");
        assert!(
            (found.diagonal_entropy - 39.0_f64.ln()).abs() < 1e-12,
            "{found:?}"
        );
        assert_eq!((found.laminarity, found.trapping_time), (0.0, 0.0));
    }

    #[test]
    fn white_noise_has_the_determinism_of_chance() {
        // Each pair is close with the probability p on its own, so a close pair stands alone with
        // the probability (1 - p)^2.
        let signal = Noise::White.samples(1500, 1);
        let delays = Delays {
            signal: &signal,
            dimension: 1,
            delay: 1,
        };
        let found = recurrence(&delays, 0, 0.2).unwrap();
        let chance = 1.0 - (1.0 - found.rate).powi(2);
        assert!(
            (found.determinism - chance).abs() < 0.02,
            "{found:?} {chance}"
        );
    }
}
