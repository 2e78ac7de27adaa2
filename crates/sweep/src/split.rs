//! Which split a case belongs to.

use std::cmp::Ordering;
use std::collections::BTreeMap;

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
    Split::ALL[choose(&shares, unit(draw(seed, group)))]
}

/// The split of each group of `strata`, each of which holds the groups of one label.
///
/// 1. A split gets as many groups as its share of all, rounded by the largest remainders.
/// 2. The largest split gets what the others leave. Each of the others first gets one group of every
///    stratum that has enough for all splits, the larger strata first, then continues by the method of
///    Sainte-Laguë (1910): each further group comes from the stratum with the largest n/(2k + 1), n
///    being its groups and k those that the split has of it.
/// 3. Which groups of a stratum go where is drawn, from the seed and the group.
pub fn stratify(strata: &[Vec<u64>], shares: [f64; 3], seed: u64) -> BTreeMap<u64, Split> {
    let mut strata: Vec<Stratum> = strata.iter().map(|s| Stratum::new(s, seed)).collect();
    let all = strata.iter().map(|stratum| stratum.groups.len()).sum();
    let seats = seats(shares, all);
    let mut order: Vec<usize> = (0..shares.len()).filter(|&i| shares[i] > 0.0).collect();
    // The sort keeps the order of equal shares.
    order.sort_by(|&a, &b| shares[a].total_cmp(&shares[b]));
    let mut splits = BTreeMap::new();
    for (served, &split) in order.iter().enumerate() {
        let later = order.len() - served - 1;
        for stratum in &mut strata {
            stratum.of_split = 0;
        }
        for _ in 0..seats[split] {
            let next = strata.iter_mut().max_by(|a, b| a.claim(later, b));
            let Some(stratum) = next else { break };
            if let Some(&(_, group)) = stratum.groups.get(stratum.taken) {
                splits.insert(group, Split::ALL[split]);
                stratum.taken += 1;
                stratum.of_split += 1;
            }
        }
    }
    splits
}

/// The groups of one label, while they are given to the splits.
struct Stratum {
    /// Each with its draw, in the order of the draws.
    groups: Vec<(u64, u64)>,
    /// How many of them are given away, and how many of those to the split at hand.
    taken: usize,
    of_split: usize,
}

impl Stratum {
    fn new(groups: &[u64], seed: u64) -> Self {
        let mut groups: Vec<(u64, u64)> = groups.iter().map(|&g| (draw(seed, g), g)).collect();
        groups.sort_unstable();
        Self {
            groups,
            taken: 0,
            of_split: 0,
        }
    }

    /// Compares whose group comes next, where `later` splits are still to come: greater comes first.
    fn claim(&self, later: usize, other: &Self) -> Ordering {
        let left = |s: &Self| s.groups.len() - s.taken;
        let has_room = |s: &Self| left(s) > later;
        let is_new = |s: &Self| has_room(s) && s.of_split == 0;
        let quotient = |s: &Self| s.groups.len() as f64 / (2 * s.of_split + 1) as f64;
        let next = |s: &Self| s.groups.get(s.taken).map(|(draw, _)| *draw);
        (left(self) > 0)
            .cmp(&(left(other) > 0))
            .then(has_room(self).cmp(&has_room(other)))
            .then(is_new(self).cmp(&is_new(other)))
            .then(quotient(self).total_cmp(&quotient(other)))
            // Of equal strata the one that has given less, then the draws.
            .then(other.taken.cmp(&self.taken))
            .then(next(self).cmp(&next(other)))
    }
}

/// How many of `all` each share is, by the largest remainders; of equal ones the first.
fn seats(shares: [f64; 3], all: usize) -> [usize; 3] {
    let total: f64 = shares.iter().sum();
    let exact = shares.map(|share| share / total * all as f64);
    // A share such as 0.15 of 20 is 3 but for rounding.
    let whole = exact.map(|n| (n + ROUNDING).floor() as usize);
    let mut order = [0, 1, 2];
    let remainder = |i: usize| exact[i] - whole[i] as f64;
    order.sort_by(|&a, &b| remainder(b).total_cmp(&remainder(a)));
    let mut seats = whole;
    for &i in order.iter().take(all - whole.iter().sum::<usize>()) {
        seats[i] += 1;
    }
    seats
}

/// What rounding may take from a whole number of groups.
const ROUNDING: f64 = 1e-6;

fn draw(seed: u64, group: u64) -> u64 {
    stream(seed, group, Purpose::Split).next_u64()
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

    /// Groups of each stratum in each split.
    fn counts(sizes: &[u64], shares: [f64; 3], seed: u64) -> Vec<[usize; 3]> {
        let number = |stratum: usize, i: u64| 1000 * stratum as u64 + i;
        let strata: Vec<Vec<u64>> = sizes
            .iter()
            .enumerate()
            .map(|(stratum, &size)| (0..size).map(|i| number(stratum, i)).collect())
            .collect();
        let splits = stratify(&strata, shares, seed);
        assert_eq!(splits.len() as u64, sizes.iter().sum::<u64>());
        let count = |stratum: &Vec<u64>| {
            let of = |split| stratum.iter().filter(|g| splits[*g] == split).count();
            Split::ALL.map(of)
        };
        strata.iter().map(count).collect()
    }

    #[test]
    fn every_stratum_with_room_is_in_every_split() {
        let shares = [0.7, 0.15, 0.15];
        for seed in 0..50 {
            // Proportional where that is possible.
            let even = counts(&[20, 40, 100], shares, seed);
            assert_eq!(even, [[14, 3, 3], [28, 6, 6], [70, 15, 15]]);
            // A small one has its place in every split; the totals stay those of the shares.
            let small = counts(&[3, 9, 9], shares, seed);
            assert_eq!(small[0], [1, 1, 1]);
            assert_eq!(small.iter().map(|n| n[0]).sum::<usize>(), 15);
            // One of two is kept to learn from, one of one is where the shares have a place.
            let pairs = counts(&[2, 30], shares, seed);
            assert!(pairs[0][0] >= 1, "{pairs:?}");
            let single = counts(&[1; 20], shares, seed);
            let sum = |i: usize| single.iter().map(|n| n[i]).sum::<usize>();
            assert_eq!([sum(0), sum(1), sum(2)], [14, 3, 3]);
        }
        // Equal strata that not all have a place are chosen by the seed.
        let who = |seed| counts(&[3; 7], shares, seed);
        assert!((1..20).any(|seed| who(seed) != who(0)));
        assert_eq!(counts(&[5, 5], [1.0, 0.0, 0.0], 0), [[5, 0, 0]; 2]);
        assert_eq!(counts(&[4, 4], [0.5, 0.0, 0.5], 0), [[2, 0, 2]; 2]);
        assert!(counts(&[], shares, 0).is_empty());
    }
}
