//! Largest Lyapunov exponent of a sampled signal, with a 95 % interval.
//!
//! A smooth map from delay vectors to the next sample is fitted to the whole signal, with noise in
//! every sample allowed for. The growth of a tangent along the most likely signal is the exponent
//! (Eckmann and Ruelle 1985). Dimension and delay are those of the greatest likelihood. The
//! interval comes from differences: between stretches of the signal, between maps fitted without parts
//! of it or to its halves, between embeddings, and to the divergence of neighbours. Where local maps
//! predict better than the smooth one (a law with corners or jumps), the exponent is that of their tangents. It
//! knows nothing of states that the delay vectors do not hold.

use crate::blocks::{block_means, mean};
use crate::delay::Times;
use crate::dimension::unfolding;
use crate::divergence::rosenstein;
use crate::error::{Error, checked};
use crate::errors_in_variables::Model;
use crate::global_map::{Basis, FIRST_RIDGE, FOLDS, Linear, regression, set_target};
use crate::local_map;
use crate::neighbours::{Delays, LARGEST_DIMENSION};
use crate::scaling_region::scaling_region;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use scalar::random::Stream;

/// Noise added to every signal, as a share of its standard deviation. A signal without noise lies
/// on a thin attractor. It leaves the slopes across it open, and with them exponents that the
/// system does not have. Noise settles them near 0 (Bishop 1995: noise on inputs acts as a
/// penalty on slopes). So small a noise costs less accuracy than the length of the signal.
const ADDED: f64 = 0.003;
/// Largest dimension.
const LARGEST: usize = 6;
/// Longest delay in samples; of slower signals, means of successive samples are taken.
const LONGEST_DELAY: usize = 7;
/// Centres of the map of a signal of at most so many samples. Longer signals have more, as the square
/// root of the length, up to a largest number: more samples determine more weights.
const CENTRES: usize = 150;
const FOR_SAMPLES: usize = 10_000;
const MOST_CENTRES: usize = 350;
/// Fewest samples for each centre.
const PER_CENTRE: usize = 12;
/// Vectors and centres with which embeddings are compared first.
const SCREENED: usize = 2500;
const FEW_CENTRES: usize = 100;
/// Embeddings compared by likelihood, and samples for that.
const COMPARED: usize = 4;
const TRIAL: usize = 4000;
/// Passes of the fits: of those compared, of the likeliest, and of the second likeliest, which
/// starts from the signal that the likeliest has found.
const TRIAL_PASSES: usize = 1;
const PASSES: usize = 3;
const SECOND_PASSES: usize = 2;
/// Two-sided 95 % quantile of Student's t for [`BLOCKS`](crate::blocks::BLOCKS) blocks.
const QUANTILE: f64 = 2.093;
/// Fewest samples of a signal (after taking means).
const FEWEST: usize = 300;
/// Standard error by what noise leaves in curved maps, as a share of the exponent for noise as large
/// as the signal. It is about 1 % at 5 % noise on the tinkerbell and the delayed logistic map
/// (`examples/intervals`), which the differences between maps do not show.
const LEFT_BY_NOISE: f64 = 0.2;
/// Noise and error of the map, together, from which nothing is said, as a share of the standard
/// deviation.
const DROWNED: f64 = 0.5;

/// An exponent with its 95 % interval, all in nats per sample, and what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponent {
    /// Best estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Coordinates of the delay vectors that the map starts from.
    pub dimension: usize,
    /// Samples between them.
    pub delay: usize,
    /// Noise found in the signal: its standard deviation as a share of the signal's.
    pub noise: f64,
    /// Standard error from the differences between stretches of the signal.
    pub over_time: f64,
    /// Standard error from maps fitted with parts of the signal left out (jackknife).
    pub of_map: f64,
    /// The exponent by the second likeliest embedding.
    pub second: f64,
    /// Standard error by the differences within the map: over time, between parts and embeddings.
    pub within: f64,
    /// Largest difference to the other estimates of the exponent: maps of the halves of the signal, a coarser
    /// map, the divergence of neighbours.
    pub between: f64,
}

impl Exponent {
    /// The value with its interval.
    pub fn growth(&self) -> crate::forced::Growth {
        crate::forced::Growth {
            value: self.value,
            low: self.low,
            high: self.high,
        }
    }

    /// Whether tangents of the map grow (`true`) or shrink; `None` where the map's own error leaves it
    /// open.
    pub fn grows(&self) -> Option<bool> {
        let clear = self.value.abs() > QUANTILE * self.within;
        clear.then_some(self.value > 0.0)
    }
}

/// The largest exponent of a signal.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for a map. A signal to which no map can be fitted, or whose
/// dynamics noise hides.
pub fn exponent(signal: &[f64], times: &Times) -> Result<Exponent, Error> {
    let (mean, deviation) = checked(signal)?;
    let samples = (times.delay / LONGEST_DELAY + 1).min(times.delay);
    let y = prepared(signal, mean, deviation, samples);
    if y.len() < FEWEST {
        return Err(Error::TooShort {
            found: signal.len(),
            needed: FEWEST * samples,
        });
    }
    let delay = (times.delay / samples).max(1);
    let mut embeddings = screened(&y, delay);
    embeddings.truncate(COMPARED);
    let trial = &y[..y.len().min(TRIAL)];
    let mut tried: Vec<(f64, Embedding)> = embeddings
        .into_iter()
        .filter_map(|e| {
            Some((
                fitted(trial, trial, e, FEW_CENTRES, TRIAL_PASSES)?.likelihood,
                e,
            ))
        })
        .collect();
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    let unfit = Error::NoScalingRegion {
        reason: "no map from delay vectors to the next sample can be fitted",
    };
    let Some(&(_, first)) = tried.first() else {
        return Err(unfit);
    };
    let longer = (y.len() as f64 / FOR_SAMPLES as f64).max(1.0).sqrt();
    let centres = ((CENTRES as f64 * longer) as usize).min(MOST_CENTRES);
    let mut best = fitted(&y, &y, first, centres, PASSES).ok_or(unfit)?;
    let mut other = tried
        .get(1)
        .and_then(|(_, second)| fitted(&y, &best.signal, *second, centres, SECOND_PASSES));
    if let Some(second) = &mut other
        && second.likelihood > best.likelihood
    {
        std::mem::swap(&mut best, second);
    }
    if best.noise.hypot(best.own) > DROWNED {
        return Err(Error::NoScalingRegion {
            reason: "noise hides the dynamics",
        });
    }
    let smooth = Growth::new(&best);
    // A smooth map cannot follow a corner or a jump. Where local maps predict better, their tangents are
    // closer to the law's, and how far the smooth map's are from them is part of the error.
    let local = smooth.by_local_maps(&best, times.theiler / samples);
    let mut others = vec![smooth.mean];
    let growth = local
        .filter(|local| local.missed < smooth.missed)
        .unwrap_or(smooth);
    let second = other.map_or(growth.mean, |model| Growth::new(&model).mean);
    let error = growth
        .over_time
        .hypot(growth.of_map)
        .hypot((second - growth.mean) / 2.0)
        .hypot(LEFT_BY_NOISE * best.noise * growth.mean);
    others.extend(of_halves(&best, centres));
    others.extend(coarser(&best, centres));
    others.push(second);
    if let Ok(rate) = divergence_rate(signal, times) {
        others.push(rate * samples as f64);
    }
    let apart = others.iter().map(|other| (other - growth.mean).abs());
    let between = apart.fold(0.0, f64::max);
    let half = (QUANTILE * error).hypot(between);
    let each = 1.0 / samples as f64;
    Ok(Exponent {
        value: growth.mean * each,
        low: (growth.mean - half) * each,
        high: (growth.mean + half) * each,
        dimension: best.basis.dimension,
        delay: best.basis.delay * samples,
        noise: (best.noise.powi(2) - ADDED.powi(2)).max(0.0).sqrt(),
        over_time: growth.over_time * each,
        of_map: growth.of_map * each,
        second: second * each,
        within: error * each,
        between: between * each,
    })
}

/// Exponents of maps fitted to either half of the most likely signal.
fn of_halves(model: &Model, centres: usize) -> Vec<f64> {
    let (first, last) = model.signal.split_at(model.signal.len() / 2);
    let of = |half: &[f64]| again(model, half, centres / 2);
    [first, last].into_iter().filter_map(of).collect()
}

/// The exponent of a map with half as many centres: how far the resolution of the map decides.
fn coarser(model: &Model, centres: usize) -> Option<f64> {
    again(model, &model.signal, centres / 2)
}

/// The exponent of a map in the same coordinates that is fitted by plain regression to part of a signal
/// without noise.
fn again(model: &Model, signal: &[f64], centres: usize) -> Option<f64> {
    let embedding = Embedding {
        dimension: model.basis.dimension,
        delay: model.basis.delay,
    };
    let fitted = fitted(signal, signal, embedding, centres, 0)?;
    Some(Growth::new(&fitted).mean)
}

/// The rate at which neighbours part in the unfolded attractor, nats per sample.
fn divergence_rate(signal: &[f64], times: &Times) -> Result<f64, Error> {
    let delays = Delays {
        signal,
        dimension: unfolding(signal, times, LARGEST_DIMENSION - 2)?.dimension(),
        delay: times.delay,
    };
    let steps = (10.0 * times.mean_period).min(signal.len() as f64 / 10.0) as usize;
    let curve = rosenstein(&delays, times.theiler, steps)?;
    Ok(scaling_region(&curve, times.delay)?.slope)
}

/// The signal in units of its standard deviation, as means of so many samples, with a little noise.
fn prepared(signal: &[f64], mean: f64, deviation: f64, samples: usize) -> Vec<f64> {
    let mut generator = Stream::seed_from_u64(0);
    signal
        .chunks_exact(samples)
        .map(|chunk| {
            let value = chunk.iter().map(|x| (x - mean) / deviation).sum::<f64>();
            value / samples as f64 + ADDED * generator.sample::<f64, _>(StandardNormal)
        })
        .collect()
}

/// Dimension and delay.
#[derive(Clone, Copy, Debug)]
struct Embedding {
    dimension: usize,
    delay: usize,
}

/// Embeddings in order of the held-out error of a coarse map.
fn screened(y: &[f64], delay: usize) -> Vec<Embedding> {
    let mut delays = vec![delay.div_ceil(2), delay];
    delays.dedup();
    let mut found = Vec::new();
    for delay in delays {
        for dimension in 1..=LARGEST {
            let basis = Basis::new(y, dimension, delay, FEW_CENTRES.min(y.len() / PER_CENTRE));
            let count = basis.rows(y);
            let rows = (0..count).step_by(count.div_ceil(SCREENED));
            let mut ridge = FIRST_RIDGE;
            let compared = rows.len() as f64;
            let mut design = basis.design(y, rows.clone());
            set_target(&mut design, rows.map(|r| y[basis.span() + r + 1]));
            if let Some(error) = regression(&design, &mut ridge).and_then(|fit| fit.held_out()) {
                found.push((error / compared, Embedding { dimension, delay }));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, embedding)| embedding).collect()
}

fn fitted(y: &[f64], start: &[f64], e: Embedding, centres: usize, passes: usize) -> Option<Model> {
    let basis = Basis::new(y, e.dimension, e.delay, centres.min(y.len() / PER_CENTRE));
    Model::fitted(basis, y, start, passes)
}

/// Mean growth of a tangent in nats per sample, with its standard errors.
struct Growth {
    mean: f64,
    over_time: f64,
    of_map: f64,
    /// Mean square error of prediction.
    missed: f64,
}

impl Growth {
    fn new(model: &Model) -> Self {
        let folds = model.fit.folds().unwrap_or_default();
        let mut maps: Vec<&[f64]> = vec![&model.fit.map];
        maps.extend(folds.iter().map(Vec::as_slice));
        let basis = &model.basis;
        let design = basis.design(&model.signal, 0..basis.rows(&model.signal));
        let along = basis.along(&maps, &design);
        let folds: Vec<f64> = along[1..].iter().map(|l| mean(&l.growth())).collect();
        // Of delete-a-part estimates (Efron and Stein 1981).
        let of_map = (FOLDS - 1) as f64 * (variance(&folds) / FOLDS as f64).sqrt();
        Self::along(model, &along[0], of_map)
    }

    /// The same by local maps; what parts of the signal leave open is taken from here.
    fn by_local_maps(&self, model: &Model, theiler: usize) -> Option<Self> {
        let basis = &model.basis;
        let linear = local_map::along(&model.signal, basis.dimension, basis.delay, theiler)?;
        Some(Self::along(model, &linear, self.of_map))
    }

    fn along(model: &Model, linear: &Linear, of_map: f64) -> Self {
        let growth = linear.growth();
        let blocks = block_means(&growth);
        let next = &model.signal[model.basis.span() + 1..];
        let squares = linear.values.iter().zip(next).map(|(v, x)| (v - x).powi(2));
        Self {
            mean: mean(&growth),
            over_time: (variance(&blocks) / blocks.len() as f64).sqrt(),
            of_map,
            missed: squares.sum::<f64>() / next.len() as f64,
        }
    }
}

/// Sample variance.
fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Noise, Regular, System, with_noise};

    fn estimated(signal: &[f64]) -> Exponent {
        exponent(signal, &times(signal).unwrap()).unwrap()
    }

    #[test]
    fn maps_are_found_closely_also_with_noise() {
        for (system, share, tolerance) in [
            (System::Logistic, 0.0, 0.01),
            (System::Logistic, 0.05, 0.12),
            (System::Henon, 0.01, 0.04),
        ] {
            let exponent = estimated(&with_noise(&system.samples(2000, 1), share, 1));
            let error = exponent.value / system.exponent() - 1.0;
            assert!(error.abs() < tolerance, "{} {exponent:?}", system.name());
            assert!(
                (exponent.noise - share).abs() < 0.1 * share + 0.001,
                "{exponent:?}"
            );
        }
    }

    #[test]
    fn the_interval_of_a_law_with_a_corner_holds_its_exponent() {
        // The tent map: ln 1.9 everywhere but at its corner, which no smooth map follows.
        let mut x = 0.3;
        let tent: Vec<f64> = (0..2000)
            .map(|_| {
                x = 1.9 * f64::min(x, 1.0 - x);
                x
            })
            .collect();
        let truth = 1.9_f64.ln();
        for share in [0.0, 0.01] {
            let exponent = estimated(&with_noise(&tent, share, 1));
            assert!(
                exponent.low < truth && truth < exponent.high,
                "{exponent:?}"
            );
        }
    }

    #[test]
    fn the_interval_of_a_periodic_signal_reaches_zero() {
        for share in [0.0, 0.05] {
            let signal = with_noise(&Regular::Periodic.samples(2000, 1), share, 1);
            let exponent = estimated(&signal);
            assert!(exponent.low <= 0.0, "{exponent:?}");
        }
    }

    #[test]
    fn noise_alone_is_refused() {
        let signal = Noise::White.samples(2000, 1);
        let refused = exponent(&signal, &times(&signal).unwrap());
        assert!(
            matches!(refused, Err(Error::NoScalingRegion { .. })),
            "{refused:?}"
        );
    }
}
