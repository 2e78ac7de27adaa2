//! What kind of motion a window shows: periodic, chaotic or neither, in numbers.
//!
//! One signal of the window is analysed: its first acceleration (m/s^2), else its first channel but the
//! crank angle. Entropies, dimension and recurrence take it decimated, against aliasing, to at most
//! [`POINTS`] samples, but not below [`PER_PERIOD`] in its mean period. A longer signal is cut at its
//! end. Regime, exponent and 0-1 test come from the signal over crank angle, with [`PER_REVOLUTION`]
//! samples a revolution, by its scatter from revolution to revolution (crate chaos, module forced). They
//! come from the decimated samples where no shaft is known, or where the shaft repeats less than half of
//! the signal.

use crate::cut_off::cut_off;
use crate::definition::{Definition, Group};
use crate::reason::Reason;
use crate::spectral::crank_angle;
use crate::window::{Window, has_features};
use chaos::correlation_dimension::correlation_dimension;
use chaos::delay::{Times, times};
use chaos::dimension::unfolding;
use chaos::entropy::{multiscale_entropy, permutation_entropy, sample_entropy};
use chaos::forced::{FEWEST_CYCLES, Growth};
use chaos::neighbours::Delays;
use chaos::recurrence::recurrence;
use chaos::regime::{Phase, Regime, Verdict, chance_at_a_phase, driven_verdict, verdict};
use chaos::zero_one::zero_one;
use signal::angle_resampling::AngleGrid;
use signal::decimate::Decimator;

/// Most samples that are analysed.
const POINTS: usize = 10_000;
/// Samples of a mean period below which nothing is decimated.
const PER_PERIOD: f64 = 20.0;
/// Samples of a revolution: orders to 100.
const PER_REVOLUTION: usize = 256;
/// Of these, one in so many for the 0-1 test: 16 a revolution. The tones of a revolution stay apart in
/// a tenth of a hundred revolutions, which is how far the test looks.
const ZERO_ONE_STEP: usize = PER_REVOLUTION / 16;
/// Most coordinates tried for the dimension.
const COORDINATES: usize = 8;
/// Order of the permutation entropy, and scales of the multiscale entropy.
const ORDER: usize = 5;
const SCALES: usize = 5;
/// Share of the samples that are cut off above which a signal is not analysed.
const CUT_SHARE: f64 = 0.01;

/// The motion of a window. Numbers are in the order of [`motion_definitions`].
#[derive(Clone, Debug)]
pub struct Motion {
    /// Name of the regime: periodic, quasi-periodic, chaotic, stochastic or undecided.
    pub regime: Result<&'static str, Reason>,
    /// Largest exponent, its low and its high end, and the other measures.
    pub numbers: Vec<Result<f64, Reason>>,
}

const ROSENSTEIN: &str = "Rosenstein et al. 1993 at equal phases (Stark 1999) with saturation (Stroe, \
    Royer 1993), or a map with errors in variables; crate chaos, modules forced and exponent";
const MARWAN: &str = "Marwan et al. 2007, Physics Reports 438, 237";

/// The numbers that describe a motion; the same for every recording.
pub fn motion_definitions() -> Vec<Definition> {
    let line = |name: &str, unit: &str, description: &str, formula, source| Definition {
        name: name.to_owned(),
        feature: name.to_owned(),
        group: Group::Motion,
        unit: unit.to_owned(),
        description: description.to_owned(),
        formula,
        source,
    };
    vec![
        line(
            "lyapunov_per_s",
            "1/s",
            "Largest Lyapunov exponent, from the signal; none where the motion is not chaotic",
            "mean of d ln|δ|/dt along the motion",
            ROSENSTEIN,
        ),
        line(
            "lyapunov_low_per_s",
            "1/s",
            "Low end of the 95 % interval of lyapunov_per_s",
            "value − √(statistical² + model²)",
            ROSENSTEIN,
        ),
        line(
            "lyapunov_high_per_s",
            "1/s",
            "High end of the 95 % interval of lyapunov_per_s",
            "value + √(statistical² + model²)",
            ROSENSTEIN,
        ),
        line(
            "zero_one_test",
            "1",
            "0-1 test: near 1 for chaos and noise, near 0 for regular motion",
            "median over c of corr(t, M_c(t))",
            "Gottwald, Melbourne 2009, SIAM J. Applied Dynamical Systems 8, 129",
        ),
        line(
            "sample_entropy",
            "1",
            "Sample entropy, nats: stretches of 2, tolerance 0.2 standard deviations",
            "−ln(A/B), B pairs of stretches alike, A alike in the next sample too",
            "Richman, Moorman 2000, Am. J. Physiology 278, H2039",
        ),
        line(
            "permutation_entropy",
            "1",
            "Entropy of the orders in which 5 samples a delay apart stand; 1 for noise",
            "−Σ p ln p / ln 5!",
            "Bandt, Pompe 2002, Physical Review Letters 88, 174102",
        ),
        line(
            "multiscale_entropy",
            "1",
            "Mean of the sample entropies of the signal averaged in blocks of 1 to 5 samples, nats",
            "Σ_s SampEn(x̄_s, 2, 0.15 σ) / 5",
            "Costa, Goldberger, Peng 2002, Physical Review Letters 89, 068102",
        ),
        line(
            "correlation_dimension",
            "1",
            "Correlation dimension of the embedded signal",
            "d ln C(r) / d ln r",
            "Grassberger, Procaccia 1983, Physica D 9, 189",
        ),
        line(
            "recurrence_rate",
            "1",
            "Share of pairs of states closer than a fifth of the RMS distance of independent ones",
            "Σ R_ij / N²",
            MARWAN,
        ),
        line(
            "determinism",
            "1",
            "Share of the recurrences in diagonal lines of 2 or more",
            "Σ_{l≥2} l P(l) / Σ l P(l)",
            MARWAN,
        ),
        line(
            "laminarity",
            "1",
            "Share of the recurrences in vertical lines of 2 or more",
            "Σ_{v≥2} v P(v) / Σ v P(v)",
            MARWAN,
        ),
    ]
}

/// The motion of a window, from one of its channels.
pub fn motion(window: &Window) -> Motion {
    let analysed = Analysed::new(window);
    let (signal, times) = match &analysed {
        Ok(analysed) => (&analysed.signal, &analysed.times),
        Err(reason) => {
            return Motion {
                regime: Err(reason.clone()),
                numbers: motion_definitions()
                    .iter()
                    .map(|_| Err(reason.clone()))
                    .collect(),
            };
        }
    };
    let judged = analysed.as_ref().map_or_else(
        |reason| Err(reason.clone()),
        |analysed| judged(window, analysed),
    );
    let exponent = judged.clone().and_then(|judged| judged.exponent());
    let end = |value: fn(Growth) -> f64| exponent.clone().map(value);
    let mut numbers = vec![end(|e| e.value), end(|e| e.low), end(|e| e.high)];
    numbers.push(match &judged {
        Ok(judged) => judged.zero_one.clone(),
        Err(_) => zero_one(signal, times.delay).map_err(Reason::from),
    });
    numbers.extend(entropies(signal, times));
    numbers.extend(states(signal, times));
    let finite = |number: f64| {
        number
            .is_finite()
            .then_some(number)
            .ok_or(Reason::NoMatches)
    };
    Motion {
        regime: judged.map(|judged| judged.verdict.regime.name()),
        numbers: numbers.into_iter().map(|n| n.and_then(finite)).collect(),
    }
}

/// The signal that is analysed.
struct Analysed {
    /// The channel as recorded.
    channel: Vec<f64>,
    /// Decimated and cut to length.
    signal: Vec<f64>,
    sample_rate: f64,
    times: Times,
}

impl Analysed {
    fn new(window: &Window) -> Result<Self, Reason> {
        let mut channels = window.channels.iter().filter(|c| has_features(&c.name));
        let first = channels.clone().next();
        let channel = channels.find(|c| c.unit == "m/s^2").or(first);
        let samples = &channel.ok_or(Reason::NoChannel)?.samples;
        let channel: Vec<f64> = samples.iter().map(|x| f64::from(*x)).collect();
        let whole = times(&channel)?;
        let share = cut_off(samples) as f64 / samples.len() as f64;
        if share > CUT_SHARE {
            return Err(Reason::CutOff {
                percent: 100.0 * share,
            });
        }
        let finest = (whole.mean_period / PER_PERIOD).floor() as usize;
        let factor = channel.len().div_ceil(POINTS).min(finest).max(1);
        let decimator = Decimator::new(factor)?;
        let mut signal = decimator.apply(&channel);
        signal.truncate(POINTS);
        Ok(Self {
            times: times(&signal)?,
            channel,
            signal,
            sample_rate: window.sample_rate / factor as f64,
        })
    }
}

/// A verdict, how many of its samples there are in a second, and what the 0-1 test says of them.
#[derive(Clone)]
struct Judged {
    verdict: Verdict,
    sample_rate: f64,
    zero_one: Result<f64, Reason>,
}

impl Judged {
    /// The exponent per second, or why there is none.
    fn exponent(self) -> Result<Growth, Reason> {
        match (self.verdict.exponent, self.verdict.regime) {
            (Some(exponent), Regime::Chaotic) => Ok(exponent.per(1.0 / self.sample_rate)),
            (None, Regime::Chaotic) => Err(Reason::ExponentsDiffer),
            (_, Regime::Undecided) => Err(Reason::Undecided),
            (_, regime) => Err(Reason::NotChaotic {
                regime: regime.name(),
            }),
        }
    }
}

fn judged(window: &Window, analysed: &Analysed) -> Result<Judged, Reason> {
    let mut chance = false;
    if let Ok(angle) = crank_angle(window) {
        let needed = FEWEST_CYCLES;
        let got = angle.revolutions();
        let grid = AngleGrid::new(&angle, PER_REVOLUTION)?;
        let revolutions = grid.resample(&analysed.channel)?;
        if revolutions.count() < needed {
            return Err(signal::Error::TooFewRevolutions { needed, got }.into());
        }
        let per_second = window.sample_rate / grid.samples_per_revolution();
        let phase = match window.crank_angle {
            Some(_) => Phase::Recorded,
            None => Phase::Stated,
        };
        if let Some(verdict) = driven_verdict(revolutions.samples(), PER_REVOLUTION, phase)? {
            return Ok(Judged {
                verdict,
                sample_rate: per_second * PER_REVOLUTION as f64,
                zero_one: zero_one(revolutions.samples(), ZERO_ONE_STEP).map_err(Reason::from),
            });
        }
        chance = chance_at_a_phase(revolutions.samples(), PER_REVOLUTION);
    }
    let mut verdict = verdict(&analysed.signal, &analysed.times)?;
    if chance && verdict.regime == Regime::Chaotic {
        verdict.regime = Regime::Undecided;
    }
    Ok(Judged {
        verdict,
        sample_rate: analysed.sample_rate,
        zero_one: zero_one(&analysed.signal, analysed.times.delay).map_err(Reason::from),
    })
}

/// Sample, permutation and multiscale entropy.
fn entropies(signal: &[f64], times: &Times) -> [Result<f64, Reason>; 3] {
    let sample = || {
        let (_, deviation) = chaos::error::checked(signal)?;
        sample_entropy(signal, 2, 0.2 * deviation)?.ok_or(Reason::NoMatches)
    };
    let multiscale = || {
        let scales = multiscale_entropy(signal, SCALES)?;
        let whole: Option<f64> = scales.into_iter().sum();
        whole
            .map(|sum| sum / SCALES as f64)
            .ok_or(Reason::NoMatches)
    };
    [
        sample(),
        permutation_entropy(signal, ORDER, times.delay).map_err(Reason::from),
        multiscale(),
    ]
}

/// Correlation dimension, recurrence rate, determinism and laminarity of the embedded signal.
fn states(signal: &[f64], times: &Times) -> Vec<Result<f64, Reason>> {
    let dimension = match unfolding(signal, times, COORDINATES) {
        Ok(unfolding) => unfolding.dimension(),
        Err(error) => return vec![Err(error.into()); 4],
    };
    let delays = Delays {
        signal,
        dimension,
        delay: times.delay,
    };
    let measures = chaos::error::checked(signal).and_then(|(_, deviation)| {
        let radius = 0.2 * deviation * (2.0 * dimension as f64).sqrt();
        recurrence(&delays, times.theiler, radius)
    });
    let correlation = correlation_dimension(&delays, times.theiler);
    let mut values = vec![correlation.map(|c| c.value).map_err(Reason::from)];
    match measures {
        Ok(m) => values.extend([Ok(m.rate), Ok(m.determinism), Ok(m.laminarity)]),
        Err(error) => values.extend(vec![Err(Reason::from(error)); 3]),
    }
    values
}
