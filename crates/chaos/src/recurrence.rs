//! Recurrence quantification (Zbilut and Webber 1992; Marwan, Romano, Thiel and Kurths 2007).

use crate::bits::{WORD, below};
use crate::error::{Error, checked};
use crate::neighbours::Delays;
use scalar::Scalar;

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
    let (mut above, mut below) = (Columns::new(count), Columns::new(count));
    let mut plot = Plot::new(delays, radius, count);
    for lag in theiler + 1..count {
        let close = plot.along(lag);
        diagonals.add_runs(close);
        // The earlier vector of pair `i` is `i`, the later one `i + lag`.
        below.extend(close, 0, lag, &mut verticals);
        above.shift(lag, &mut verticals);
        above.extend(close, lag, lag, &mut verticals);
    }
    below.end(0, |vector| count - vector, &mut verticals);
    above.end(count - 1, |_| count, &mut verticals);
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

/// The plot, one lag after the other.
struct Plot<'a> {
    delays: &'a Delays<'a>,
    count: usize,
    /// Squared distance from which a pair is not close.
    limit: f64,
    squares: Vec<f64>,
    close: Vec<u64>,
}

impl<'a> Plot<'a> {
    fn new(delays: &'a Delays, radius: f64, count: usize) -> Self {
        Self {
            delays,
            count,
            limit: radius * radius,
            squares: vec![0.0; count + delays.span()],
            close: Vec::with_capacity(count.div_ceil(WORD)),
        }
    }

    /// Which pairs of this lag are close, a bit each.
    fn along(&mut self, lag: usize) -> &[u64] {
        let Self {
            delays,
            count,
            limit,
            squares,
            close,
        } = self;
        let (signal, delay) = (delays.signal, delays.delay);
        let pairs = *count - lag;
        close.resize(pairs.div_ceil(WORD), 0);
        f64::vectorised(
            #[inline(always)]
            || {
                for (square, (a, b)) in squares.iter_mut().zip(signal.iter().zip(&signal[lag..])) {
                    *square = (a - b) * (a - b);
                }
                let mut sums = [0.0; WORD];
                for (place, word) in close.iter_mut().enumerate() {
                    let first = place * WORD;
                    let sums = &mut sums[..WORD.min(pairs - first)];
                    sums.copy_from_slice(&squares[first..first + sums.len()]);
                    for axis in 1..delays.dimension {
                        for (sum, square) in sums.iter_mut().zip(&squares[first + axis * delay..]) {
                            *sum += square;
                        }
                    }
                    *word = below(sums, *limit);
                }
            },
        );
        close
    }
}

/// The lines along columns of the plot that have not ended: a bit for each pair of a lag, and since which lag each
/// vector's is close.
struct Columns {
    open: Vec<u64>,
    since: Vec<usize>,
}

impl Columns {
    fn new(count: usize) -> Self {
        Self {
            open: vec![0; count.div_ceil(WORD)],
            since: vec![0; count],
        }
    }

    /// Goes on to the pairs of this lag; the first of them belongs to the column of vector `first`.
    fn extend(&mut self, close: &[u64], first: usize, lag: usize, lines: &mut Lines) {
        let pairs = self.since.len() - lag;
        for (i, (open, close)) in self.open.iter_mut().zip(close).enumerate() {
            let pairs = pairs - i * WORD;
            let within = if pairs < WORD {
                (1 << pairs) - 1
            } else {
                u64::MAX
            };
            let mut changed = (*open ^ close) & within;
            *open ^= changed;
            while changed != 0 {
                let place = changed.trailing_zeros();
                let since = &mut self.since[first + i * WORD + place as usize];
                match close >> place & 1 {
                    1 => *since = lag,
                    _ => lines.add(lag - *since),
                }
                changed &= changed - 1;
            }
        }
    }

    /// Moves each column to the pair before, where the later vectors of this lag have theirs. The first one ends.
    fn shift(&mut self, lag: usize, lines: &mut Lines) {
        if self.open[0] & 1 == 1 {
            lines.add(lag - self.since[lag - 1]);
        }
        for i in 0..self.open.len() {
            let next = self.open.get(i + 1).map_or(0, |next| next << (WORD - 1));
            self.open[i] = self.open[i] >> 1 | next;
        }
    }

    /// Ends the lines that are open, each at the lag after the last of its vector; the first pair is that of vector `first`.
    fn end(&self, first: usize, after: impl Fn(usize) -> usize, lines: &mut Lines) {
        let is_open = |place: &usize| self.open[place / WORD] >> (place % WORD) & 1 == 1;
        for vector in (0..self.since.len())
            .filter(is_open)
            .map(|place| first + place)
        {
            lines.add(after(vector) - self.since[vector]);
        }
    }
}

/// How many lines there are of each length.
struct Lines(Vec<usize>);

impl Lines {
    fn new(longest: usize) -> Self {
        Self(vec![0; longest + 1])
    }

    fn add(&mut self, length: usize) {
        self.0[length] += 1;
    }

    /// The runs of ones in these words.
    fn add_runs(&mut self, words: &[u64]) {
        let mut run = 0;
        for word in words {
            let (mut rest, mut left) = (*word, u64::BITS);
            while left > 0 {
                let ones = rest.trailing_ones();
                run += ones as usize;
                rest = rest.checked_shr(ones).unwrap_or(0);
                left -= ones;
                if left > 0 {
                    if run > 0 {
                        self.add(run);
                        run = 0;
                    }
                    let zeros = rest.trailing_zeros().min(left);
                    rest = rest.checked_shr(zeros).unwrap_or(0);
                    left -= zeros;
                }
            }
        }
        if run > 0 {
            self.add(run);
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
    fn lines_are_those_of_the_whole_plot() {
        let signal = Noise::White.samples(300, 3);
        let delays = Delays {
            signal: &signal,
            dimension: 2,
            delay: 3,
        };
        let (theiler, radius) = (4, 1.4);
        let count = delays.count();
        let close = |a: usize, b: usize| {
            a.abs_diff(b) > theiler && delays.squared_distance(a, b) < radius * radius
        };
        // Point by point: the lines of a column, and those along a diagonal above the main one.
        let (mut verticals, mut diagonals) = (Lines::new(count), Lines::new(count));
        let runs = |points: &mut dyn Iterator<Item = bool>, lines: &mut Lines| {
            let mut run = 0;
            for close in points.chain([false]) {
                match close {
                    true => run += 1,
                    false if run > 0 => {
                        lines.add(run);
                        run = 0;
                    }
                    false => {}
                }
            }
        };
        for b in 0..count {
            runs(&mut (0..count).map(|a| close(a, b)), &mut verticals);
            runs(&mut (b..count).map(|a| close(a - b, a)), &mut diagonals);
        }
        let found = recurrence(&delays, theiler, radius).unwrap();
        assert_eq!(found.trapping_time, verticals.mean());
        assert_eq!(found.laminarity, verticals.share());
        assert_eq!(found.determinism, diagonals.share());
        assert_eq!(found.longest_diagonal, diagonals.longest());
        assert_eq!(found.diagonal_entropy, diagonals.entropy());
        assert!(found.laminarity > 0.2 && found.rate > 0.2, "{found:?}");
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
