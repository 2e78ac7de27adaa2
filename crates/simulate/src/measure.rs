//! The recorder's end of the measuring chain: noise, range, resolution.

use crate::record::Record;
use crate::sensor::{Chain, Noise, NoiseLevel, Range, Sensor};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use signal::channel::Channel;
use std::f64::consts::TAU;
use std::fmt;

/// One measurement of `record`: the channels as recorded. `throws` are the names that prefix the
/// channels of a machine of several throws. Two measurements with unlike random numbers differ in
/// noise alone.
pub fn measure(
    record: &Record,
    sensors: &[Sensor],
    throws: &[&str],
    random: &mut impl Rng,
) -> Vec<Channel> {
    sensors
        .iter()
        .zip(&record.series)
        .map(|(sensor, clean)| {
            let mut series = clean.clone();
            if let Some(noise) = sensor.chain.noise {
                add_noise(&mut series, noise, random);
            }
            let digitise = Digitiser::new(sensor, &series);
            Channel {
                name: sensor.measured.column(throws),
                unit: sensor.measured.unit().to_owned(),
                samples: series.iter().map(|x| digitise.read(*x) as f32).collect(),
            }
        })
        .collect()
}

/// A channel whose recorder had too small a range.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOff {
    /// Name of the channel.
    pub channel: String,
    /// Share of its samples that are at an end of the range.
    pub share: f64,
    /// Largest magnitude that the recorder holds, in the channel's unit.
    pub range: f64,
    /// The channel's unit.
    pub unit: String,
}

impl fmt::Display for CutOff {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{}: {:.2} % of the samples are cut off at the sensor's range of {} {}: state a wider range",
            self.channel,
            100.0 * self.share,
            self.range,
            self.unit
        )
    }
}

/// The channels, as recorded by these sensors, that their ranges cut off.
pub fn cut_off(sensors: &[Sensor], channels: &[Channel]) -> Vec<CutOff> {
    let each = sensors.iter().zip(channels);
    let found = each.filter_map(|(sensor, channel)| {
        // An encoder turns round, and the range of an automatic recorder is that of its record.
        let (false, Some(Range::Fixed(range))) = (sensor.measured.is_angle(), sensor.chain.range)
        else {
            return None;
        };
        let digitise = Digitiser::new(sensor, &[]);
        let [low, high] = digitise.limits.map(|limit| digitise.read(limit) as f32);
        let samples = channel.samples.iter();
        let count = samples.filter(|x| **x <= low || **x >= high).count();
        (count > 0 && low < high).then(|| CutOff {
            channel: channel.name.clone(),
            share: count as f64 / channel.samples.len() as f64,
            range,
            unit: channel.unit.clone(),
        })
    });
    found.collect()
}

/// What is doubtful about a run that was recorded by these sensors: joints that are pressed in too deeply, ranges that
/// are too small.
pub fn doubts(record: &Record, sensors: &[Sensor], channels: &[Channel]) -> Vec<String> {
    let joints = record.penetrations.iter();
    let deep = joints.filter(|joint| joint.is_too_deep());
    let cut_off = cut_off(sensors, channels).into_iter();
    deep.map(ToString::to_string)
        .chain(cut_off.map(|channel| channel.to_string()))
        .collect()
}

fn add_noise(series: &mut [f64], noise: Noise, random: &mut impl Rng) {
    let rms = match noise.level {
        NoiseLevel::Absolute(rms) => rms,
        NoiseLevel::OfSignal(share) => share * scatter(series),
    };
    let white = rms * (1.0 - noise.pink_share).max(0.0).sqrt();
    for x in series.iter_mut() {
        let normal: f64 = StandardNormal.sample(random);
        *x += white * normal;
    }
    let pink = rms * noise.pink_share.max(0.0).sqrt();
    let normal = || StandardNormal.sample(random);
    if let Ok(shaped) = signal::noise::pink_noise(series.len(), pink, normal) {
        for (x, n) in series.iter_mut().zip(shaped) {
            *x += n;
        }
    }
}

/// RMS about the mean.
fn scatter(series: &[f64]) -> f64 {
    let count = series.len().max(1) as f64;
    let mean = series.iter().sum::<f64>() / count;
    let square = series.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    square.sqrt()
}

/// Range and resolution of a converter.
struct Digitiser {
    limits: [f64; 2],
    quantum: Option<f64>,
    wraps: bool,
}

impl Digitiser {
    /// The digitiser of a sensor for this series.
    fn new(sensor: &Sensor, series: &[f64]) -> Self {
        let Chain { range, bits, .. } = sensor.chain;
        let largest = || series.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let range = range.map(|range| match range {
            Range::Fixed(range) => range,
            Range::Auto => largest(),
        });
        let angle = sensor.measured.is_angle();
        let codes = bits.map(|bits| f64::from(bits).exp2());
        // An encoder divides the revolution, a converter the span of ± its range.
        let span = if angle {
            Some(TAU)
        } else {
            range.map(|r| 2.0 * r)
        };
        let quantum = codes.zip(span).map(|(codes, span)| span / codes);
        let limits = match range {
            Some(range) if !angle => [-range, range - quantum.unwrap_or(0.0)],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        Self {
            limits,
            quantum,
            wraps: angle,
        }
    }

    fn read(&self, value: f64) -> f64 {
        let [low, high] = self.limits;
        let limited = value.clamp(low, high);
        let rounded = match self.quantum {
            Some(quantum) => (limited / quantum).round() * quantum,
            None => limited,
        };
        // A reading that rounds up to a whole revolution is 0. In single precision 2π itself is
        // above 2π, so the comparison is made there.
        if self.wraps && rounded as f32 >= TAU as f32 {
            0.0
        } else {
            rounded
        }
    }
}
