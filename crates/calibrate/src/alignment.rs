//! Speed and zero of the crank angle of a recording without one.
//! The speed is that at which the recording repeats itself. The zero is that of the model's prediction.

use crate::observation::{Observation, Run};
use crate::prediction::Prediction;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Orders whose power is maximised over the speed: roughly, and then closely.
const FIRST_ORDERS: usize = 3;
const ORDERS: usize = 20;
/// The speed is searched this far from the stated one, as a share of it.
const RANGE: f64 = 0.15;
/// Steps of the highest order per width of a spectral line.
const STEPS: f64 = 4.0;
/// The step about the best speed shrinks by this in every refinement, so often.
const SHRINK: f64 = 4.0;
const REFINEMENTS: usize = 8;
/// Angles at which the zero is looked for, and refinements of the best.
const ZEROS: usize = 720;
const NEWTON: usize = 8;

/// The speed, rpm, at which the orders of a run's channels have most power, near the stated one.
///
/// A recording of T seconds determines a frequency to much less than 1/T. A Hann window keeps the orders
/// from leaking into each other. The power is maximised over the speed itself.
pub fn speed(run: &Run) -> f64 {
    let longest = run.channels.iter().map(|c| c.samples.len()).max();
    let duration = longest.unwrap_or(0) as f64 / run.sample_rate;
    let stated = run.speed_rpm / 60.0;
    let spectra: Vec<Windowed> = run
        .channels
        .iter()
        .map(|c| Windowed::new(&c.samples))
        .collect();
    let power = |hz: f64, orders: usize| -> f64 {
        let cycles = hz / run.sample_rate;
        spectra
            .iter()
            .map(|s| s.synchronous_power(cycles, orders))
            .sum()
    };
    let mut width = 1.0 / (STEPS * FIRST_ORDERS as f64 * duration);
    let count = (RANGE * stated / width).ceil() as i64;
    let all = (-count..=count).map(|i| stated + i as f64 * width);
    let mut best = greatest(all, |hz| power(hz, FIRST_ORDERS));
    for _ in 0..REFINEMENTS {
        width /= SHRINK;
        let near = (-4..=4).map(|i| best + f64::from(i) * width);
        best = greatest(near, |hz| power(hz, ORDERS));
    }
    60.0 * best
}

fn greatest(points: impl Iterator<Item = f64>, of: impl Fn(f64) -> f64) -> f64 {
    let valued = points.map(|x| (of(x), x));
    let best = valued.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(f64::NAN, |(_, x)| x)
}

/// Samples under a Hann window, without their mean and over their RMS.
struct Windowed(Vec<f64>);

impl Windowed {
    fn new(samples: &[f64]) -> Self {
        let count = samples.len().max(1) as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let square = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let scale = 1.0 / square.sqrt().max(f64::MIN_POSITIVE);
        let hann = |i: usize| (PI * (i as f64 + 0.5) / count).sin().powi(2);
        let windowed = samples.iter().enumerate();
        Self(
            windowed
                .map(|(i, x)| (x - mean) * scale * hann(i))
                .collect(),
        )
    }

    /// Power at the first orders of a shaft that makes `cycles` revolutions per sample, after Goertzel
    /// (1958).
    fn synchronous_power(&self, cycles: f64, orders: usize) -> f64 {
        let orders = (1..=orders).take_while(|k| *k as f64 * cycles < 0.5);
        let of_order = |k: usize| {
            let twice = 2.0 * (TAU * k as f64 * cycles).cos();
            let (mut last, mut before) = (0.0, 0.0);
            for x in &self.0 {
                let next = x + twice * last - before;
                before = last;
                last = next;
            }
            last * last + before * before - twice * last * before
        };
        orders.map(of_order).sum()
    }
}

/// By how much to raise the crank angle of an observed run so that it agrees with the prediction, rad in (−π, π].
/// Least squares over all lines, weighted by the noise of both.
pub fn phase(observed: &Observation, predicted: &Prediction) -> f64 {
    common_phase(&[(observed, predicted)])
}

/// The same of all these runs together.
pub fn common_phase(runs: &[(&Observation, &Prediction)]) -> f64 {
    let mut products = Vec::new();
    let channels = runs
        .iter()
        .flat_map(|(observed, predicted)| observed.channels.iter().zip(&predicted.lines));
    for (channel, lines) in channels {
        let greatest = channel.lines.amplitude.iter().map(|c| c.norm());
        let floor = (1e-4 * greatest.fold(0.0, f64::max)).powi(2);
        for &k in channel.orders.iter().filter(|k| **k > 0) {
            let Some(model) = lines.amplitude.get(k) else {
                continue;
            };
            let variance = channel.lines.variance[k] + lines.variance[k] + floor;
            products.push((
                k as f64,
                channel.lines.amplitude[k].conj() * model / variance,
            ));
        }
    }
    // Raising the angle by φ turns an amplitude c_k by −kφ: the sum below is what is left of the
    // squares that depends on φ.
    let turned = |k: f64, product: &Complex64, at: f64| product * Complex64::cis(k * at);
    let agreement = |at: f64| -> f64 { products.iter().map(|(k, p)| turned(*k, p, at).re).sum() };
    let angles = (0..ZEROS).map(|i| TAU * i as f64 / ZEROS as f64 - PI);
    let mut at = greatest(angles, agreement);
    for _ in 0..NEWTON {
        let slope: f64 = products
            .iter()
            .map(|(k, p)| -k * turned(*k, p, at).im)
            .sum();
        let bend: f64 = products
            .iter()
            .map(|(k, p)| -k * k * turned(*k, p, at).re)
            .sum();
        if bend < 0.0 {
            at -= (slope / bend).clamp(-PI / ZEROS as f64, PI / ZEROS as f64);
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::{Channel, Observed};
    use signal::order_lines::OrderLines;

    #[test]
    fn the_speed_is_found_in_the_waveform() {
        let (rate, speed) = (5000.0, 493.217);
        let turns = |i: usize| TAU * speed / 60.0 * i as f64 / rate;
        let wave = |i: usize| {
            let a = turns(i) + 0.4;
            let noise = ((i * 7919 % 1009) as f64 / 1009.0 - 0.5) * 0.02;
            a.cos() + 0.3 * (2.0 * a).cos() + 0.1 * (7.0 * a + 1.0).sin() + noise
        };
        let run = Run {
            id: "run".into(),
            settings: Vec::new(),
            speed_rpm: 500.0,
            sample_rate: rate,
            is_timed: true,
            crank_angle: None,
            channels: vec![Channel {
                column: "x".into(),
                samples: (0..15_000).map(wave).collect(),
            }],
        };
        let found = super::speed(&run);
        // At order 20 the angle is then wrong by less than 0.05 rad over the whole recording.
        assert!((found - speed).abs() < 2e-3, "{found}");
    }

    #[test]
    fn the_zero_is_found_by_what_the_model_shows() {
        let model: Vec<Complex64> = (0..40)
            .map(|k| Complex64::from_polar(1.0 / (1.0 + f64::from(k)), 0.3 * f64::from(k * k)))
            .collect();
        let lines = |amplitude: Vec<Complex64>| OrderLines {
            variance: vec![1e-6; amplitude.len()],
            amplitude,
            revolutions: 10,
        };
        for shift in [-3.0, -0.5, 1e-4, 2.2] {
            // x(θ) = m(θ + shift): the angle is to be raised by `shift`.
            let turned = model.iter().enumerate();
            let turned = turned.map(|(k, c)| c * Complex64::cis(k as f64 * shift));
            let observed = Observation {
                id: "run".into(),
                settings: Vec::new(),
                crank: mechanism::drive::GivenSpeed {
                    speed: 50.0,
                    fluctuation: Vec::new(),
                },
                channels: vec![Observed {
                    column: "x".into(),
                    lines: lines(turned.collect()),
                    orders: (0..40).collect(),
                }],
            };
            let predicted = Prediction {
                lines: vec![lines(model.clone())],
                derivatives: Vec::new(),
                periodic: true,
            };
            let found = phase(&observed, &predicted);
            assert!((found - shift).abs() < 1e-9, "{found} for {shift}");
        }
    }
}
