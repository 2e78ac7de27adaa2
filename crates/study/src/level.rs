//! A level of a signal, with what another recording of the same machine may differ by.

use crate::statistics::mean_and_deviation;
use std::cmp::Ordering;

/// Two levels differ if they are more than this many standard deviations of their difference apart:
/// chance alone does that in one of twenty comparisons.
const SURE: f64 = 2.0;
/// Levels within this share of one another are equal for any spread: the amplitude linearity
/// that data sheets of industrial accelerometers state is 1 %.
const LINEARITY: f64 = 0.01;

/// How large something is, and the standard deviation of this value over recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// The value of the recording at hand.
    pub value: f64,
    /// Its standard deviation from one recording to the next; 0 where nothing is known of it.
    pub spread: f64,
}

impl Level {
    /// The largest of the peaks of equally long parts. Its spread is that of the parts' peaks: the
    /// scale of a largest value does not depend on how many it is the largest of (Gumbel 1958).
    pub fn largest(peaks: &[f64]) -> Self {
        Self {
            value: peaks.iter().copied().fold(0.0, f64::max),
            spread: mean_and_deviation(peaks).1,
        }
    }

    /// The root of the mean of the mean squares of equally long parts: σ(√m) = σ(m)/(2√m).
    pub fn root_mean(squares: &[f64]) -> Self {
        let count = squares.len().max(1) as f64;
        let value = (squares.iter().sum::<f64>() / count).sqrt();
        let spread = mean_and_deviation(squares).1 / count.sqrt() / (2.0 * value);
        Self {
            value,
            spread: if spread.is_finite() { spread } else { 0.0 },
        }
    }

    /// Whether it is smaller than the other, larger, or neither within the spread of two recordings.
    pub fn against(self, other: Self) -> Ordering {
        let chance = SURE * self.spread.hypot(other.spread);
        let linearity = LINEARITY * self.value.abs().max(other.value.abs());
        let difference = self.value - other.value;
        if difference.abs() > chance.max(linearity) {
            difference.total_cmp(&0.0)
        } else {
            Ordering::Equal
        }
    }

    /// Whether it is larger than the other by more than chance.
    pub fn exceeds(self, other: Self) -> bool {
        self.against(other) == Ordering::Greater
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_chance_gives_is_equal() {
        let level = |value, spread| Level { value, spread };
        // 82.31 and 82.34 read the same, 206.2 and 206.4 as well.
        assert_eq!(
            level(82.31, 0.0).against(level(82.34, 0.0)),
            Ordering::Equal
        );
        assert_eq!(
            level(206.4, 0.0).against(level(206.2, 0.0)),
            Ordering::Equal
        );
        // 20 % apart, but so are two recordings of either.
        assert_eq!(
            level(120.0, 15.0).against(level(100.0, 15.0)),
            Ordering::Equal
        );
        assert_eq!(
            level(120.0, 1.0).against(level(100.0, 1.0)),
            Ordering::Greater
        );
        assert!(level(100.0, 1.0).against(level(120.0, 1.0)).is_lt());
        assert!(!level(f64::NAN, 0.0).exceeds(level(1.0, 0.0)));
    }

    #[test]
    fn the_spread_is_that_of_the_parts() {
        let level = Level::largest(&[3.0, 5.0, 4.0]);
        assert_eq!((level.value, level.spread), (5.0, 1.0));
        let level = Level::root_mean(&[9.0, 9.0, 9.0, 9.0]);
        assert_eq!((level.value, level.spread), (3.0, 0.0));
        // Mean 25, deviation 7 of the squares: 7/√2 of their mean, a tenth of it for the root.
        let level = Level::root_mean(&[25.0 - 4.949_747, 25.0 + 4.949_747]);
        assert!((level.value - 5.0).abs() < 1e-9 && (level.spread - 0.494_974_7).abs() < 1e-5);
        assert_eq!(Level::largest(&[2.0]).spread, 0.0);
    }
}
