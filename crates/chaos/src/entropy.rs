//! Entropies of a signal.

use crate::error::{Error, checked};
use scalar::Scalar;

/// Sample entropy (Richman and Moorman 2000) in nats. It is minus the logarithm of the probability that
/// `length` samples that agree within `tolerance` also agree in the next one. `None` where no
/// stretch agrees in the next one. `length` must be at least 1 and less than the samples.
///
/// # Errors
/// A signal that [`checked`] refuses, or a `length` outside its range.
pub fn sample_entropy(signal: &[f64], length: usize, tolerance: f64) -> Result<Option<f64>, Error> {
    checked(signal)?;
    if !(1..signal.len()).contains(&length) {
        return Err(Error::Setting {
            name: "length",
            value: length,
            low: 1,
            high: signal.len() - 1,
        });
    }
    Ok(matches_ratio(signal, length, tolerance))
}

/// Sample entropy of the signal averaged in blocks of 1, 2, ..., `scales` samples. It has the
/// tolerance 0.15 standard deviations of the signal itself and stretches of 2 (Costa, Goldberger and
/// Peng 2002).
///
/// # Errors
/// A signal that [`checked`] refuses.
pub fn multiscale_entropy(signal: &[f64], scales: usize) -> Result<Vec<Option<f64>>, Error> {
    let (_, deviation) = checked(signal)?;
    Ok((1..=scales)
        .map(|scale| {
            let coarse: Vec<f64> = signal
                .chunks_exact(scale)
                .map(|block| block.iter().sum::<f64>() / scale as f64)
                .collect();
            matches_ratio(&coarse, 2, 0.15 * deviation)
        })
        .collect())
}

/// Permutation entropy (Bandt and Pompe 2002) of `order` samples `delay` apart, 0 to 1. It is the entropy
/// of the orders in which they stand, over the logarithm of the number of orders. Equal samples stand
/// in order of time. `order` must be 2 to 8.
///
/// # Errors
/// A signal that [`checked`] refuses or that is shorter than a window, or an `order` outside its range.
pub fn permutation_entropy(signal: &[f64], order: usize, delay: usize) -> Result<f64, Error> {
    checked(signal)?;
    if !(2..=8).contains(&order) {
        return Err(Error::Setting {
            name: "order",
            value: order,
            low: 2,
            high: 8,
        });
    }
    let span = (order - 1).saturating_mul(delay);
    if signal.len() <= span {
        return Err(Error::TooShort {
            found: signal.len(),
            needed: span + 1,
        });
    }
    let orders: usize = (1..=order).product();
    let mut counts = vec![0_usize; orders];
    let windows = signal.len() - span;
    for start in 0..windows {
        counts[lehmer(|k| signal[start + k * delay], order)] += 1;
    }
    let entropy: f64 = counts
        .iter()
        .filter(|c| **c > 0)
        .map(|c| *c as f64 / windows as f64)
        .map(|p| -p * p.ln())
        .sum();
    Ok(entropy / (orders as f64).ln())
}

/// Number of the order (Lehmer 1960) in which `order` values stand.
fn lehmer(value: impl Fn(usize) -> f64, order: usize) -> usize {
    (0..order).fold(0, |code, k| {
        let smaller = (k + 1..order).filter(|&l| value(l) < value(k)).count();
        code * (order - k) + smaller
    })
}

/// Pairs are found along the sorted first samples, so only those within the tolerance there are
/// compared. Samples are compared by their ranks: those within the tolerance of one are a stretch
/// of ranks, and ranks are half as long as samples.
fn matches_ratio(signal: &[f64], length: usize, tolerance: f64) -> Option<f64> {
    let count = signal.len().saturating_sub(length);
    let mut order: Vec<u32> = (0..signal.len() as u32).collect();
    order.sort_by(|&a, &b| signal[a as usize].total_cmp(&signal[b as usize]));
    let mut stretches = vec![Stretch::default(); signal.len()];
    let (mut low, mut high) = (0, 0);
    for (rank, &index) in order.iter().enumerate() {
        let value = signal[index as usize];
        let apart = |rank: usize| (signal[order[rank] as usize] - value).abs();
        while low < rank && apart(low) > tolerance {
            low += 1;
        }
        while high < order.len() && (high <= rank || apart(high) <= tolerance) {
            high += 1;
        }
        stretches[index as usize] = Stretch {
            rank: rank as u32,
            low: low as u32,
            width: (high - 1 - low) as u32,
        };
    }
    order.retain(|&index| (index as usize) < count);
    // The ranks of the samples after the first, in the order of the first.
    let followers: Vec<Vec<u32>> = (1..=length)
        .map(|k| {
            let follower = |&index: &u32| stretches[index as usize + k].rank;
            order.iter().map(follower).collect()
        })
        .collect();
    let mut agree = vec![0; count];
    let (mut short, mut long) = (0_u64, 0_u64);
    let mut end = 0;
    for (place, &index) in order.iter().enumerate() {
        let index = index as usize;
        let within = |&b: &u32| signal[b as usize] - signal[index] <= tolerance;
        end += order[end..].iter().take_while(|b| within(b)).count();
        let agree = &mut agree[..end.saturating_sub(place + 1)];
        agree.fill(1);
        f64::vectorised(
            #[inline(always)]
            || {
                for (k, ranks) in (1..).zip(&followers) {
                    if k == length {
                        short += sum(agree);
                    }
                    let stretch = stretches[index + k];
                    for (agrees, rank) in agree.iter_mut().zip(&ranks[place + 1..]) {
                        *agrees &= u32::from(stretch.holds(*rank));
                    }
                }
                long += sum(agree);
            },
        );
    }
    (long > 0).then(|| (short as f64 / long as f64).ln())
}

/// The rank of a sample, and the ranks of those within the tolerance.
#[derive(Clone, Copy, Default)]
struct Stretch {
    rank: u32,
    low: u32,
    width: u32,
}

impl Stretch {
    #[inline(always)]
    fn holds(self, rank: u32) -> bool {
        rank.wrapping_sub(self.low) <= self.width
    }
}

#[inline(always)]
fn sum(agree: &[u32]) -> u64 {
    u64::from(agree.iter().sum::<u32>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, System};

    #[test]
    fn white_noise_has_its_closed_form() {
        // Two normal numbers differ by at most 0.2 with probability erf(0.1) = 0.112463.
        let signal = Noise::White.samples(8000, 1);
        let entropy = sample_entropy(&signal, 2, 0.2).unwrap().unwrap();
        assert!((entropy + 0.112_463_f64.ln()).abs() < 0.05, "{entropy}");
        assert!(permutation_entropy(&signal, 4, 1).unwrap() > 0.995);
    }

    #[test]
    fn averaged_white_noise_loses_entropy() {
        let entropies = multiscale_entropy(&Noise::White.samples(6000, 1), 5).unwrap();
        assert!(entropies.windows(2).all(|e| e[0] > e[1]), "{entropies:?}");
    }

    #[test]
    fn the_logistic_map_never_falls_twice() {
        // Of the six orders of three samples the falling one is forbidden; the others have the
        // probabilities 1/3, 1/15, 4/15, 2/15 and 1/5 under the invariant density.
        let signal = System::Logistic.samples(50_000, 1);
        let shares: [f64; 5] = [1.0 / 3.0, 1.0 / 15.0, 4.0 / 15.0, 2.0 / 15.0, 1.0 / 5.0];
        let expected = shares.iter().map(|p| -p * p.ln()).sum::<f64>() / 6.0_f64.ln();
        let found = permutation_entropy(&signal, 3, 1).unwrap();
        assert!((found - expected).abs() < 0.005, "{found} {expected}");
    }

    #[test]
    fn impossible_settings_are_refused() {
        let signal = Noise::White.samples(100, 1);
        assert!(permutation_entropy(&signal, 9, 1).is_err());
        assert!(permutation_entropy(&signal, 3, 50).is_err());
        assert_eq!(sample_entropy(&signal, 2, 0.0), Ok(None));
    }
}
