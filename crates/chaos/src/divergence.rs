//! Divergence curves: how fast neighbouring vectors part.

use crate::error::{Error, checked};
use crate::neighbours::{Delays, Neighbours};
use std::f64::consts::LN_2;

/// Mean logarithm of the distance against samples, from 0 on.
pub type Curve = Vec<f64>;

/// Mean logarithm of the distance of each vector to the successors of its nearest neighbour
/// (Rosenstein, Collins and De Luca 1993), for `steps` samples.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for `delays`, `theiler` and `steps`, or one whose neighbours
/// all coincide.
pub fn rosenstein(delays: &Delays, theiler: usize, steps: usize) -> Result<Curve, Error> {
    let (search, _) = search(delays, theiler, steps)?;
    let mut logarithms = MeanLogarithms::new(steps + 1);
    let reach = steps + 1 + delays.span();
    let mut squares = vec![0.0; reach];
    for (index, near) in search.nearest_of_each(1).into_iter().enumerate() {
        let Some(near) = near else { continue };
        let (here, there) = (&delays.signal[index..], &delays.signal[near.index..]);
        for ((square, a), b) in squares.iter_mut().zip(here).zip(there) {
            *square = (a - b) * (a - b);
        }
        logarithms.add(|row| {
            for axis in 0..delays.dimension {
                let squares = &squares[axis * delays.delay..];
                row.iter_mut().zip(squares).for_each(|(sum, x)| *sum += x);
            }
        });
    }
    // The squares of the distances have twice the logarithm.
    Ok(logarithms.means()?.iter().map(|l| 0.5 * l).collect())
}

/// Mean over the vectors of the logarithm of the mean distance, in the last coordinate, to the
/// successors of `neighbours` neighbours, for `steps` samples. After Kantz (1994), with a fixed number of neighbours
/// in place of a fixed radius.
///
/// # Errors
/// As [`rosenstein`].
pub fn kantz(
    delays: &Delays,
    theiler: usize,
    steps: usize,
    neighbours: usize,
) -> Result<Curve, Error> {
    let (search, count) = search(delays, theiler, steps)?;
    let last = &delays.signal[delays.span()..];
    let mut logarithms = MeanLogarithms::new(steps + 1);
    for index in 0..count {
        let near = search.nearest(index, neighbours);
        logarithms.add(|row| {
            for n in &near {
                let pairs = last[index..].iter().zip(&last[n.index..]);
                for (sum, (a, b)) in row.iter_mut().zip(pairs) {
                    *sum += (a - b).abs() / near.len() as f64;
                }
            }
        });
    }
    logarithms.means()
}

fn search(delays: &Delays, theiler: usize, steps: usize) -> Result<(Neighbours, usize), Error> {
    checked(delays.signal)?;
    let needed = delays.span() + steps + 2 * theiler + 50;
    let too_short = Error::TooShort {
        found: delays.signal.len(),
        needed,
    };
    if delays.signal.len() < needed {
        return Err(too_short);
    }
    let count = delays.count() - steps;
    let search = Neighbours::new(delays, count, theiler).ok_or(too_short)?;
    Ok((search, count))
}

/// Means over rows of the logarithms of their columns; zeros are left out.
///
/// A number is its mantissa, 1 to 2, times a power of two. Exponents are added and mantissas
/// multiplied, so that there is one logarithm for many rows.
struct MeanLogarithms {
    /// Of each column: the logarithm of the mantissas put away,
    sums: Vec<f64>,
    /// the product of the others,
    mantissas: Vec<f64>,
    /// the sum of the exponents, as they stand in the bits,
    exponents: Vec<u64>,
    /// and how many numbers count.
    counts: Vec<u64>,
    row: Vec<f64>,
    rows: u64,
}

/// Rows whose mantissas are multiplied; twice as many would not fit into a number.
const TOGETHER: u64 = 512;
/// The bits of the mantissa, and the exponent of 1.
const DIGITS: u32 = f64::MANTISSA_DIGITS - 1;
const ONE: u64 = 1.0_f64.to_bits();

impl MeanLogarithms {
    fn new(columns: usize) -> Self {
        Self {
            sums: vec![0.0; columns],
            mantissas: vec![1.0; columns],
            exponents: vec![0; columns],
            counts: vec![0; columns],
            row: vec![0.0; columns],
            rows: 0,
        }
    }

    /// Takes the row that `fill` makes of zeros. A zero, or a number too small to have all its
    /// digits, does not count; a 1 stands for it.
    fn add(&mut self, fill: impl FnOnce(&mut [f64])) {
        self.row.fill(0.0);
        fill(&mut self.row);
        let parts = self.mantissas.iter_mut().zip(&mut self.exponents);
        let columns = parts.zip(&mut self.counts);
        for (x, ((mantissa, exponent), count)) in self.row.iter().zip(columns) {
            let counts = *x >= f64::MIN_POSITIVE;
            let bits = if counts { x.to_bits() } else { ONE };
            *count += u64::from(counts);
            *exponent += bits >> DIGITS;
            *mantissa *= f64::from_bits(bits & ((1 << DIGITS) - 1) | ONE);
        }
        self.rows += 1;
        if self.rows.is_multiple_of(TOGETHER) {
            self.put_away();
        }
    }

    fn put_away(&mut self) {
        for (sum, mantissa) in self.sums.iter_mut().zip(&mut self.mantissas) {
            *sum += mantissa.ln();
            *mantissa = 1.0;
        }
    }

    fn means(mut self) -> Result<Vec<f64>, Error> {
        self.put_away();
        if self.counts.contains(&0) {
            return Err(Error::NoScalingRegion {
                reason: "all neighbours coincide",
            });
        }
        let of_ones = self.rows * (ONE >> DIGITS);
        let columns = self.sums.iter().zip(&self.exponents).zip(&self.counts);
        let mean = |((sum, exponent), count): ((&f64, &u64), &u64)| {
            let powers = exponent.wrapping_sub(of_ones) as i64;
            (sum + powers as f64 * LN_2) / *count as f64
        };
        Ok(columns.map(mean).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Regular, System, with_noise};

    #[test]
    fn the_logistic_curve_rises_by_the_logarithm_of_two() {
        let signal = System::Logistic.samples(5000, 1);
        let delays = Delays {
            signal: &signal,
            dimension: 1,
            delay: 1,
        };
        for curve in [
            rosenstein(&delays, 1, 5).unwrap(),
            kantz(&delays, 1, 5, 2).unwrap(),
        ] {
            let slope = (curve[4] - curve[1]) / 3.0;
            assert!((slope - 2.0_f64.ln()).abs() < 0.06, "{curve:?}");
        }
    }

    #[test]
    fn logarithms_are_those_of_each_number() {
        let columns = [[1e-200, 3.0], [0.0, 2.5e250], [7.5e180, 1e-3]];
        let mut logarithms = MeanLogarithms::new(2);
        for _ in 0..700 {
            for column in columns {
                logarithms.add(|row| row.copy_from_slice(&column));
            }
        }
        let means = logarithms.means().unwrap();
        let expected = [
            (1e-200_f64.ln() + 7.5e180_f64.ln()) / 2.0,
            (3.0_f64.ln() + 2.5e250_f64.ln() + 1e-3_f64.ln()) / 3.0,
        ];
        for (found, expected) in means.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        let mut nothing = MeanLogarithms::new(1);
        nothing.add(|_| {});
        assert!(nothing.means().is_err());
    }

    #[test]
    fn a_periodic_curve_stays() {
        let signal = with_noise(&Regular::Periodic.samples(3000, 1), 0.01, 1);
        let delays = Delays {
            signal: &signal,
            dimension: 4,
            delay: 3,
        };
        let curve = rosenstein(&delays, 21, 100).unwrap();
        assert!(
            (curve[100] - curve[30]).abs() < 0.1,
            "{} {}",
            curve[30],
            curve[100]
        );
    }
}
