//! Speed and zero of the crank angle of a recording without one.
//! The speed is that at which the recording repeats itself. The zero is that of the model's prediction.

use crate::observation::{Observation, Observed, Run};
use crate::prediction::Prediction;
use signal::Complex64;
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
/// Share by which a machine that is not fitted has a line wrong.
const OFF: f64 = 0.3;
/// Squares in units of the noise by which another zero must leave more: four standard deviations.
const DETERMINED: f64 = 16.0;

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

/// Where the zero of recorded crank angles is, as the machine shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// By how much to raise the recorded crank angles so that they agree with the machine, rad in (−π, π].
    pub raised: f64,
    /// Another angle that recordings and machine allow as well; none where they determine the zero.
    pub rival: Option<f64>,
}

/// By how much to raise the crank angle of an observed run so that it agrees with the prediction, rad in (−π, π].
/// Least squares over all lines, weighted by the noise of both.
pub fn phase(observed: &Observation, predicted: &Prediction) -> f64 {
    Products::new(&[(observed, predicted)], 0.0, |_| true)
        .zero()
        .raised
}

/// The same of all these runs together, with what else it may be, where the machine may not be that of the recordings in all:
/// each line is taken to be wrong by a share of itself beside its noise. Worn joints and a structure that is not quite known
/// change single lines by as much, and what most lines agree about remains. They hardly change pressures, which tell the zero
/// alone where there are any.
pub fn zero(runs: &[(&Observation, &Prediction)]) -> Zero {
    let channels = runs.iter().flat_map(|(observed, _)| &observed.channels);
    let pressures = channels.filter(|c| c.quantity().is_pressure()).count();
    let tells = |channel: &Observed| pressures == 0 || channel.quantity().is_pressure();
    let (loose, strict) = (
        Products::new(runs, OFF, tells),
        Products::new(runs, 0.0, tells),
    );
    let found = loose.zero();
    // The noise alone tells the angle more closely, where it tells the same one.
    let closer = strict.refined(found.raised);
    match loose.allows(closer, found.raised, 1.0) {
        true => Zero {
            raised: closer,
            ..found
        },
        false => found,
    }
}

/// What of the squares between lines observed and predicted depends on the angle.
struct Products {
    /// The order, and the observed line conjugate times the predicted one, over their variance.
    each: Vec<(f64, Complex64)>,
    /// The squares of both, over the variance.
    power: f64,
}

impl Products {
    /// Those of the channels that `tells`, which the machine has wrong by the share `off` of each line.
    fn new(
        runs: &[(&Observation, &Prediction)],
        off: f64,
        tells: impl Fn(&Observed) -> bool,
    ) -> Self {
        let mut products = Self {
            each: Vec::new(),
            power: 0.0,
        };
        let channels = runs
            .iter()
            .flat_map(|(observed, predicted)| observed.channels.iter().zip(&predicted.lines));
        for (channel, lines) in channels.filter(|(channel, _)| tells(channel)) {
            let greatest = channel.lines.amplitude.iter().map(|c| c.norm());
            let floor = (1e-4 * greatest.fold(0.0, f64::max)).powi(2);
            for &k in channel.orders.iter().filter(|k| **k > 0) {
                let Some(model) = lines.amplitude.get(k) else {
                    continue;
                };
                let seen = channel.lines.amplitude[k];
                let power = seen.norm_sqr() + model.norm_sqr();
                let noise = channel.lines.variance[k] + lines.variance[k] + floor;
                let variance = noise + 0.5 * off * off * power;
                products
                    .each
                    .push((k as f64, seen.conj() * model / variance));
                products.power += power / variance;
            }
        }
        products
    }

    /// The angle at which they agree best in the whole turn, and another one that they allow.
    fn zero(&self) -> Zero {
        let step = TAU / ZEROS as f64;
        let angles: Vec<f64> = (0..ZEROS).map(|i| step * i as f64 - PI).collect();
        let agreements: Vec<f64> = angles.iter().map(|at| self.agreement(*at)).collect();
        let peaks = (0..ZEROS).filter(|i| {
            let beside = [(i + ZEROS - 1) % ZEROS, (i + 1) % ZEROS];
            beside.iter().all(|j| agreements[*i] >= agreements[*j])
        });
        let mut peaks: Vec<usize> = peaks.collect();
        peaks.sort_by(|a, b| agreements[*b].total_cmp(&agreements[*a]));
        let best = peaks.first().map_or(0, |i| *i);
        let raised = self.refined(angles[best]);
        let apart = |i: &&usize| {
            let ahead = (**i + ZEROS - best) % ZEROS;
            ahead.min(ZEROS - ahead) > 1
        };
        let rival = peaks.iter().find(apart).map(|i| self.refined(angles[*i]));
        Zero {
            raised,
            rival: rival.filter(|at| self.allows(*at, raised, DETERMINED)),
        }
    }

    /// Whether an angle leaves fewer than so many `squares` more than the `best` one. Their unit is what that one leaves of a
    /// line, but no less than the noise.
    fn allows(&self, at: f64, best: f64, squares: f64) -> bool {
        let agreed = self.agreement(best);
        // What is left of the squares is the power of both less twice the agreement.
        let left = (self.power - 2.0 * agreed) / (2.0 * self.each.len() as f64).max(1.0);
        agreed - self.agreement(at) < 0.5 * squares * left.max(1.0)
    }

    /// How well they agree where the crank angle is raised by `at`: that turns an amplitude c_k by −k times it.
    fn agreement(&self, at: f64) -> f64 {
        let turned = self.each.iter().map(|(k, c)| c * Complex64::cis(k * at));
        turned.map(|c| c.re).sum()
    }

    /// The angle of greatest agreement near `at`, by Newton's method.
    fn refined(&self, mut at: f64) -> f64 {
        for _ in 0..NEWTON {
            let (mut slope, mut bend) = (0.0, 0.0);
            for (k, c) in &self.each {
                let turned = c * Complex64::cis(k * at);
                slope -= k * turned.im;
                bend -= k * k * turned.re;
            }
            if bend < 0.0 {
                at -= (slope / bend).clamp(-PI / ZEROS as f64, PI / ZEROS as f64);
            }
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::Channel;
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

    /// A run that has the lines of `model` over an angle that is to be raised by `shift`, and a prediction of the model.
    fn shifted(model: &[Complex64], shift: f64) -> (Observation, Prediction) {
        let lines = |amplitude: Vec<Complex64>| OrderLines {
            variance: vec![1e-6; amplitude.len()],
            amplitude,
            revolutions: 10,
        };
        // x(θ) = m(θ + shift).
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
                scatter: Vec::new(),
                column: "x".into(),
                lines: lines(turned.collect()),
                orders: (0..model.len()).collect(),
            }],
            warm_start: None,
        };
        let predicted = Prediction::new(vec![lines(model.to_vec())], true);
        (observed, predicted)
    }

    #[test]
    fn another_zero_is_named_where_the_recordings_allow_it() {
        // Even orders alone are the same after half a turn. A first order of four standard deviations tells the two apart.
        for (first, determined) in [(0.0, false), (2e-3, false), (6e-3, true)] {
            let model = [0.0, first, 1.0, 0.0, 0.3].map(Complex64::from);
            let (observed, predicted) = shifted(&model, 0.7);
            let found = zero(&[(&observed, &predicted)]);
            assert_eq!(found.rival.is_none(), determined, "{first}: {found:?}");
            if let Some(rival) = found.rival {
                let half = (rival - found.raised).abs();
                assert!((half - PI).abs() < 1e-6, "{found:?}");
            }
        }
        let (observed, predicted) = shifted(&[Complex64::ZERO; 5], 0.0);
        assert!(zero(&[(&observed, &predicted)]).rival.is_some());
    }

    #[test]
    fn the_zero_is_found_by_what_the_model_shows() {
        let model: Vec<Complex64> = (0..40)
            .map(|k| Complex64::from_polar(1.0 / (1.0 + f64::from(k)), 0.3 * f64::from(k * k)))
            .collect();
        for shift in [-3.0, -0.5, 1e-4, 2.2] {
            let (observed, predicted) = shifted(&model, shift);
            let found = phase(&observed, &predicted);
            assert!((found - shift).abs() < 1e-9, "{found} for {shift}");
        }
    }
}
