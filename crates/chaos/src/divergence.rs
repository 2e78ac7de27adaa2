//! Divergence curves: how fast neighbouring vectors part.

use crate::error::{Error, checked};
use crate::neighbours::{Delays, Neighbours};
use std::ops::RangeInclusive;

/// Mean logarithm of the distance against samples, from 0 on.
pub type Curve = Vec<f64>;

/// Mean logarithm of the distance of each vector to the successors of its nearest neighbour
/// (Rosenstein, Collins and De Luca 1993), for `steps` samples.
pub fn rosenstein(delays: &Delays, theiler: usize, steps: usize) -> Result<Curve, Error> {
    let (search, _) = search(delays, theiler, steps)?;
    let mut logarithms = MeanLogarithms::new(steps + 1);
    let reach = steps + 1 + delays.span();
    let mut squares = vec![0.0; reach];
    for (index, near) in search.nearest_of_each().into_iter().enumerate() {
        let Some(near) = near else { continue };
        let (here, there) = (&delays.signal[index..], &delays.signal[near.index..]);
        for ((square, a), b) in squares.iter_mut().zip(here).zip(there) {
            *square = (a - b) * (a - b);
        }
        let row = logarithms.next_row();
        for axis in 0..delays.dimension {
            add(row, &squares[axis * delays.delay..]);
        }
    }
    // The squares of the distances have twice the logarithm.
    Ok(logarithms.means()?.iter().map(|l| 0.5 * l).collect())
}

/// Mean over the vectors of the logarithm of the mean distance, in the last coordinate, to the
/// successors of `neighbours` neighbours (Kantz 1994, with a fixed number in place of a fixed
/// radius), for `steps` samples.
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
        let row = logarithms.next_row();
        for n in &near {
            for ((sum, a), b) in row.iter_mut().zip(&last[index..]).zip(&last[n.index..]) {
                *sum += (a - b).abs() / near.len() as f64;
            }
        }
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

fn add(row: &mut [f64], more: &[f64]) {
    for (sum, x) in row.iter_mut().zip(more) {
        *sum += x;
    }
}

/// Means over rows of the logarithms of their columns; zeros are left out.
///
/// The logarithm of a product costs as much as that of one factor, so rows are taken together.
struct MeanLogarithms {
    columns: usize,
    /// Rows not summed yet, one after the other.
    rows: Vec<f64>,
    sums: Vec<f64>,
    counts: Vec<usize>,
}

/// Rows taken together.
const TOGETHER: usize = 8;
/// A product of so many factors in this range neither overflows nor loses digits.
const PLAIN: RangeInclusive<f64> = 1e-38..=1e38;

impl MeanLogarithms {
    fn new(columns: usize) -> Self {
        Self {
            columns,
            rows: Vec::with_capacity(TOGETHER * columns),
            sums: vec![0.0; columns],
            counts: vec![0; columns],
        }
    }

    /// A row of zeros, to be filled.
    fn next_row(&mut self) -> &mut [f64] {
        if self.rows.len() == TOGETHER * self.columns {
            self.sum_rows();
        }
        let end = self.rows.len();
        self.rows.resize(end + self.columns, 0.0);
        &mut self.rows[end..]
    }

    fn sum_rows(&mut self) {
        for column in 0..self.columns {
            let factors = self.rows[column..].iter().step_by(self.columns);
            if factors.clone().all(|x| PLAIN.contains(x)) {
                self.counts[column] += factors.len();
                self.sums[column] += factors.product::<f64>().ln();
            } else {
                for x in factors.filter(|x| **x > 0.0) {
                    self.counts[column] += 1;
                    self.sums[column] += x.ln();
                }
            }
        }
        self.rows.clear();
    }

    fn means(mut self) -> Result<Vec<f64>, Error> {
        if !self.rows.is_empty() {
            self.sum_rows();
        }
        if self.counts.contains(&0) {
            return Err(Error::NoScalingRegion {
                reason: "all neighbours coincide",
            });
        }
        let pairs = self.sums.iter().zip(&self.counts);
        Ok(pairs.map(|(sum, count)| sum / *count as f64).collect())
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
