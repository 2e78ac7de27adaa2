//! Latin hypercube sampling (McKay, Beckman and Conover 1979), point by point.
//!
//! Each dimension is cut into as many strata as there are points, and a random permutation says
//! which point falls into which stratum. The permutation is computed, not stored: a Feistel
//! network (Luby and Rackoff 1988) permutes the whole numbers below a power of four, and walking
//! along its cycle until the number is below `count` permutes those (Black and Rogaway 2002).

use super::hash::{hash, unit};

/// Rounds of the Feistel network; four suffice in theory, more help where the halves are short.
const ROUNDS: u64 = 8;

/// Coordinate `dimension` of point `index` of `count`, in (0, 1). `index` must be below `count`.
pub fn point(seed: u64, index: u64, count: u64, dimension: usize) -> f64 {
    let key = hash(&[seed, dimension as u64]);
    let stratum = permute(key, index, count);
    (stratum as f64 + unit(hash(&[key, index, ROUNDS]))) / count as f64
}

/// Where the permutation of `0..count` with this `key` takes `index`.
fn permute(key: u64, index: u64, count: u64) -> u64 {
    let half_bits = (64 - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mut value = index;
    loop {
        value = feistel(key, value, half_bits);
        if value < count {
            return value;
        }
    }
}

/// A permutation of the whole numbers below 4^`half_bits`.
fn feistel(key: u64, value: u64, half_bits: u32) -> u64 {
    let mask = (1 << half_bits) - 1;
    let (mut left, mut right) = (value >> half_bits, value & mask);
    for round in 0..ROUNDS {
        (left, right) = (right, left ^ (hash(&[key, round, right]) & mask));
    }
    left << half_bits | right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_of_every_dimension_holds_one_point() {
        for count in [1, 2, 3, 10, 64, 1000] {
            for dimension in [0, 5, 200] {
                let mut hit = vec![false; count as usize];
                for index in 0..count {
                    let x = point(9, index, count, dimension);
                    assert!(x > 0.0 && x < 1.0);
                    hit[(x * count as f64) as usize] = true;
                }
                assert!(hit.iter().all(|&h| h), "{count} points");
            }
        }
    }

    #[test]
    fn dimensions_and_seeds_are_uncorrelated() {
        let correlation = |a: (u64, usize), b: (u64, usize)| {
            let n = 1000;
            let at = |(seed, d): (u64, usize), i| point(seed, i, n, d) - 0.5;
            (0..n).map(|i| at(a, i) * at(b, i)).sum::<f64>() * 12.0 / n as f64
        };
        assert!((correlation((1, 0), (1, 0)) - 1.0).abs() < 1e-3);
        for other in [(1, 1), (2, 0), (1, 7)] {
            // Four standard errors of the correlation of 1000 independent pairs.
            assert!(correlation((1, 0), other).abs() < 4.0 / 1000_f64.sqrt());
        }
    }

    #[test]
    fn permutations_of_three_are_about_equally_frequent() {
        let mut seen = std::collections::BTreeMap::new();
        for key in 0..6000 {
            let order: Vec<u64> = (0..3).map(|i| permute(key, i, 3)).collect();
            *seen.entry(order).or_insert(0) += 1;
        }
        assert_eq!(seen.len(), 6);
        // 1000 expected, standard deviation 29.
        assert!(
            seen.values().all(|&n: &i32| (n - 1000).abs() < 150),
            "{seen:?}"
        );
    }
}
