//! Largest Lyapunov exponent from local maps (Sano and Sawada 1985; Eckmann, Oliffson Kamphorst,
//! Ruelle and Ciliberto 1986).
//!
//! The derivative of a delay vector's successor shifts the coordinates and takes the last one from
//! a local map. The product of these derivatives along the signal stretches a tangent at the rate
//! of the largest exponent. The size and order of the local maps are those that best predict
//! samples left out, so a noisy signal gets larger neighbourhoods by itself.

use crate::delay::{self, Times};
use crate::error::{Error, checked};
use crate::local_map::{LocalMap, Model, local_map};
use crate::neighbours::{Delays, Neighbours};
use crate::noise_reduction::noise_reduced;

/// Largest dimension of local maps, and of those with products.
const LARGEST: usize = 7;
const LARGEST_QUADRATIC: usize = 4;
/// Vectors at which a model is tried.
const TRIALS: usize = 250;
/// Most neighbours of a local map.
const MOST_NEIGHBOURS: usize = 500;
/// Most steps along the signal.
const STEPS: usize = 10_000;
/// Models whose exponents are compared.
const COMPARED: usize = 3;
/// Error of prediction, as a share of the standard deviation, below which it counts as exact.
const EXACT: f64 = 0.01;
/// Error of prediction, as a share of the standard deviation, from which noise is reduced, and the
/// windows averaged then.
const NOISY: f64 = 0.04;
const AVERAGED: usize = 10;
/// Blocks for the standard error, and the two-sided 95 % quantile of Student's t for them.
const BLOCKS: usize = 20;
const QUANTILE: f64 = 2.093;

/// An exponent with its 95 % interval, all in nats per sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponent {
    /// Best estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// The model with the least error of prediction.
    pub model: Model,
    /// Its error of prediction one delay ahead, as a share of the standard deviation.
    pub prediction_error: f64,
}

/// The largest exponent of a signal from local maps. A signal that is badly predicted is taken as
/// noisy: its noise is reduced first, and the interval widened by half of what that changes.
pub fn exponent(signal: &[f64], times: &Times) -> Result<Exponent, Error> {
    let raw = estimate(signal, times)?;
    if raw.prediction_error < NOISY {
        return Ok(raw);
    }
    let reduced = noise_reduced(signal, times, AVERAGED)?;
    let found = estimate(&reduced, &delay::times(&reduced)?)?;
    let half = ((found.high - found.low) / 2.0).hypot((found.value - raw.value) / 2.0);
    Ok(Exponent {
        low: found.value - half,
        high: found.value + half,
        ..found
    })
}

fn estimate(signal: &[f64], times: &Times) -> Result<Exponent, Error> {
    let (_, deviation) = checked(signal)?;
    let needed = (LARGEST + 2 * BLOCKS) * times.delay + 2 * times.theiler + 100;
    if signal.len() < needed {
        return Err(Error::TooShort {
            found: signal.len(),
            needed,
        });
    }
    let ranked = without_spurious(ranked_models(signal, times), deviation);
    let Some(&(model, least)) = ranked.first() else {
        return Err(Error::TooShort {
            found: signal.len(),
            needed,
        });
    };
    let estimates: Vec<Growth> = ranked
        .iter()
        .take_while(|(_, error)| *error <= 1.1 * least)
        .take(COMPARED)
        .map(|(model, _)| growth(signal, times, model))
        .collect();
    let value = estimates.iter().map(|g| g.mean).sum::<f64>() / estimates.len() as f64;
    let statistical = estimates[0].standard_error;
    let spread = estimates
        .iter()
        .map(|g| (g.mean - value).abs())
        .fold(0.0, f64::max);
    let half = (QUANTILE * statistical).hypot(spread);
    let per_sample = 1.0 / times.delay as f64;
    Ok(Exponent {
        value: value * per_sample,
        low: (value - half) * per_sample,
        high: (value + half) * per_sample,
        model,
        prediction_error: least / deviation,
    })
}

/// Every model with its root mean square error on samples left out, best first.
fn ranked_models(signal: &[f64], times: &Times) -> Vec<(Model, f64)> {
    let mut ranked = Vec::new();
    for dimension in 1..=LARGEST {
        let delays = Delays {
            signal,
            dimension,
            delay: times.delay,
        };
        let count = delays.count() - times.delay;
        let Some(search) = Neighbours::new(&delays, count, times.theiler) else {
            continue;
        };
        let models = models(dimension, count);
        let most = models.iter().map(|m| m.neighbours).max().unwrap_or(0);
        let mut squares = vec![0.0; models.len()];
        for index in (0..count).step_by(count.div_ceil(TRIALS)) {
            let near = search.nearest(index, most);
            for (square, model) in squares.iter_mut().zip(&models) {
                let map = local_map(&delays, index, &near, model);
                let error = map.map_or(0.0, |m| m.value - delays.at(index, dimension));
                *square += error * error;
            }
        }
        let trials = count.div_ceil(count.div_ceil(TRIALS)) as f64;
        let errors = squares.into_iter().map(|s: f64| (s / trials).sqrt());
        ranked.extend(models.into_iter().zip(errors));
    }
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    ranked
}

/// Keeps, where the signal is predicted exactly, the models of the smallest dimension that does it
/// nearly as well as the best: without noise, a further coordinate only adds spurious exponents,
/// which can be the largest (Abarbanel, Brown, Sidorowich and Tsimring 1993).
fn without_spurious(mut ranked: Vec<(Model, f64)>, deviation: f64) -> Vec<(Model, f64)> {
    let least = ranked.first().map_or(f64::INFINITY, |(_, error)| *error);
    if least < EXACT * deviation {
        let good = ranked.iter().filter(|(_, e)| *e <= 2.0 * least);
        let smallest = good.map(|(m, _)| m.dimension).min();
        ranked.retain(|(m, _)| Some(m.dimension) == smallest);
    }
    ranked
}

fn models(dimension: usize, count: usize) -> Vec<Model> {
    let mut models = Vec::new();
    for quadratic in [false, true] {
        if quadratic && dimension > LARGEST_QUADRATIC {
            continue;
        }
        for ridge in [1e-9, 1e-5] {
            let mut model = Model {
                dimension,
                neighbours: 0,
                quadratic,
                ridge,
            };
            for share in [2, 4, 8, 16, 32] {
                model.neighbours = share * model.unknowns();
                if model.neighbours <= MOST_NEIGHBOURS.min(count / 4) {
                    models.push(model);
                }
            }
        }
    }
    models
}

/// Mean logarithmic growth of a tangent over one delay.
struct Growth {
    mean: f64,
    standard_error: f64,
}

fn growth(signal: &[f64], times: &Times, model: &Model) -> Growth {
    let delays = Delays {
        signal,
        dimension: model.dimension,
        delay: times.delay,
    };
    let count = delays.count() - times.delay;
    let Some(search) = Neighbours::new(&delays, count, times.theiler) else {
        return Growth {
            mean: 0.0,
            standard_error: f64::INFINITY,
        };
    };
    let strands = (STEPS * times.delay / count).clamp(1, times.delay);
    let mut growths = Vec::new();
    for strand in 0..strands {
        let first = strand * times.delay / strands;
        let mut tangent = vec![1.0; model.dimension];
        for (step, index) in (first..count).step_by(times.delay).enumerate() {
            let near = search.nearest(index, model.neighbours);
            let Some(map) = local_map(&delays, index, &near, model) else {
                continue;
            };
            let stretch = advance(&mut tangent, &map);
            if step >= 2 * model.dimension {
                growths.push(stretch.ln());
            }
        }
    }
    block_mean(&growths)
}

/// Takes the tangent one delay on, brings it back to length 1 and returns the length it had.
fn advance(tangent: &mut [f64], map: &LocalMap) -> f64 {
    let last: f64 = tangent.iter().zip(&map.slopes).map(|(t, s)| t * s).sum();
    tangent.rotate_left(1);
    let end = tangent.len() - 1;
    tangent[end] = last;
    let length = tangent.iter().map(|t| t * t).sum::<f64>().sqrt().max(1e-12);
    tangent.iter_mut().for_each(|t| *t /= length);
    length
}

/// Mean, and its standard error from the means of successive blocks.
fn block_mean(values: &[f64]) -> Growth {
    let size = (values.len() / BLOCKS).max(1);
    let means: Vec<f64> = values
        .chunks_exact(size)
        .take(BLOCKS)
        .map(|block| block.iter().sum::<f64>() / size as f64)
        .collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Growth {
        mean,
        standard_error: (variance / count).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Regular, System};

    fn found(signal: &[f64]) -> Exponent {
        exponent(signal, &times(signal).unwrap()).unwrap()
    }

    #[test]
    fn maps_are_found_closely() {
        for (system, tolerance) in [(System::Logistic, 0.02), (System::Henon, 0.03)] {
            let exponent = found(&system.samples(4000, 1));
            let error = exponent.value / system.exponent() - 1.0;
            assert!(error.abs() < tolerance, "{} {exponent:?}", system.name());
        }
    }

    #[test]
    fn the_interval_of_a_periodic_signal_reaches_zero() {
        let exponent = found(&Regular::Periodic.samples(3000, 1));
        assert!(exponent.low <= 0.0, "{exponent:?}");
    }
}
