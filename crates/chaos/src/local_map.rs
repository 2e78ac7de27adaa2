//! Local polynomial maps: what the next value is near a delay vector, and its derivatives.

use crate::global_map::Linear;
use crate::neighbours::{Delays, Neighbour, Neighbours};
use nalgebra::{DMatrix, DVector};

/// How a local map is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Coordinates of the delay vectors.
    pub dimension: usize,
    /// Neighbours fitted to.
    pub neighbours: usize,
    /// Products of two coordinates are fitted as well.
    pub quadratic: bool,
    /// Ridge, as a share of the mean square of a coordinate in the neighbourhood.
    pub ridge: f64,
}

impl Model {
    /// Unknowns of the fit.
    pub fn unknowns(&self) -> usize {
        let m = self.dimension;
        1 + m + if self.quadratic { m * (m + 1) / 2 } else { 0 }
    }
}

/// A fitted map around a vector.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMap {
    /// The next value predicted at the vector.
    pub value: f64,
    /// Its derivative by each coordinate.
    pub slopes: Vec<f64>,
}

/// Fits the value one delay after the last coordinate to the neighbours (not to the vector itself)
/// of vector `index`, by least squares with tricube weights (Cleveland 1979). `None` where all
/// neighbours coincide with the vector.
pub fn local_map(
    delays: &Delays,
    index: usize,
    neighbours: &[Neighbour],
    model: &Model,
) -> Option<LocalMap> {
    fitted(delays, index, neighbours, model, &|index| {
        delays.at(index, delays.dimension)
    })
}

/// The same for another value that follows each vector.
fn fitted(
    delays: &Delays,
    index: usize,
    neighbours: &[Neighbour],
    model: &Model,
    following: &dyn Fn(usize) -> f64,
) -> Option<LocalMap> {
    let (m, unknowns) = (delays.dimension, model.unknowns());
    let near = &neighbours[..model.neighbours.min(neighbours.len())];
    let radius = near.last().map(|n| n.distance).filter(|r| *r > 0.0)?;
    let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    let mut row = vec![1.0; unknowns];
    let mut weights = 0.0;
    let here = following(index);
    for n in near {
        for axis in 0..m {
            row[1 + axis] = (delays.at(n.index, axis) - delays.at(index, axis)) / radius;
        }
        if model.quadratic {
            let mut place = 1 + m;
            for a in 0..m {
                for b in a..m {
                    row[place] = row[1 + a] * row[1 + b];
                    place += 1;
                }
            }
        }
        let weight = (1.0 - (n.distance / (1.01 * radius)).powi(3)).powi(3);
        let target = following(n.index) - here;
        weights += weight;
        for a in 0..unknowns {
            let scaled = weight * row[a];
            right[a] += scaled * target;
            for b in 0..=a {
                normal[(a, b)] += scaled * row[b];
            }
        }
    }
    let spread: f64 = (1..=m).map(|a| normal[(a, a)]).sum::<f64>() / m as f64;
    normal[(0, 0)] += 1e-12 * weights;
    for a in 1..unknowns {
        normal[(a, a)] += model.ridge * spread;
    }
    // The factorisation reads the lower triangle only.
    let solution = normal.cholesky()?.solve(&right);
    Some(LocalMap {
        value: here + solution[0],
        slopes: (1..=m).map(|a| solution[a] / radius).collect(),
    })
}

/// Neighbours tried for each unknown of a linear map, and vectors at which they are.
const PER_UNKNOWN: [usize; 4] = [2, 4, 8, 16];
const TRIALS: usize = 300;
/// Ridge of the linear maps.
const RIDGE: f64 = 1e-3;

/// Linear maps to the next sample along a signal, each fitted without the vector itself and what is
/// within `theiler` samples of it (Eckmann and Ruelle 1985). The number of neighbours is the one that
/// predicts best. `None` where vectors coincide, or the signal is too short.
pub(crate) fn along(
    signal: &[f64],
    dimension: usize,
    delay: usize,
    theiler: usize,
) -> Option<Linear> {
    let delays = Delays {
        signal,
        dimension,
        delay,
    };
    let rows = signal.len().checked_sub(delays.span() + 1)?;
    let next = |row: usize| signal[row + delays.span() + 1];
    let search = Neighbours::new(&delays, rows, theiler)?;
    let at = |row: usize, neighbours: usize| {
        let model = Model {
            dimension,
            neighbours,
            quadratic: false,
            ridge: RIDGE,
        };
        fitted(
            &delays,
            row,
            &search.nearest(row, neighbours),
            &model,
            &next,
        )
    };
    let error = |neighbours: usize| {
        let trials = (0..rows).step_by(rows.div_ceil(TRIALS));
        let squares = trials.map(|row| Some((at(row, neighbours)?.value - next(row)).powi(2)));
        squares.sum::<Option<f64>>()
    };
    let tried: Option<Vec<(f64, usize)>> = PER_UNKNOWN
        .iter()
        .map(|each| each * (dimension + 1))
        .map(|neighbours| Some((error(neighbours)?, neighbours)))
        .collect();
    let (_, neighbours) = tried?.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut linear = Linear {
        dimension,
        delay,
        values: Vec::with_capacity(rows),
        slopes: Vec::with_capacity(rows * dimension),
    };
    for row in 0..rows {
        let map = at(row, neighbours)?;
        linear.values.push(map.value);
        // The newest coordinate first.
        linear.slopes.extend(map.slopes.iter().rev());
    }
    Some(linear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::System;

    #[test]
    fn the_henon_map_is_found_with_its_derivatives() {
        // x(n+2) = 1 - 1.4 x(n+1)^2 + 0.3 x(n)
        let signal = System::Henon.samples(3000, 1);
        let model = Model {
            dimension: 2,
            neighbours: 24,
            quadratic: true,
            ridge: 1e-12,
        };
        let delays = Delays {
            signal: &signal,
            dimension: 2,
            delay: 1,
        };
        let search = Neighbours::new(&delays, 2998, 2).unwrap();
        for index in (0..2998).step_by(111) {
            let map = local_map(&delays, index, &search.nearest(index, 24), &model).unwrap();
            assert!((map.value - signal[index + 2]).abs() < 1e-5);
            assert!(
                (map.slopes[1] + 2.8 * signal[index + 1]).abs() < 0.01,
                "{map:?}"
            );
            assert!((map.slopes[0] - 0.3).abs() < 0.02, "{map:?}");
        }
    }
}
