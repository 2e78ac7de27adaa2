//! Divergence curves: how fast neighbouring vectors part.

use crate::error::{Error, checked};
use crate::neighbours::{Delays, Neighbours};

/// Mean logarithm of the distance against samples, from 0 on.
pub type Curve = Vec<f64>;

/// Mean logarithm of the distance of each vector to the successors of its nearest neighbour
/// (Rosenstein, Collins and De Luca 1993), for `steps` samples.
pub fn rosenstein(delays: &Delays, theiler: usize, steps: usize) -> Result<Curve, Error> {
    let (search, count) = search(delays, theiler, steps)?;
    let mut sums = vec![0.0; steps + 1];
    let mut counts = vec![0_usize; steps + 1];
    for index in 0..count {
        let Some(near) = search.nearest(index, 1).first().copied() else {
            continue;
        };
        for (step, (sum, count)) in sums.iter_mut().zip(&mut counts).enumerate() {
            let square = delays.squared_distance(index + step, near.index + step);
            if square > 0.0 {
                *sum += 0.5 * square.ln();
                *count += 1;
            }
        }
    }
    mean_curve(sums, &counts)
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
    let last = delays.dimension - 1;
    let mut sums = vec![0.0; steps + 1];
    let mut counts = vec![0_usize; steps + 1];
    for index in 0..count {
        let near = search.nearest(index, neighbours);
        for (step, (sum, count)) in sums.iter_mut().zip(&mut counts).enumerate() {
            let apart: f64 = near
                .iter()
                .map(|n| (delays.at(index + step, last) - delays.at(n.index + step, last)).abs())
                .sum();
            if apart > 0.0 {
                *sum += (apart / near.len() as f64).ln();
                *count += 1;
            }
        }
    }
    mean_curve(sums, &counts)
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

fn mean_curve(sums: Vec<f64>, counts: &[usize]) -> Result<Curve, Error> {
    if counts.contains(&0) {
        return Err(Error::NoScalingRegion {
            reason: "all neighbours coincide",
        });
    }
    Ok(sums
        .iter()
        .zip(counts)
        .map(|(s, c)| s / *c as f64)
        .collect())
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
