//! Mains hum: a tone whose frequency is the same in every run, at any speed.
//!
//! What repeats with the crank is subtracted from each recording first. In the rest a tone stands out of
//! the frequencies around it in all runs at once, equally strong in each. What repeats with every other revolution may be at
//! that frequency too, but at one speed alone. A run in which the tone meets an order hides it, and
//! cannot be cleaned: that order of it is not compared.

use crate::error::Error;
use calibrate::observation::POINTS;
use calibrate::{Channel, Observation, Problem, Run};
use serde::Serialize;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use std::f64::consts::TAU;

/// Frequencies that mains have, and by how much they may be off, Hz.
const MAINS: [f64; 2] = [50.0, 60.0];
const OFF: f64 = 0.5;
/// Steps of the frequency per width of a spectral line.
const STEPS_PER_LINE: f64 = 4.0;
/// Frequencies on either side from which the noise is estimated, in widths of a spectral line.
const AROUND: std::ops::RangeInclusive<i32> = 3..=14;
/// A tone in noise has a mean power over noise of 1 in every run; in so many times that it is there.
/// With one run of noise alone it is exceeded in one of e^20 tests.
const STANDS_OUT: f64 = 20.0;
/// Share of the mean amplitude that a tone has in every run, and by how many times the noise less it may be.
const IN_EACH: f64 = 0.5;
const SURE: f64 = 3.0;

/// A hum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hum {
    /// The channel's column.
    pub channel: String,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Mean amplitude over the runs, in the unit of the channel, and its standard error.
    pub amplitude: f64,
    /// See [`Hum::amplitude`].
    pub standard_error: f64,
    /// Greatest power over that of the noise around it.
    pub over_noise: f64,
    /// The runs in which it meets no order.
    pub runs: Vec<String>,
}

/// A tone in a run: its cosine and sine amplitudes.
struct Tone {
    cosine: f64,
    sine: f64,
}

/// The hum of each acceleration that has one. It is taken off the recordings, and the problem
/// looks at them anew.
///
/// # Errors
/// A recording that cannot be looked at without its hum.
pub fn remove_hum(problem: &mut Problem, runs: &mut [Run]) -> Result<Vec<Hum>, Error> {
    let mut columns: Vec<String> = Vec::new();
    for channel in runs.iter().flat_map(|run| &run.channels) {
        if channel.quantity().is_vibration() && !columns.contains(&channel.column) {
            columns.push(channel.column.clone());
        }
    }
    let mut found = Vec::new();
    for column in columns {
        if let Some(hum) = hum(runs, &column) {
            clean(problem, runs, &hum)?;
            found.push(hum);
        }
    }
    Ok(found)
}

/// What of a channel does not repeat with the crank.
fn rest(run: &Run, column: &str) -> Option<Vec<f64>> {
    let channel = run.channels.iter().find(|c| c.column == column)?;
    let angle = CrankAngle::from_encoder(run.crank_angle.as_ref()?).ok()?;
    let grid = AngleGrid::new(&angle, POINTS).ok()?;
    let mean = grid.resample(&channel.samples).ok()?.synchronous_mean();
    let at = |angle: f64| {
        let place = angle.rem_euclid(TAU) / TAU * POINTS as f64;
        let (low, share) = (place.floor(), place.fract());
        let [a, b] = [low as usize % POINTS, (low as usize + 1) % POINTS];
        mean[a] + share * (mean[b] - mean[a])
    };
    let samples = channel.samples.iter().zip(angle.angles());
    Some(samples.map(|(x, angle)| x - at(*angle)).collect())
}

/// The tone of a frequency in samples, by least squares over a whole number of its periods.
fn tone(samples: &[f64], rate: f64, frequency: f64) -> Tone {
    let periods = (samples.len() as f64 * frequency / rate).floor().max(1.0);
    let count = ((periods * rate / frequency).round() as usize).min(samples.len());
    let (mut cosine, mut sine) = (0.0, 0.0);
    // Sine and cosine of equal steps by rotation.
    let (step_s, step_c) = (TAU * frequency / rate).sin_cos();
    let (mut s, mut c) = (0.0, 1.0);
    for x in &samples[..count] {
        cosine += x * c;
        sine += x * s;
        (s, c) = (s * step_c + c * step_s, c * step_c - s * step_s);
    }
    let scale = 2.0 / count as f64;
    Tone {
        cosine: scale * cosine,
        sine: scale * sine,
    }
}

impl Tone {
    fn power(&self) -> f64 {
        self.cosine * self.cosine + self.sine * self.sine
    }
}

/// Whether a frequency meets an order of a run: then it was taken off with the mean.
fn meets_order(run: &Run, frequency: f64) -> Option<usize> {
    let samples = run.channels.first().map_or(1, |c| c.samples.len());
    let width = run.sample_rate / samples as f64;
    let turn = run.speed_rpm / 60.0;
    let order = (frequency / turn).round();
    ((order * turn - frequency).abs() < 2.0 * width && order > 0.0).then_some(order as usize)
}

fn hum(runs: &[Run], column: &str) -> Option<Hum> {
    let rests: Vec<(&Run, Vec<f64>)> = runs
        .iter()
        .filter_map(|run| Some((run, rest(run, column)?)))
        .collect();
    let longest = rests
        .iter()
        .map(|(run, x)| x.len() as f64 / run.sample_rate);
    let step = 1.0 / (STEPS_PER_LINE * longest.fold(0.0, f64::max)).max(f64::MIN_POSITIVE);
    let mut best: Option<Hum> = None;
    for mains in MAINS {
        let steps = (OFF / step) as i32;
        for i in -steps..=steps {
            let frequency = mains + f64::from(i) * step;
            let heard: Vec<(&Run, f64, f64)> = rests
                .iter()
                .filter(|(run, _)| meets_order(run, frequency).is_none())
                .map(|(run, x)| {
                    let width = run.sample_rate / x.len() as f64;
                    let power = |f: f64| tone(x, run.sample_rate, f).power();
                    let around = AROUND
                        .flat_map(|k| [-k, k])
                        .map(|k| frequency + f64::from(k) * width);
                    let clear = around.filter(|f| meets_order(run, *f).is_none());
                    let noise: Vec<f64> = clear.map(power).collect();
                    let noise = noise.iter().sum::<f64>() / noise.len().max(1) as f64;
                    (*run, power(frequency), noise)
                })
                .collect();
            if heard.is_empty() {
                continue;
            }
            let count = heard.len() as f64;
            let over_noise = heard.iter().map(|(_, p, n)| p / n).sum::<f64>() / count;
            let amplitude = heard.iter().map(|(_, p, _)| p.sqrt()).sum::<f64>() / count;
            let is_in =
                |(_, p, n): &(&Run, f64, f64)| p.sqrt() + SURE * n.sqrt() > IN_EACH * amplitude;
            if over_noise > STANDS_OUT
                && heard.iter().all(is_in)
                && best.as_ref().is_none_or(|b| over_noise > b.over_noise)
            {
                let noise = heard.iter().map(|(_, _, n)| 0.5 * n).sum::<f64>() / count;
                best = Some(Hum {
                    channel: column.to_owned(),
                    frequency,
                    amplitude,
                    standard_error: (noise / count).sqrt(),
                    over_noise,
                    runs: heard.iter().map(|(run, _, _)| run.id.clone()).collect(),
                });
            }
        }
    }
    best
}

/// Takes the hum off the recordings, and its order off the comparison where it meets one.
fn clean(problem: &mut Problem, runs: &mut [Run], hum: &Hum) -> Result<(), Error> {
    for run in runs {
        let met = meets_order(run, hum.frequency);
        let heard = rest(run, &hum.channel).map(|x| tone(&x, run.sample_rate, hum.frequency));
        let Some(observed) = problem.runs.iter_mut().find(|o| o.id == run.id) else {
            continue;
        };
        if let Some(order) = met {
            let channels = observed.channels.iter_mut();
            for channel in channels.filter(|c| c.column == hum.channel) {
                channel.orders.retain(|k| *k != order);
            }
        } else if let Some(tone) = heard {
            let rate = run.sample_rate;
            let channels = run.channels.iter_mut().filter(|c| c.column == hum.channel);
            channels.for_each(|channel| subtract(channel, rate, hum.frequency, &tone));
            let columns: Vec<String> = observed.channels.iter().map(|c| c.column.clone()).collect();
            *observed = Observation::from_run(run, &columns)?;
        }
    }
    Ok(())
}

fn subtract(channel: &mut Channel, rate: f64, frequency: f64, tone: &Tone) {
    for (i, x) in channel.samples.iter_mut().enumerate() {
        let (s, c) = (TAU * frequency * i as f64 / rate).sin_cos();
        *x -= tone.cosine * c + tone.sine * s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMN: &str = "crosshead_acceleration_m_s2";

    /// A run of what repeats with the crank, noise (Knuth's MMIX generator), and a tone.
    fn run(id: &str, speed_rpm: f64, hum: f64) -> Run {
        let rate = 10_000.0;
        let turn = speed_rpm / 60.0 * TAU;
        let mut state = id.len() as u64 + speed_rpm as u64;
        let mut samples = Vec::new();
        let mut angles = Vec::new();
        for i in 0..36_000 {
            let t = f64::from(i) / rate;
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let noise = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            let angle = (turn * t).rem_euclid(TAU);
            angles.push(angle);
            samples.push(
                100.0 * angle.cos()
                    + 30.0 * (7.0 * angle).sin()
                    + 10.0 * noise
                    + hum * (TAU * 50.0 * t + 0.7).sin(),
            );
        }
        Run {
            id: id.into(),
            settings: Vec::new(),
            speed_rpm,
            sample_rate: rate,
            is_timed: true,
            crank_angle: Some(angles),
            channels: vec![Channel {
                column: COLUMN.into(),
                samples,
            }],
        }
    }

    #[test]
    fn a_tone_that_is_the_same_at_every_speed_is_found() {
        let runs = [
            run("a", 440.0, 0.8),
            run("b", 500.0, 0.8),
            run("c", 560.0, 0.8),
        ];
        let found = hum(&runs, COLUMN).unwrap();
        assert!((found.frequency - 50.0).abs() < 0.05, "{found:?}");
        assert!((found.amplitude - 0.8).abs() < 0.1, "{found:?}");
        // 500 rpm has its sixth order there.
        assert_eq!(found.runs, ["a", "c"]);
        assert_eq!(meets_order(&runs[1], 50.0), Some(6));
    }

    #[test]
    fn noise_and_orders_are_no_hum() {
        let runs = [
            run("a", 440.0, 0.0),
            run("b", 500.0, 0.0),
            run("c", 560.0, 0.0),
        ];
        assert_eq!(hum(&runs, COLUMN), None);
    }

    #[test]
    fn a_tone_at_one_speed_alone_is_no_hum() {
        let runs = [
            run("a", 440.0, 0.0),
            run("b", 500.0, 0.0),
            run("c", 560.0, 2.0),
        ];
        assert_eq!(hum(&runs, COLUMN), None);
        assert!(hum(&runs[2..], COLUMN).is_some());
    }
}
