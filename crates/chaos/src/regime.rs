//! What kind of motion a signal shows.
//!
//! Does more than half of the signal repeat itself after one period? Then what is left is judged, as
//! [`forced`](crate::forced) does: it comes back after other times (then the motion is quasi-periodic), or
//! chance enters at some phase (then it is periodic), or it is deterministic and grows (then it is
//! chaotic). Does the signal repeat itself nearly after other times? Then it is quasi-periodic. Does it
//! repeat itself in its own cycles, whose length differs? Then it is periodic. Else: is it better
//! predicted than linear noise with its spectrum and values (if not, it is stochastic)? Are there states
//! from which chance goes on (then it is undecided)? Does the exponent's own error leave it above 0 (then
//! it is chaotic), or, where it holds 0, that of the rate at which neighbours part? What is left is
//! undecided.

use crate::autocorrelation::autocorrelation;
use crate::delay::{Times, cycle_starts};
use crate::dimension::unfolding;
use crate::divergence::rosenstein;
use crate::error::{Error, checked};
use crate::exponent::{Exponent, exponent};
use crate::forced::{FEWEST_CYCLES, Growth, Scatter, residual, scatter};
use crate::innovation::{self, chance_enters_a_cell};
use crate::local_map::{Model, local_map};
use crate::neighbours::{Delays, LARGEST_DIMENSION, Neighbours};
use crate::scaling_region::{Fit, scaling_region};
use crate::surrogates::{Comparison, compare, iaaft};
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
    /// Every kind.
    pub const ALL: [Self; 5] = [
        Self::Periodic,
        Self::QuasiPeriodic,
        Self::Chaotic,
        Self::Stochastic,
        Self::Undecided,
    ];

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
    /// Largest autocorrelation at lags from a quarter to half of the signal; of its scatter, where a
    /// drive is known.
    pub recurrence: f64,
    /// What differs from cycle to cycle; `None` where not more than half of the signal repeats itself.
    pub scatter: Option<Scatter>,
    /// Whether the signal is better predicted than its surrogates are; `None` where the question was
    /// not asked.
    pub predictability: Option<Comparison>,
    /// The exponent, nats per sample; `None` where it was not needed.
    pub exponent: Option<Growth>,
}

/// Autocorrelation at long lags from which a signal without a period counts as repeating itself.
/// Noise of 5 % lowers that of a repeating signal to 0.9975.
const REPEATS: f64 = 0.95;
/// Least autocorrelation at a period: that of a signal of which half is periodic.
const HALF: f64 = 0.5;
/// Share of it that every multiple of the period must keep (of a periodic signal, all), and least
/// number of multiples.
const KEEPS: f64 = 0.9;
const MULTIPLES: usize = 8;
/// Scatter about a period that was found in the signal itself below which it is put down to
/// interpolation between samples.
const RESOLVED: f64 = 0.01;
/// Iterations of a surrogate, and most samples of it.
const ITERATIONS: usize = 20;
const SURROGATE_SAMPLES: usize = 4096;
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
    let long = &correlation[signal.len() / 4..];
    let mut verdict = Verdict {
        regime: Regime::Undecided,
        recurrence: long.iter().copied().fold(-1.0, f64::max),
        scatter: None,
        predictability: None,
        exponent: None,
    };
    let repeats = verdict.recurrence >= REPEATS;
    let period = period(&correlation);
    let cycles = period.map(|period| whole_cycles(signal, period));
    if let Some((cycles, per_cycle, length)) = cycles
        && cycles.len() >= FEWEST_CYCLES * per_cycle
    {
        let (regime, scatter) = of_scatter(&cycles, per_cycle)?;
        verdict.scatter = Some(scatter);
        // What the cycles leave comes back, too, after some other time.
        let left = (1.0 - verdict.recurrence) / scatter.share.powi(2);
        if left <= 1.0 - REPEATS && scatter.share > RESOLVED {
            verdict.regime = match regime {
                Regime::Periodic => Regime::Periodic,
                _ => Regime::QuasiPeriodic,
            };
            return Ok(verdict);
        }
        if regime == Regime::Chaotic && scatter.share > RESOLVED {
            verdict.regime = Regime::Chaotic;
            verdict.exponent = Some(scatter.growth.per(length));
            return Ok(verdict);
        }
        let chance = !scatter.is_deterministic() && chance_at_a_phase(&cycles, per_cycle);
        if repeats || chance {
            verdict.regime = Regime::Periodic;
            return Ok(verdict);
        }
    } else if repeats {
        verdict.regime = match period {
            Some(_) => Regime::Periodic,
            None => Regime::QuasiPeriodic,
        };
        return Ok(verdict);
    } else if repeats_but_for_its_speed(signal)? {
        verdict.regime = Regime::Periodic;
        return Ok(verdict);
    }
    let predictability = predictability(signal, times)?;
    verdict.predictability = Some(predictability);
    if !predictability.significant {
        verdict.regime = Regime::Stochastic;
        return Ok(verdict);
    }
    if chance_enters_a_cell(signal, times) {
        return Ok(verdict);
    }
    let by_map = match exponent(signal, times) {
        Ok(exponent) => Some(exponent),
        Err(Error::NoScalingRegion { .. }) => None,
        Err(error) => return Err(error),
    };
    // The map can say nothing, on a coarsely quantised signal for one, where neighbours part clearly.
    let (growth, grows) = match &by_map {
        Some(e) if e.grows().is_some() => (Some(e.growth()), e.grows() == Some(true)),
        _ => {
            let growth = parting(signal, times)
                .ok()
                .or(by_map.as_ref().map(Exponent::growth));
            (growth, growth.is_some_and(|growth| growth.low > 0.0))
        }
    };
    verdict.exponent = growth;
    if grows {
        verdict.regime = Regime::Chaotic;
        // Estimates that differ by as much as their value tell that it is positive, not how large.
        verdict.exponent = growth.filter(|growth| growth.low > 0.0);
    }
    Ok(verdict)
}

/// Samples of a cycle when its time is measured in the signal's own cycles.
const WARPED: usize = 32;
/// How much longer or shorter than the middle one a cycle may be: beyond, half a cycle was missed or
/// counted twice, and it is not the same cycle at another speed.
const UNEVEN: f64 = 1.5;

/// Whether the signal repeats itself once time is counted in its own cycles, and what then differs from
/// cycle to cycle owes nothing to what was: a period that drifts or fluctuates.
fn repeats_but_for_its_speed(signal: &[f64]) -> Result<bool, Error> {
    let starts = cycle_starts(signal)?;
    if starts.len() < FEWEST_CYCLES + 2 {
        return Ok(false);
    }
    let mut lengths: Vec<f64> = starts.windows(2).map(|ends| ends[1] - ends[0]).collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths[lengths.len() / 2];
    if lengths[0] < middle / UNEVEN || lengths[lengths.len() - 1] > middle * UNEVEN {
        return Ok(false);
    }
    let at = |place: f64| {
        let (whole, t) = (place as usize, place.fract());
        signal[whole] + t * (signal[(whole + 1).min(signal.len() - 1)] - signal[whole])
    };
    let warped: Vec<f64> = starts
        .windows(2)
        .flat_map(|ends| {
            let step = (ends[1] - ends[0]) / WARPED as f64;
            (0..WARPED).map(move |i| at(ends[0] + i as f64 * step))
        })
        .collect();
    let (_, deviation) = checked(&warped)?;
    let rest = residual(&warped, WARPED);
    let square = rest.iter().map(|r| r * r).sum::<f64>() / rest.len() as f64;
    let repeated = square <= (1.0 - KEEPS) * deviation * deviation;
    Ok(repeated && innovation::chance_enters(&rest, WARPED))
}

/// The cycles whose scatter is judged, as [`driven_verdict`] does.
fn of_scatter(signal: &[f64], per_cycle: usize) -> Result<(Regime, Scatter), Error> {
    let scatter = scatter(signal, per_cycle)?;
    let rest = unbiased_correlation(&residual(signal, per_cycle));
    let recurrence = rest[rest.len() / 2..].iter().copied().fold(-1.0, f64::max);
    let regime = match () {
        // The scatter itself repeats itself: after several cycles, or after other times.
        () if recurrence >= REPEATS && period(&rest).is_some() => Regime::Periodic,
        () if recurrence >= REPEATS => Regime::QuasiPeriodic,
        () if !scatter.is_deterministic() => Regime::Periodic,
        () if scatter.is_chaotic() => Regime::Chaotic,
        () => Regime::Undecided,
    };
    Ok((regime, scatter))
}

/// The rate at which nearest neighbours part, from the straight part of their divergence curve, with
/// the spread of the rates in dimensions beside that of the unfolded attractor.
fn parting(signal: &[f64], times: &Times) -> Result<Growth, Error> {
    let unfolded = unfolding(signal, times, LARGEST_DIMENSION - 2)?.dimension();
    let steps = (10.0 * times.mean_period).min(signal.len() as f64 / 10.0) as usize;
    let fits = (unfolded..=unfolded + 2)
        .map(|dimension| {
            let delays = Delays {
                signal,
                dimension,
                delay: times.delay,
            };
            scaling_region(&rosenstein(&delays, times.theiler, steps)?, times.delay)
        })
        .collect::<Result<Vec<Fit>, Error>>()?;
    let count = fits.len() as f64;
    let value = fits.iter().map(|f| f.slope).sum::<f64>() / count;
    let square = fits.iter().map(|f| (f.slope - value).powi(2)).sum::<f64>() / (count - 1.0);
    // The two-sided 95 % quantile of Student's t for the spread of three.
    let half = 4.303 * square.sqrt().max(fits[0].standard_error);
    Ok(Growth {
        value,
        low: value - half,
        high: value + half,
    })
}

/// The verdict on a signal with `per_cycle` samples in each cycle of a drive that repeats more than half
/// of it; `None` where the drive repeats less: then [`verdict`] serves, and whether chance enters at
/// some phase of the drive ([`chance_at_a_phase`]).
pub fn driven_verdict(signal: &[f64], per_cycle: usize) -> Result<Option<Verdict>, Error> {
    let (regime, scatter) = of_scatter(signal, per_cycle)?;
    if scatter.share * scatter.share > HALF {
        return Ok(None);
    }
    let rest = unbiased_correlation(&residual(signal, per_cycle));
    Ok(Some(Verdict {
        regime,
        recurrence: rest[rest.len() / 2..].iter().copied().fold(-1.0, f64::max),
        scatter: Some(scatter),
        predictability: None,
        exponent: (regime == Regime::Chaotic).then(|| scatter.growth.per(per_cycle as f64)),
    }))
}

/// Whether at some phase of a drive with `per_cycle` samples in each cycle the past says nothing of what
/// follows.
pub fn chance_at_a_phase(signal: &[f64], per_cycle: usize) -> bool {
    innovation::chance_enters(&residual(signal, per_cycle), per_cycle)
}

/// Fewest samples of a cycle whose scatter is judged.
const FEWEST_PER_CYCLE: f64 = 8.0;

/// The signal in cycles of whole numbers of samples, that number, and how long a cycle is in samples of
/// the signal. Several short periods make a cycle: to interpolate between their samples would make
/// noise predictable. Where whole cycles end between samples, the signal is interpolated to the next
/// whole number of them.
fn whole_cycles(signal: &[f64], period: f64) -> (Vec<f64>, usize, f64) {
    let fewest = (FEWEST_PER_CYCLE / period).ceil().max(1.0) as usize;
    // Half a sample at the most over the whole signal.
    let strays = |length: f64| {
        let cycles = signal.len() as f64 / length;
        (length - length.round()).abs() * cycles > 0.5
    };
    let multiples = (fewest..2 * fewest.max(2)).map(|count| count as f64 * period);
    if let Some(length) = multiples.into_iter().find(|length| !strays(*length)) {
        return (signal.to_vec(), length.round() as usize, length.round());
    }
    let length = sharpened(signal, fewest as f64 * period);
    let per_cycle = length.ceil() as usize;
    (
        interpolated(signal, length / per_cycle as f64),
        per_cycle,
        length,
    )
}

/// The length of a cycle that leaves least to differ from cycle to cycle, among those within a sample of
/// the given one over the whole signal.
fn sharpened(signal: &[f64], length: f64) -> f64 {
    let cycles = (signal.len() as f64 / length).floor();
    let left = |length: f64| {
        let per_cycle = length.ceil() as usize;
        let rest = residual(&interpolated(signal, length / per_cycle as f64), per_cycle);
        rest.iter().map(|r| r * r).sum::<f64>() / rest.len() as f64
    };
    let mut best = (left(length), length);
    for reach in [1.0, 0.2] {
        let middle = best.1;
        for step in (-5..=5).filter(|step| *step != 0) {
            let other = middle + f64::from(step) / 5.0 * reach / cycles;
            let found = left(other);
            if found < best.0 {
                best = (found, other);
            }
        }
    }
    best.1
}

/// The signal at every `step` samples (cubic: Keys 1981).
fn interpolated(signal: &[f64], step: f64) -> Vec<f64> {
    let count = ((signal.len() - 3) as f64 / step) as usize;
    let at = |i: usize| {
        let place = 1.0 + i as f64 * step;
        let (whole, t) = (place as usize, place.fract());
        let [a, b, c, d] = [whole - 1, whole, whole + 1, whole + 2].map(|j| signal[j]);
        b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
    };
    (0..count).map(at).collect()
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

/// The shortest period in samples at every multiple of which the autocorrelation is high.
fn period(correlation: &[f64]) -> Option<f64> {
    let fallen = correlation.iter().position(|r| *r < HALF)?;
    (fallen.max(1)..correlation.len() / MULTIPLES)
        .filter(|&lag| correlation[lag] >= correlation[lag - 1].max(correlation[lag + 1]))
        .map(|lag| peak(correlation, lag))
        .filter(|(_, height)| *height > HALF)
        .find_map(|(lag, height)| kept_period(correlation, lag, KEEPS * height))
}

/// A period, sharpened, if the autocorrelation is at least `kept` at every multiple of it.
fn kept_period(correlation: &[f64], mut period: f64, kept: f64) -> Option<f64> {
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
        if height < kept {
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

/// Whether the signal is better predicted than its surrogates are (Theiler et al. 1992).
pub fn predictability(signal: &[f64], times: &Times) -> Result<Comparison, Error> {
    let needed = 10 * times.delay + 2 * times.theiler + 100;
    let too_short = Error::TooShort {
        found: signal.len(),
        needed,
    };
    if signal.len() < needed {
        return Err(too_short);
    }
    let whole = joined_at_the_ends(signal, needed);
    let own = prediction_error(whole, times).ok_or(too_short.clone())?;
    let mut generator = Stream::seed_from_u64(0);
    compare(own, || {
        prediction_error(&iaaft(whole, ITERATIONS, &mut generator), times)
    })
    .ok_or(too_short)
}

/// The stretch of a length that transforms fast whose end meets its start best: a jump there would
/// spread over the surrogate's spectrum (Schreiber and Schmitz 2000, section 4.5).
fn joined_at_the_ends(signal: &[f64], needed: usize) -> &[f64] {
    let most = (signal.len() - signal.len() / 20).clamp(needed, SURROGATE_SAMPLES.max(needed));
    let length = (needed..=most)
        .rev()
        .find(|n| is_smooth(*n))
        .unwrap_or(most);
    let mismatch = |start: usize| {
        let end = start + length;
        let jump = signal[end - 1] - signal[start];
        let kink = (signal[end - 1] - signal[end - 2]) - (signal[start + 1] - signal[start]);
        jump * jump + kink * kink
    };
    let start = (0..=signal.len() - length)
        .min_by(|&a, &b| mismatch(a).total_cmp(&mismatch(b)))
        .unwrap_or(0);
    &signal[start..start + length]
}

/// Whether a number has no prime factor above 5.
fn is_smooth(mut number: usize) -> bool {
    for factor in [2, 3, 5] {
        while number.is_multiple_of(factor) {
            number /= factor;
        }
    }
    number == 1
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
    use std::f64::consts::TAU;

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
    fn noise_on_a_short_period_is_not_chaos() {
        let alternating: Vec<f64> = (0..2000).map(|i| f64::from(i % 2)).collect();
        let mut x = 0.3;
        let mut logistic = || {
            x = 3.5 * x * (1.0 - x);
            x
        };
        (0..2000).for_each(|_| {
            logistic();
        });
        let four: Vec<f64> = (0..4000).map(|_| logistic()).collect();
        for (signal, share) in [(&alternating, 0.05), (&four, 0.01), (&four, 0.05)] {
            let verdict = found(&with_noise(signal, share, 1));
            assert_eq!(verdict.regime, Regime::Periodic, "{share} {verdict:?}");
        }
    }

    #[test]
    fn a_circle_map_near_the_golden_rotation_is_no_chaos() {
        let mut angle = 0.1;
        let signal: Vec<f64> = (0..4000)
            .map(|_| {
                angle += 0.606_661_063 - 0.9 / TAU * (TAU * angle).sin();
                (TAU * angle).sin()
            })
            .collect();
        for share in [0.0, 0.01] {
            let verdict = found(&with_noise(&signal, share, 1));
            assert_ne!(verdict.regime, Regime::Chaotic, "{verdict:?}");
            assert_eq!(verdict.exponent, None);
        }
    }

    #[test]
    fn a_speed_that_drifts_is_no_chaos() {
        // 40 cycles, the last 2 % faster than the first.
        let signal: Vec<f64> = (0..4000)
            .map(|i| {
                let t = f64::from(i) / 4000.0;
                let turned = TAU * 40.0 * (t + 0.01 * t * t);
                turned.sin() + 0.5 * (2.0 * turned + 1.0).sin() + 0.3 * (5.0 * turned).cos()
            })
            .collect();
        for share in [0.01, 0.05] {
            let verdict = found(&with_noise(&signal, share, 1));
            assert_eq!(verdict.regime, Regime::Periodic, "{verdict:?}");
            assert_eq!(verdict.exponent, None);
        }
    }

    #[test]
    fn a_clean_periodic_signal_has_its_period() {
        for (signal, expected) in [(Regular::Periodic, 20.3), (Regular::KnockTrain, 47.3)] {
            let found = period(&unbiased_correlation(&signal.samples(2000, 1))).unwrap();
            assert!((found - expected).abs() < 0.01, "{signal:?} {found}");
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
