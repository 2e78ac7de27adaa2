//! Values between the samples, by windowed-sinc interpolation.

use crate::kaiser::{self, HALF_WIDTH, LANES};
use scalar::Scalar;
use std::sync::LazyLock;

const TAPS: usize = 2 * HALF_WIDTH;

/// Weights of a row, of which those beyond the taps are 0.
const PADDED: usize = TAPS.next_multiple_of(LANES);

/// Rows per sample interval. Weights between two rows are interpolated linearly, which errs by
/// less than 2e-6 of the largest weight.
const ROWS: usize = 512;

type Row = [f64; PADDED];

/// Weights of the neighbours for each fraction of a sample interval; each row adds up to 1, so
/// that a constant passes unchanged.
static WEIGHTS: LazyLock<Vec<Row>> = LazyLock::new(|| (0..=ROWS).map(row).collect());

fn row(index: usize) -> Row {
    let fraction = index as f64 / ROWS as f64;
    let taps: [f64; TAPS] =
        std::array::from_fn(|t| kaiser::low_pass(t as f64 + 1.0 - HALF_WIDTH as f64 - fraction));
    let sum: f64 = taps.iter().sum();
    std::array::from_fn(|t| taps.get(t).map_or(0.0, |w| w / sum))
}

/// The values of `x` at fractional sample indices.
///
/// Exact within 1e-4 up to 0.8 of the Nyquist frequency. Beyond its ends the record is
/// continued by reflection through its end point, 2x₀ − x_i, which keeps value and slope;
/// Positions must stay within one record length of the ends. `x` is not empty.
pub(crate) fn interpolate(x: &[f64], positions: impl Iterator<Item = f64>) -> Vec<f64> {
    let weights = &WEIGHTS[..];
    let mut values: Vec<f64> = positions.collect();
    f64::vectorised(
        #[inline(always)]
        || {
            // A loop, as `for_each` is a function of its own, which would not get the instructions.
            for value in &mut values {
                *value = at(x, *value, weights);
            }
        },
    );
    values
}

#[inline(always)]
fn at(x: &[f64], position: f64, weights: &[Row]) -> f64 {
    let floor = position.floor();
    let scaled = (position - floor) * ROWS as f64;
    let index = (scaled as usize).min(ROWS - 1);
    let between = scaled - index as f64;
    let [low, high] = [&weights[index], &weights[index + 1]];

    let first = floor as isize + 1 - HALF_WIDTH as isize;
    let inside = usize::try_from(first).ok();
    let inside = inside.and_then(|i| x.get(i..)?.first_chunk());
    let reflected: Row;
    let neighbours: &Row = match inside {
        Some(row) => row,
        None => {
            reflected = std::array::from_fn(|t| continued(x, first + t as isize));
            &reflected
        }
    };
    // A few sums side by side: one alone would wait for each addition. Those by two rows, and then between them.
    let mut sums = [[0.0; LANES]; 2];
    for t in (0..PADDED).step_by(LANES) {
        for lane in 0..LANES {
            sums[0][lane] += neighbours[t + lane] * low[t + lane];
            sums[1][lane] += neighbours[t + lane] * high[t + lane];
        }
    }
    let [low, high] = sums.map(|sums| sums.iter().sum::<f64>());
    low + between * (high - low)
}

fn continued(x: &[f64], index: isize) -> f64 {
    let last = x.len() as isize - 1;
    let at = |i: isize| x[i.clamp(0, last) as usize];
    if index < 0 {
        2.0 * at(0) - at(-index)
    } else if index > last {
        2.0 * at(last) - at(2 * last - index)
    } else {
        at(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn interpolate_one(x: &[f64], position: f64) -> f64 {
        interpolate(x, std::iter::once(position))[0]
    }

    #[test]
    fn sines_of_the_pass_band_are_met_between_samples() {
        for share in [0.01, 0.3, 0.79] {
            let wave = |t: f64| (PI * share * t + 0.3).sin();
            let x: Vec<f64> = (0..200).map(|i| wave(f64::from(i))).collect();
            for i in 0..500 {
                let position = 80.0 + 0.0791 * f64::from(i);
                let error = interpolate_one(&x, position) - wave(position);
                assert!(error.abs() < 1e-4, "{share}: {error:e}");
            }
        }
    }

    #[test]
    fn samples_constants_and_lines_pass_unchanged() {
        let x: Vec<f64> = (0..60).map(|i| (f64::from(i * i) * 0.7).sin()).collect();
        let line: Vec<f64> = (0..60).map(|i| 3.0 - 0.5 * f64::from(i)).collect();
        for i in 0..60 {
            assert!((interpolate_one(&x, f64::from(i)) - x[i as usize]).abs() < 1e-13);
        }
        for i in 0..130 {
            let position = 0.5 * f64::from(i) - 2.25;
            assert!((interpolate_one(&[1e5; 60], position) - 1e5).abs() < 1e-9);
            assert!((interpolate_one(&line, position) - (3.0 - 0.5 * position)).abs() < 1e-4);
        }
    }
}
