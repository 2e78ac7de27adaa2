//! What kind of motion a signal shows.
//!
//! The questions come in this order:
//!
//! 1. Does more than half of the signal repeat itself after one period? Then the rest is judged, as
//!    [`forced`](crate::forced) does. If it comes back after other times, the motion is quasi-periodic. If
//!    chance enters at some phase, it is periodic. If it is deterministic and grows, it is chaotic.
//! 2. Does the signal repeat itself nearly after other times? Then it is quasi-periodic.
//! 3. Does it repeat itself in its own cycles, whose length differs? Then it is periodic.
//! 4. Is it better predicted than linear noise with its spectrum and values? If not, it is stochastic.
//! 5. Are there states from which chance goes on? Then it is undecided.
//! 6. Does the exponent's own error leave it above 0? Then it is chaotic. Where that error includes 0, the rate at
//!    which neighbours part decides.
//! 7. All others are undecided.

use crate::cycles::{self, HALF, period, returns_at_other_times, similarity};
use crate::delay::Times;
use crate::dimension::unfolding;
use crate::divergence::rosenstein;
use crate::error::{Error, checked};
use crate::exponent::{Exponent, exponent};
use crate::forced::{Growth, Scatter, residual, scatter};
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
    /// Not distinguishable from linear noise.
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
/// Largest share of the variance that a signal which nearly repeats itself leaves to differ from cycle to
/// cycle.
const NEARLY_ALL: f64 = 0.1;
/// Scatter about a period that was found in the signal itself below which it is put down to
/// interpolation between samples.
const RESOLVED: f64 = 0.01;
/// Scatter about a given cycle below which it is what single precision rounds off and resampling adds: three tones of single
/// precision without noise, resampled to equal angles, have 8e-7.
const ROUNDED: f64 = 1e-5;
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
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for one of the tests that it comes to.
pub fn verdict(signal: &[f64], times: &Times) -> Result<Verdict, Error> {
    checked(signal)?;
    let similarity = similarity(signal);
    let long = &similarity[signal.len() / 4..];
    let mut verdict = Verdict {
        regime: Regime::Undecided,
        recurrence: long.iter().copied().fold(-1.0, f64::max),
        scatter: None,
        predictability: None,
        exponent: None,
    };
    let repeats = verdict.recurrence >= REPEATS;
    let period = period(&similarity);
    if repeats && period.is_none_or(|period| returns_at_other_times(&similarity, period)) {
        verdict.regime = Regime::QuasiPeriodic;
        return Ok(verdict);
    }
    if let Some(cycles) = period.and_then(|period| cycles::of_one_period(signal, period)) {
        let (regime, scatter) = of_scatter(&cycles.signal, cycles.per_cycle)?;
        verdict.scatter = Some(scatter);
        if regime == Regime::Chaotic && scatter.share > RESOLVED {
            verdict.regime = match in_cycles_of_changing_length(signal, Some(scatter))? {
                None | Some((Regime::Chaotic, _)) => Regime::Chaotic,
                Some((_, scatter)) if scatter.is_chance() => Regime::Periodic,
                Some(_) => Regime::Undecided,
            };
            let is_chaotic = verdict.regime == Regime::Chaotic;
            verdict.exponent = is_chaotic.then(|| scatter.growth.per(cycles.length));
            return Ok(verdict);
        }
        if repeats || scatter.is_chance() {
            verdict.regime = Regime::Periodic;
            return Ok(verdict);
        }
    }
    let repeats_but_for_its_speed = in_cycles_of_changing_length(signal, verdict.scatter)?
        .is_some_and(|(_, scatter)| scatter.is_chance());
    if repeats || repeats_but_for_its_speed {
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
        // Estimates that differ by as much as their value show that it is positive, not how large.
        verdict.exponent = growth.filter(|growth| growth.low > 0.0);
    }
    Ok(verdict)
}

/// What the signal is in its own cycles, whose length changes where a speed drifts or fluctuates. None unless they leave
/// little to differ from cycle to cycle, and less than half of what cycles of one length leave, `fixed`.
fn in_cycles_of_changing_length(
    signal: &[f64],
    fixed: Option<Scatter>,
) -> Result<Option<(Regime, Scatter)>, Error> {
    let Some(cycles) = cycles::of_changing_length(signal) else {
        return Ok(None);
    };
    let most = fixed.map_or(NEARLY_ALL, |fixed| {
        NEARLY_ALL.min(HALF * fixed.share.powi(2))
    });
    let (regime, scatter) = of_scatter(&cycles.signal, cycles.per_cycle)?;
    Ok((scatter.share.powi(2) <= most).then_some((regime, scatter)))
}

/// The cycles whose scatter is judged, as [`driven_verdict`] does.
fn of_scatter(signal: &[f64], per_cycle: usize) -> Result<(Regime, Scatter), Error> {
    let scatter = scatter(signal, per_cycle)?;
    let rest = similarity(&residual(signal, per_cycle));
    let recurrence = rest[rest.len() / 2..].iter().copied().fold(-1.0, f64::max);
    let regime = match () {
        () if scatter.share < ROUNDED => Regime::Periodic,
        // The scatter itself repeats itself: after several cycles, or after other times.
        () if recurrence >= REPEATS && repeats_after_cycles(&rest, per_cycle) => Regime::Periodic,
        () if recurrence >= REPEATS => Regime::QuasiPeriodic,
        () if !scatter.is_deterministic() => Regime::Periodic,
        () if scatter.is_chaotic() => Regime::Chaotic,
        () => Regime::Undecided,
    };
    Ok((regime, scatter))
}

/// Whether what differs from cycle to cycle, by its similarity, comes back after a few cycles, and not nearer after other times.
fn repeats_after_cycles(rest: &[f64], per_cycle: usize) -> bool {
    let periods = (per_cycle..=rest.len() / 2).step_by(per_cycle);
    let first = periods.into_iter().find(|period| rest[*period] >= REPEATS);
    first.is_some_and(|period| {
        let left = 1.0 - rest[period];
        left <= RESOLVED * RESOLVED || !returns_at_other_times(rest, period as f64)
    })
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

/// How the phase of a drive is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// It was recorded.
    Recorded,
    /// From a speed that is stated, and that may drift.
    Stated,
}

/// The verdict on a signal with `per_cycle` samples in each cycle of a drive that repeats more than half
/// of it; `None` where the drive repeats less: then [`verdict`] serves, and whether chance enters at
/// some phase of the drive ([`chance_at_a_phase`]).
///
/// # Errors
/// As [`scatter`].
pub fn driven_verdict(
    signal: &[f64],
    per_cycle: usize,
    phase: Phase,
) -> Result<Option<Verdict>, Error> {
    let (mut regime, scatter) = of_scatter(signal, per_cycle)?;
    if scatter.share * scatter.share > HALF {
        return Ok(None);
    }
    // The scatter of a speed that drifts grows, too. It is less in cycles of changing length.
    if regime == Regime::Chaotic
        && phase == Phase::Stated
        && let Some((_, in_its_own)) = in_cycles_of_changing_length(signal, Some(scatter))?
    {
        regime = match in_its_own.is_chance() {
            true => Regime::Periodic,
            false => Regime::Undecided,
        };
    }
    let rest = similarity(&residual(signal, per_cycle));
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

/// Whether the signal is better predicted than its surrogates are (Theiler et al. 1992).
///
/// # Errors
/// A signal that is too short for `times`.
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

/// The stretch of a length that transforms fast whose end meets its start best. A jump there would
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
    use crate::test_systems::{Machine, Memory, Noise, Regular, System, with_noise};
    use std::f64::consts::TAU;

    fn judged(signal: &[f64]) -> Verdict {
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
                let verdict = judged(&with_noise(&signal.samples(4000, 1), share, 1));
                assert_eq!(verdict.regime, expected, "{signal:?} {share} {verdict:?}");
            }
        }
    }

    #[test]
    fn noises_are_stochastic_and_chaos_is_chaotic() {
        for noise in Noise::ALL {
            let verdict = judged(&noise.samples(3000, 1));
            assert_eq!(verdict.regime, Regime::Stochastic, "{noise:?} {verdict:?}");
        }
        for system in [System::Logistic, System::Henon, System::Lorenz] {
            let verdict = judged(&with_noise(&system.samples(3000, 1), 0.01, 1));
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
            let verdict = judged(&with_noise(signal, share, 1));
            assert_eq!(verdict.regime, Regime::Periodic, "{share} {verdict:?}");
        }
    }

    #[test]
    fn a_circle_map_near_the_golden_rotation_is_quasi_periodic() {
        for length in [1000, 2000, 4000] {
            let mut angle = 0.1;
            let signal: Vec<f64> = (0..length)
                .map(|_| {
                    angle += 0.606_661_063 - 0.9 / TAU * (TAU * angle).sin();
                    (TAU * angle).sin()
                })
                .collect();
            for share in [0.0, 0.01] {
                let verdict = judged(&with_noise(&signal, share, 1));
                assert_eq!(verdict.regime, Regime::QuasiPeriodic, "{verdict:?}");
                assert_eq!(verdict.exponent, None);
            }
        }
    }

    #[test]
    fn knocks_of_a_speed_that_drifts_are_no_chaos() {
        // A ring of 5 samples, struck after 47.3 samples at first and 2 % sooner at the end of 60 cycles.
        let strikes: Vec<f64> = (0..70)
            .scan(3.0, |at, k| {
                let here = *at;
                *at += 47.3 * (1.0 - 0.02 * f64::from(k) / 60.0);
                Some(here)
            })
            .collect();
        let ring = |since: f64| (-since / 8.0).exp() * (TAU * since / 5.0).sin();
        let signal: Vec<f64> = (0..2838)
            .map(|i| {
                let struck = strikes.iter().map(|at| f64::from(i) - at);
                struck.filter(|since| *since >= 0.0).map(ring).sum()
            })
            .collect();
        let verdict = judged(&signal);
        assert_eq!(verdict.regime, Regime::Periodic, "{verdict:?}");
        assert_eq!(verdict.exponent, None);
    }

    #[test]
    fn chance_that_lasts_for_cycles_is_no_chaos_without_a_crank_angle() {
        for (machine, memory, seed) in [
            (Machine::ImpactOscillator, Memory::None, 1),
            (Machine::ImpactOscillator, Memory::Ninety, 1),
            (Machine::MissingKnock, Memory::Ninety, 1),
            (Machine::TwoLoads, Memory::Ninety, 3),
        ] {
            let verdict = judged(&machine.samples(80, 100, 0.1, memory, seed));
            assert_ne!(verdict.regime, Regime::Chaotic, "{machine:?} {verdict:?}");
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
            let verdict = judged(&with_noise(&signal, share, 1));
            assert_eq!(verdict.regime, Regime::Periodic, "{verdict:?}");
            assert_eq!(verdict.exponent, None);
        }
    }

    /// A wave of 100 samples a cycle and its third harmonic, whose cycles are `turn(cycle)` of a cycle early, and something on top.
    fn driven(cycles: usize, turn: impl Fn(f64) -> f64, top: impl Fn(f64) -> f64) -> Vec<f64> {
        let at = |i: usize| {
            let t = i as f64 / 100.0;
            let phase = TAU * (t + turn(t));
            phase.sin() + 0.4 * (3.0 * phase + 1.0).cos() + top(t)
        };
        (0..100 * cycles).map(at).collect()
    }

    fn driven_by(signal: &[f64], phase: Phase) -> Regime {
        driven_verdict(signal, 100, phase).unwrap().unwrap().regime
    }

    #[test]
    fn what_is_rounded_off_is_no_motion() {
        let single = |x: &f64| f64::from(*x as f32);
        let signal = driven(40, |_| 0.0, |_| 0.0);
        let signal: Vec<f64> = signal.iter().map(single).collect();
        assert_eq!(driven_by(&signal, Phase::Recorded), Regime::Periodic);
    }

    #[test]
    fn a_tone_between_the_orders_of_a_drive_is_quasi_periodic() {
        let tone = |ratio: f64| move |t: f64| 0.5 * (TAU * ratio * t).cos();
        for (ratio, expected) in [
            (0.618_034, Regime::QuasiPeriodic),
            (2f64.sqrt(), Regime::QuasiPeriodic),
            (0.5, Regime::Periodic),
            (3.5, Regime::Periodic),
            (4.0 / 3.0, Regime::Periodic),
        ] {
            let clean = driven(40, |_| 0.0, tone(ratio));
            for share in [0.0, 0.01] {
                let found = driven_by(&with_noise(&clean, share, 1), Phase::Recorded);
                assert_eq!(found, expected, "{ratio} {share}");
            }
        }
    }

    #[test]
    fn a_speed_that_wanders_about_the_stated_one_is_no_chaos() {
        for seed in 1..5 {
            let wander = |t: f64| 0.03 * (TAU * t / 26.0).sin();
            let signal = with_noise(&driven(40, wander, |_| 0.0), 0.01, seed);
            assert_ne!(driven_by(&signal, Phase::Stated), Regime::Chaotic, "{seed}");
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
