//! Which split a case belongs to.

use rand::Rng;
use scalar::random::{Purpose, stream};

use crate::design::hash::unit;
use crate::distribution::choose;

/// A part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Split {
    /// To learn from.
    Train,
    /// To choose between models.
    Validation,
    /// To judge the chosen one.
    Test,
}

impl Split {
    /// All of them.
    pub const ALL: [Split; 3] = [Split::Train, Split::Validation, Split::Test];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Split::Train => "train",
            Split::Validation => "validation",
            Split::Test => "test",
        }
    }
}

/// The split of every case of `group`, by shares in the order of [`Split::ALL`].
///
/// It depends on the seed and the group alone, so cases of one group never part, and adding cases
/// to a sweep moves none of the others.
pub fn assign(shares: [f64; 3], seed: u64, group: u64) -> Split {
    let draw = stream(seed, group, Purpose::Split).next_u64();
    Split::ALL[choose(&shares, unit(draw))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_met_and_empty_splits_stay_empty() {
        let count = |shares| {
            let mut counts = [0; 3];
            for group in 0..10_000 {
                counts[assign(shares, 1, group) as usize] += 1;
            }
            counts
        };
        let [train, validation, test] = count([0.7, 0.15, 0.15]);
        // Four standard deviations of the binomial distribution: 183, 143, 143.
        assert!((train - 7000_i32).abs() < 183, "{train}");
        assert!((validation - 1500_i32).abs() < 143, "{validation}");
        assert!((test - 1500_i32).abs() < 143, "{test}");
        assert_eq!(count([1.0, 0.0, 0.0]), [10_000, 0, 0]);
        assert_eq!(count([0.5, 0.0, 0.5])[1], 0);
    }
}
