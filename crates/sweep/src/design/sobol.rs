//! Sobol's sequence, plain or with nested uniform (Owen) scrambling, point by point.
//!
//! Point n in dimension d is the exclusive or of the direction numbers V_k over the bits k set in
//! the Gray code of n, as Antonov and Saleev (1979) order the points. Owen (1995) flips digit k of
//! each coordinate by a random bit that depends on the digits above it; here this bit is a hash of
//! seed, dimension and those digits, so that nothing is stored (the idea of Burley 2020, "Practical
//! hash-based Owen scrambling", JCGT 9(4), with one exact hash per digit in place of his
//! approximate hash of all digits).
//!
//! Checked against `scipy.stats.qmc.Sobol`: see `data/reference/designs`.

use super::hash::{hash, unit};
use super::joe_kuo::JOE_KUO;

/// Largest number of dimensions.
pub const DIMENSIONS: usize = JOE_KUO.len() + 1;

/// Binary digits of a coordinate; the sequence has 2^52 different points.
const DIGITS: u32 = 52;

/// Coordinate `dimension` of point `index`, in (0, 1), scrambled by `seed`.
///
/// `dimension` must be below [`DIMENSIONS`]; the sweep file's checks see to it.
pub fn scrambled(seed: u64, index: u64, dimension: usize) -> f64 {
    let plain = digits(index, dimension);
    let mut result = 0_u64;
    for k in 1..=DIGITS {
        let above = plain >> (DIGITS + 1 - k);
        let flip = hash(&[seed, dimension as u64, k.into(), above]) >> 63;
        let digit = (plain >> (DIGITS - k)) & 1;
        result = result << 1 | (digit ^ flip);
    }
    unit(result << (64 - DIGITS))
}

/// The first [`DIGITS`] binary digits of the unscrambled coordinate, as a whole number.
fn digits(index: u64, dimension: usize) -> u64 {
    let gray = index ^ (index >> 1);
    directions(dimension)
        .take((64 - gray.leading_zeros()) as usize)
        .enumerate()
        .filter(|(k, _)| gray >> k & 1 == 1)
        .fold(0, |point, (_, direction)| point ^ direction)
}

/// The direction numbers V_1, V_2, ... of a dimension, scaled by 2^52.
///
/// With a polynomial of degree s: `m_k = 2 a_1 m_(k−1) ⊕ … ⊕ 2^(s−1) a_(s−1) m_(k−s+1) ⊕
/// 2^s m_(k−s) ⊕ m_(k−s)` and `V_k = m_k / 2^k` (Joe and Kuo 2008, Eq. 2.2).
fn directions(dimension: usize) -> impl Iterator<Item = u64> {
    let mut m = [1_u64; DIGITS as usize];
    if let Some(&(a, initial)) = dimension.checked_sub(1).and_then(|d| JOE_KUO.get(d)) {
        let degree = initial.len();
        for k in 0..m.len() {
            m[k] = match initial.get(k) {
                Some(&given) => given.into(),
                None => (1..degree)
                    .filter(|i| a >> (degree - 1 - i) & 1 == 1)
                    .fold(m[k - degree] << degree ^ m[k - degree], |sum, i| {
                        sum ^ (m[k - i] << i)
                    }),
            };
        }
    }
    m.into_iter()
        .zip(1..)
        .map(|(m, k): (u64, u32)| m << (DIGITS - k))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows "index, dimension, value of the coordinate times 2^52", made by `sobol.py`.
    const SCIPY: &str = include_str!("../../../../data/reference/designs/sobol.csv");

    #[test]
    fn plain_points_are_those_of_scipy() {
        let mut rows = 0;
        for line in SCIPY.lines().skip(1) {
            let row: Vec<u64> = line.split(',').map(|x| x.parse().unwrap()).collect();
            assert_eq!(digits(row[0], row[1] as usize), row[2], "{line}");
            rows += 1;
        }
        assert!(rows > 64 * 40, "{rows}");
    }

    #[test]
    fn scrambling_keeps_one_point_in_every_stratum() {
        for dimension in [0, 1, 17, 63] {
            for seed in [0, 7] {
                let mut hit = [false; 256];
                for index in 0..256 {
                    hit[(scrambled(seed, index, dimension) * 256.0) as usize] = true;
                }
                assert!(hit.iter().all(|&h| h), "dimension {dimension}, seed {seed}");
            }
        }
    }

    #[test]
    fn scrambling_keeps_the_two_dimensional_net() {
        // The first two dimensions are a (0, 2)-sequence: each of the elementary boxes of area
        // 1/64, whatever their shape, holds one of any 64 points that start at a multiple of 64.
        for shift in 0..=6 {
            let mut boxes = [0; 64];
            for index in 64..128 {
                let x = (scrambled(5, index, 0) * f64::from(1 << shift)) as usize;
                let y = (scrambled(5, index, 1) * f64::from(1 << (6 - shift))) as usize;
                boxes[x << (6 - shift) | y] += 1;
            }
            assert_eq!(boxes, [1; 64], "shift {shift}");
        }
    }

    #[test]
    fn another_seed_gives_other_points_and_the_mean_of_a_smooth_function_is_sharp() {
        assert_ne!(scrambled(1, 0, 0), scrambled(2, 0, 0));
        // ∫ Π (1 + (x_d − ½)/2) = 1; plain sampling of 1024 points is off by about 0.01.
        for seed in 0..4 {
            let mean = (0..1024)
                .map(|i| {
                    (0..5)
                        .map(|d| 1.0 + (scrambled(seed, i, d) - 0.5) / 2.0)
                        .product::<f64>()
                })
                .sum::<f64>()
                / 1024.0;
            assert!((mean - 1.0).abs() < 2e-4, "seed {seed}: {mean}");
        }
    }

    #[test]
    fn points_beyond_two_to_the_forty_still_differ() {
        let far = 1_u64 << 40;
        assert_ne!(scrambled(1, far, 3), scrambled(1, far + 1, 3));
        assert_ne!(digits(far, 3), digits(far + (1 << 41), 3));
    }
}
