//! What kind of motion a signal shows.
//!
//! Three questions in order. Does the signal repeat itself after a long time (then it is regular)?
//! Is it better predicted than linear noise with its spectrum and values (if not, it is stochastic)?
//! Does the interval of its exponent lie above 0 (then it is chaotic)? What is left is undecided.

use crate::autocorrelation::autocorrelation;
use crate::delay::Times;
use crate::error::{Error, checked};
use crate::exponent::{Exponent, exponent};
use crate::local_map::{Model, local_map};
use crate::neighbours::{Delays, Neighbours};
use crate::surrogates::iaaft;
use rand::SeedableRng;
use scalar::random::Stream;

/// The verdict on a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Repeats itself after one period.
    Periodic,
    /// Repeats itself nearly, after times that are no multiples of one period.
    QuasiPeriodic,
    /// Deterministic with a positive exponent.
    Chaotic,
    /// Not to be told from linear noise.
    Stochastic,
    /// None of these can be said.
    Undecided,
}

impl Regime {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Periodic => "periodic",
            Self::QuasiPeriodic => "quasi-periodic",
            Self::Chaotic => "chaotic",
            Self::Stochastic => "stochastic",
            Self::Undecided => "undecided",
        }
    }
}

/// The verdict with what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The kind of motion.
    pub regime: Regime,
    /// Largest autocorrelation at lags from a quarter to half of the signal.
    pub recurrence: f64,
    /// How many standard deviations better than surrogates the signal is predicted; `None` where it
    /// repeats itself and the question was not asked.
    pub predictability: Option<f64>,
    /// The exponent; `None` where it was not needed.
    pub exponent: Option<Exponent>,
}

/// Autocorrelation at long lags from which a signal counts as repeating itself. Noise of 5 % lowers
/// that of a repeating signal to 0.9975.
const REPEATS: f64 = 0.95;
/// Autocorrelation that every multiple of a period must keep.
const PERIOD_KEEPS: f64 = 0.9;
/// Surrogates, iterations of each, and standard deviations by which the signal must differ.
const SURROGATES: usize = 19;
const ITERATIONS: usize = 50;
const DIFFERS: f64 = 3.0;
/// Vectors predicted in the surrogate test.
const TRIALS: usize = 500;
/// The predictor of the surrogate test.
const PREDICTOR: Model = Model {
    dimension: 4,
    neighbours: 20,
    quadratic: false,
    ridge: 1e-3,
};

/// The verdict on a signal.
pub fn verdict(signal: &[f64], times: &Times) -> Result<Verdict, Error> {
    checked(signal)?;
    let correlation = unbiased_correlation(signal);
    let recurrence = correlation[signal.len() / 4..]
        .iter()
        .copied()
        .fold(-1.0, f64::max);
    let mut verdict = Verdict {
        regime: Regime::Undecided,
        recurrence,
        predictability: None,
        exponent: None,
    };
    if recurrence >= REPEATS {
        verdict.regime = match period(&correlation) {
            Some(_) => Regime::Periodic,
            None => Regime::QuasiPeriodic,
        };
        return Ok(verdict);
    }
    let predictability = predictability(signal, times)?;
    verdict.predictability = Some(predictability);
    if predictability < DIFFERS {
        verdict.regime = Regime::Stochastic;
        return Ok(verdict);
    }
    let exponent = exponent(signal, times)?;
    if exponent.low > 0.0 {
        verdict.regime = Regime::Chaotic;
    }
    verdict.exponent = Some(exponent);
    Ok(verdict)
}

/// Autocorrelation up to half of the signal, made up for the shrinking overlap.
fn unbiased_correlation(signal: &[f64]) -> Vec<f64> {
    let length = signal.len() as f64;
    let mut correlation = autocorrelation(signal, signal.len() / 2);
    for (lag, r) in correlation.iter_mut().enumerate() {
        *r *= length / (length - lag as f64);
    }
    correlation
}

/// The period in samples, where the autocorrelation is high at every multiple of it.
fn period(correlation: &[f64]) -> Option<f64> {
    let fallen = correlation.iter().position(|r| *r < 0.5)?;
    let (mut period, _) = (fallen.max(1)..correlation.len() - 1)
        .filter(|&lag| correlation[lag] >= correlation[lag - 1].max(correlation[lag + 1]))
        .map(|lag| peak(correlation, lag))
        .find(|(_, height)| *height > PERIOD_KEEPS)?;
    let mut multiple = 1.0;
    // Each multiple found sharpens the period with which the next is looked for.
    loop {
        multiple += 1.0;
        let centre = (multiple * period).round() as usize;
        if centre + 2 >= correlation.len() {
            return Some(period);
        }
        let highest =
            (centre - 1..=centre + 1).max_by(|&a, &b| correlation[a].total_cmp(&correlation[b]))?;
        let (place, height) = peak(correlation, highest);
        if height < PERIOD_KEEPS {
            return None;
        }
        period = place / multiple;
    }
}

/// Place and height of the parabola through the values at `lag` and beside it.
fn peak(correlation: &[f64], lag: usize) -> (f64, f64) {
    let [before, here, after] = [lag - 1, lag, lag + 1].map(|i| correlation[i]);
    let curvature = before - 2.0 * here + after;
    if curvature >= 0.0 {
        return (lag as f64, here);
    }
    let shift = (0.5 * (before - after) / curvature).clamp(-1.0, 1.0);
    (lag as f64 + shift, here - 0.25 * (before - after) * shift)
}

/// How much better the signal is predicted than its surrogates are (Theiler et al. 1992), in
/// standard deviations among the surrogates.
pub fn predictability(signal: &[f64], times: &Times) -> Result<f64, Error> {
    let needed = 10 * times.delay + 2 * times.theiler + 100;
    let too_short = Error::TooShort {
        found: signal.len(),
        needed,
    };
    if signal.len() < needed {
        return Err(too_short);
    }
    let whole = joined_at_the_ends(signal);
    let own = prediction_error(whole, times).ok_or(too_short.clone())?;
    let mut generator = Stream::seed_from_u64(0);
    let errors = (0..SURROGATES)
        .map(|_| prediction_error(&iaaft(whole, ITERATIONS, &mut generator), times))
        .collect::<Option<Vec<f64>>>()
        .ok_or(too_short)?;
    let count = SURROGATES as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Ok((mean - own) / variance.sqrt().max(1e-12))
}

/// The signal without the few samples that make its end meet its start worst: a jump there would
/// spread over the surrogate's spectrum (Schreiber and Schmitz 2000, section 4.5).
fn joined_at_the_ends(signal: &[f64]) -> &[f64] {
    let slack = signal.len() / 20;
    let mismatch = |start: usize, end: usize| {
        let jump = signal[end - 1] - signal[start];
        let kink = (signal[end - 1] - signal[end - 2]) - (signal[start + 1] - signal[start]);
        jump * jump + kink * kink
    };
    let (start, end) = (0..slack)
        .flat_map(|start| {
            (signal.len() - slack..=signal.len())
                .step_by(7)
                .map(move |end| (start, end))
        })
        .min_by(|&(a, b), &(c, d)| mismatch(a, b).total_cmp(&mismatch(c, d)))
        .unwrap_or((0, signal.len()));
    &signal[start..end]
}

/// Logarithm of the root mean square error of prediction one delay ahead.
fn prediction_error(signal: &[f64], times: &Times) -> Option<f64> {
    let delays = Delays {
        signal,
        dimension: PREDICTOR.dimension,
        delay: times.delay,
    };
    let count = delays.count() - times.delay;
    let search = Neighbours::new(&delays, count, times.theiler)?;
    let squares: Vec<f64> = (0..count)
        .step_by(count.div_ceil(TRIALS))
        .filter_map(|index| {
            let near = search.nearest(index, PREDICTOR.neighbours);
            let map = local_map(&delays, index, &near, &PREDICTOR)?;
            Some((map.value - delays.at(index, PREDICTOR.dimension)).powi(2))
        })
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    (mean > 0.0).then(|| 0.5 * mean.ln())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Noise, Regular, System, with_noise};

    fn found(signal: &[f64]) -> Verdict {
        verdict(signal, &times(signal).unwrap()).unwrap()
    }

    #[test]
    fn regular_signals_are_regular_also_with_noise() {
        for share in [0.0, 0.01, 0.05] {
            for (signal, expected) in [
                (Regular::Periodic, Regime::Periodic),
                (Regular::TwoTone, Regime::QuasiPeriodic),
                (Regular::KnockTrain, Regime::Periodic),
            ] {
                let verdict = found(&with_noise(&signal.samples(4000, 1), share, 1));
                assert_eq!(verdict.regime, expected, "{signal:?} {share} {verdict:?}");
            }
        }
    }

    #[test]
    fn noises_are_stochastic_and_chaos_is_chaotic() {
        for noise in Noise::ALL {
            let verdict = found(&noise.samples(3000, 1));
            assert_eq!(verdict.regime, Regime::Stochastic, "{noise:?} {verdict:?}");
        }
        for system in [System::Logistic, System::Henon, System::Lorenz] {
            let verdict = found(&with_noise(&system.samples(3000, 1), 0.01, 1));
            assert_eq!(
                verdict.regime,
                Regime::Chaotic,
                "{} {verdict:?}",
                system.name()
            );
        }
    }

    #[test]
    fn bad_signals_are_refused() {
        let signal = System::Lorenz.samples(500, 1);
        let times = times(&signal).unwrap();
        assert!(verdict(&signal[..50], &times).is_err());
        assert!(verdict(&[1.0; 500], &times).is_err());
    }
}
