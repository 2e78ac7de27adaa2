//! The measuring chain of a channel as its recordings show it: noise, resolution, range.
//!
//! Noise is what does not repeat from revolution to revolution and does not depend on where the crank
//! stands. Where the motion itself scatters, that is no sensor's noise: only an upper bound is stated
//! then, with the reason.

use crate::converter::Converter;
use crate::few_revolutions;
use crate::observation::{Observation, Run};
use crate::prediction::Prediction;
use serde::{Deserialize, Serialize, Serializer};
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use signal::nonsynchronous::Nonsynchronous;
use signal::quantisation::quantisation_step;
use signal::synchronous_average::RESAMPLING;
use std::collections::BTreeMap;
use std::fmt;

/// Column of the crank angle.
pub const CRANK_ANGLE: &str = "crank_angle_rad";
/// Share of the mean square that has to be the same at every crank angle for it to be noise. The RMS
/// is then wrong by a tenth at most.
const STEADY: f64 = 0.8;
/// How many times the least mean square of the runs a run may have, in the channel's unit and as a
/// share of its signal. Beyond it the motion scatters.
const ALIKE: f64 = 4.0;
/// Spread of the relative noise over the runs, as a share of that of the absolute noise (standard deviations of
/// logarithms). Below it the noise is a share of the signal.
const FOLLOWS: f64 = 0.5;
/// Relative difference below which two sample rates are one.
const SAME_RATE: f64 = 1e-3;

/// The measuring chain of a channel, as it is identifiable from the recordings.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RecordedSensor {
    /// Its noise.
    #[serde(flatten)]
    pub noise: RecordedNoise,
    /// Its converter.
    #[serde(flatten)]
    pub converter: Converter,
    /// Samples per second; none where the runs differ.
    pub sample_rate_hz: Option<f64>,
}

/// Its noise and its converter, in words.
impl fmt::Display for RecordedSensor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}; {}", self.noise, self.converter)
    }
}

impl fmt::Display for RecordedNoise {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let reason = self.noise_reason.as_deref().unwrap_or_default();
        match (self.rms, self.at_most) {
            (Some(rms), _) => {
                let share = self.of_signal.map_or(String::new(), |share| {
                    format!(", {:.2} % of its signal", 100.0 * share)
                });
                let pink = 100.0 * self.pink_share.unwrap_or(0.0);
                write!(f, "noise {rms:.3e} rms{share}, {pink:.0} % of it 1/f")
            }
            (None, Some(most)) => write!(f, "noise unknown, at most {most:.3e} rms: {reason}"),
            (None, None) => write!(f, "noise unknown: {reason}"),
        }
    }
}

/// A sensor as results have it: `bits` and `range` are always there, null where they are not known.
impl Serialize for RecordedSensor {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Complete<'a> {
            #[serde(flatten)]
            noise: &'a RecordedNoise,
            #[serde(flatten)]
            converter: &'a Converter,
            sample_rate_hz: Option<f64>,
            #[serde(skip_serializing_if = "Option::is_none")]
            bits: Option<()>,
            #[serde(skip_serializing_if = "Option::is_none")]
            range: Option<()>,
        }
        let has_bits = !matches!(self.converter, Converter::Unknown { .. });
        let has_range = matches!(self.converter, Converter::RangeAssumed { .. });
        Complete {
            noise: &self.noise,
            converter: &self.converter,
            sample_rate_hz: self.sample_rate_hz,
            bits: (!has_bits).then_some(()),
            range: (!has_range).then_some(()),
        }
        .serialize(serializer)
    }
}

/// The noise of a channel. What is not identifiable is `None`, with a reason.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedNoise {
    /// RMS of the noise over the runs, SI.
    pub rms: Option<f64>,
    /// The same as a share of the signal's RMS, where the noise of the runs follows it.
    pub of_signal: Option<f64>,
    /// Share of the noise's mean square that is 1/f.
    pub pink_share: Option<f64>,
    /// Upper bound of the RMS where there is no value, SI.
    pub at_most: Option<f64>,
    /// Why there is no RMS.
    pub noise_reason: Option<String>,
    /// The runs from which the noise is estimated.
    pub runs: Vec<String>,
}

/// A run as sensors are looked for in it.
pub struct Look<'a> {
    /// The recording.
    pub run: &'a Run,
    /// What was observed in it.
    pub observation: &'a Observation,
    /// What a model that fits it predicts; none where no model does.
    pub prediction: Option<&'a Prediction>,
    /// Whether an encoder gave its crank angle.
    pub has_encoder: bool,
}

/// The sensors of the observed channels, and the encoder where there is one, by column.
pub fn recorded_sensors(looks: &[Look]) -> BTreeMap<String, RecordedSensor> {
    let mut columns: Vec<&str> = Vec::new();
    for channel in looks.iter().flat_map(|look| &look.observation.channels) {
        if !columns.contains(&channel.column.as_str()) {
            columns.push(&channel.column);
        }
    }
    let rate = sample_rate(looks);
    let of_column = |column: &&str| {
        let sensor = RecordedSensor {
            noise: noise(column, looks),
            converter: Converter::of_samples(&samples(column, looks)),
            sample_rate_hz: rate,
        };
        ((*column).to_owned(), sensor)
    };
    let mut sensors: BTreeMap<String, RecordedSensor> = columns.iter().map(of_column).collect();
    let mut encoded = looks.iter().filter(|look| look.has_encoder).peekable();
    if encoded.peek().is_some() {
        let sensor = RecordedSensor {
            noise: RecordedNoise {
                noise_reason: Some("the step of an encoder is its noise".into()),
                ..RecordedNoise::default()
            },
            converter: Converter::of_encoder(encoded.map(|look| look.run)),
            sample_rate_hz: rate,
        };
        sensors.insert(CRANK_ANGLE.to_owned(), sensor);
    }
    sensors
}

/// The sample rate of the runs, Hz; none where they differ or one's is not known.
pub fn sample_rate(looks: &[Look]) -> Option<f64> {
    let timed = looks.iter().all(|look| look.run.is_timed);
    let mut rates = looks.iter().map(|look| look.run.sample_rate);
    let first = rates.next().filter(|_| timed)?;
    rates
        .all(|rate| (rate / first - 1.0).abs() < SAME_RATE)
        .then_some(first)
}

/// The noise of a channel in a run.
struct Seen<'a> {
    run: &'a str,
    /// Mean squares of the noise, of its 1/f part, and of the signal about its mean.
    noise: f64,
    pink: f64,
    signal: f64,
    /// What of the noise may be the motion's; none where it is the sensor's.
    doubt: Option<&'static str>,
    /// Upper bound of the mean square.
    at_most: f64,
}

fn noise(column: &str, looks: &[Look]) -> RecordedNoise {
    let mut found = RecordedNoise::default();
    let mut failed = None;
    let mut seen = Vec::new();
    for look in looks {
        match seen_in(look, column) {
            Some(Ok(noise)) => seen.push(noise),
            Some(Err(reason)) => failed = Some(reason),
            None => {}
        }
    }
    mark_unlike(&mut seen);
    let good: Vec<&Seen> = seen.iter().filter(|seen| seen.doubt.is_none()).collect();
    if good.is_empty() {
        let least = seen.iter().map(|seen| seen.at_most);
        found.at_most = least.min_by(f64::total_cmp).map(f64::sqrt);
        let doubt = seen.iter().find_map(|seen| seen.doubt).map(str::to_owned);
        found.noise_reason = doubt.or(failed);
        return found;
    }
    let mean = |of: &dyn Fn(&Seen) -> f64| {
        good.iter().map(|seen| of(seen)).sum::<f64>() / good.len() as f64
    };
    found.rms = Some(mean(&|seen| seen.noise).sqrt());
    found.pink_share = Some(mean(&|seen| seen.pink / seen.noise).clamp(0.0, 1.0));
    let relative = |seen: &Seen| seen.noise / seen.signal;
    if good.len() > 1 && spread(&good, relative) < FOLLOWS * spread(&good, |seen| seen.noise) {
        found.of_signal = Some(mean(&relative).sqrt());
    }
    found.runs = good.iter().map(|seen| seen.run.to_owned()).collect();
    found
}

/// Standard deviation of the logarithm.
fn spread(seen: &[&Seen], of: impl Fn(&Seen) -> f64) -> f64 {
    let logarithms: Vec<f64> = seen.iter().map(|seen| of(seen).ln()).collect();
    let count = logarithms.len() as f64;
    let mean = logarithms.iter().sum::<f64>() / count;
    let squares = logarithms.iter().map(|x| (x - mean).powi(2));
    (squares.sum::<f64>() / count).sqrt()
}

/// A run that scatters far more than the quietest, in its unit and as a share of its signal, moves so.
fn mark_unlike(seen: &mut [Seen]) {
    let least = |of: &dyn Fn(&Seen) -> f64| {
        let values = seen.iter().filter(|seen| seen.doubt.is_none()).map(of);
        values.fold(f64::INFINITY, f64::min)
    };
    let [noise, share] = [
        least(&|seen| seen.noise),
        least(&|seen| seen.noise / seen.signal),
    ];
    for seen in seen.iter_mut() {
        if seen.noise > ALIKE * noise && seen.noise / seen.signal > ALIKE * share {
            seen.doubt.get_or_insert(SCATTERS);
        }
    }
}

const SCATTERS: &str = "the motion itself differs from revolution to revolution";
const BELOW: &str = "the noise is below what resampling over the crank angle leaves";

/// The noise of a channel in a run, or why it has no value; `None` where the run lacks the channel.
fn seen_in<'a>(look: &Look<'a>, column: &str) -> Option<Result<Seen<'a>, String>> {
    let run = look.run;
    let samples = &run.channels.iter().find(|c| c.column == column)?.samples;
    let angles = run.crank_angle.as_ref()?;
    Some(in_samples(angles, samples).map(|(found, signal)| {
        let step = quantisation_step(samples).unwrap_or(0.0);
        // Rounding to a step is white noise of its own, which the converter adds again.
        let white = (found.white - step * step / 12.0).max(0.0);
        let noise = white + found.pink;
        let (doubt, at_most) = if noise <= RESAMPLING * signal {
            (Some(BELOW), RESAMPLING * signal)
        } else if found.steady_share < STEADY || model_scatters(look, column) {
            (Some(SCATTERS), noise * found.steady_share)
        } else {
            (None, noise)
        };
        Seen {
            run: &run.id,
            noise,
            pink: found.pink,
            signal: (signal - noise).max(f64::MIN_POSITIVE),
            doubt,
            at_most,
        }
    }))
}

/// The noise in samples over crank angles, and their mean square about the mean.
fn in_samples(angles: &[f64], samples: &[f64]) -> Result<(Nonsynchronous, f64), String> {
    let inseparable =
        |error: signal::Error| format!("the noise cannot be separated from the signal: {error}");
    let angle = CrankAngle::from_encoder(angles).map_err(inseparable)?;
    if few_revolutions::is_short(&angle) {
        return Err("there are too few revolutions to separate the noise from the signal".into());
    }
    let grid = AngleGrid::new(&angle, angle.samples_per_revolution().round() as usize);
    let grid = grid.map_err(inseparable)?;
    let revolutions = grid.resample(samples).map_err(inseparable)?;
    let found = Nonsynchronous::new(&revolutions, grid.highest_order()).map_err(inseparable)?;
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let squares = samples.iter().map(|x| (x - mean).powi(2));
    Ok((found, squares.sum::<f64>() / count))
}

/// Whether more than what noise may be wrong by is what the model's own revolutions differ by.
fn model_scatters(look: &Look, column: &str) -> bool {
    let Some(prediction) = look.prediction.filter(|prediction| !prediction.periodic) else {
        return false;
    };
    let channels = &look.observation.channels;
    let Some(i) = channels.iter().position(|c| c.column == column) else {
        return false;
    };
    let scatter = |lines: &signal::order_lines::OrderLines| {
        let variances = lines.variance.iter().take(channels[i].lines.variance.len());
        lines.revolutions as f64 * variances.skip(1).sum::<f64>()
    };
    scatter(&prediction.lines[i]) > (1.0 - STEADY) * scatter(&channels[i].lines)
}

/// The samples of a channel, by run.
fn samples<'a>(column: &str, looks: &[Look<'a>]) -> Vec<&'a [f64]> {
    let channels = looks.iter().flat_map(|look| &look.run.channels);
    let own = channels.filter(|channel| channel.column == column);
    own.map(|channel| channel.samples.as_slice()).collect()
}
