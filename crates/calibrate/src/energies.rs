//! How strongly a machine rings, where in its revolution, and in which band of orders.
//!
//! The phase of ringing has many local minima, its energy has few: a fit to energies leads to where a fit to lines may
//! begin. The lowest orders, which do not ring, count as lines.

use crate::error::Error;
use crate::likelihood::{FAILED, amplitude, push, stacked, weights};
use crate::observation::{Observation, Observed, POINTS};
use crate::optimiser::LeastSquares;
use crate::prediction::{Accuracy, Prediction, to_a_thread};
use crate::problem::Problem;
use crate::superposition::Superposition;
use nalgebra::DMatrix;
use rayon::prelude::*;
use signal::Complex64;
use std::f64::consts::PI;

/// The first order of the lowest band; the bands are octaves.
const FIRST: usize = 8;
/// Least and greatest number of sectors of a band, and its orders to a sector: a band does not resolve more.
const SECTORS: [usize; 2] = [4, 24];
const ORDERS: usize = 2;
/// Energies below this share of a band's mean are not told apart.
const QUIET: f64 = 0.03;
/// Standard deviation of the logarithm of an energy that a law somewhat off predicts: 16 % of the amplitude.
const SPREAD: f64 = 0.3;
/// By how much a slow feature may stand elsewhere, rad.
pub const TIMING: f64 = 0.03;

/// The residuals of a problem's energies: differences of logarithms over [`SPREAD`].
pub struct Energies<'a> {
    problem: &'a Problem,
    machine: Superposition<'a>,
    runs: Vec<Run<'a>>,
}

/// A run with the recorded energies of each channel and band.
struct Run<'a> {
    observed: &'a Observation,
    channels: Vec<Vec<Recorded>>,
}

/// A band of one channel.
struct Band {
    orders: std::ops::Range<usize>,
    sectors: usize,
}

/// A band with what was recorded in it.
struct Recorded {
    band: Band,
    /// The sector that each point of the grid lies in, and its share in that; the rest is the next sector's.
    shares: Vec<(usize, f64)>,
    /// What is added to each energy before its logarithm is taken.
    floor: f64,
    /// The energy of each sector.
    energies: Vec<f64>,
}

/// The bands of a channel that is compared up to the order `last`.
fn bands(last: usize) -> Vec<Band> {
    let mut bands = Vec::new();
    let mut first = FIRST;
    while first <= last {
        let orders = first..(2 * first).min(last + 1);
        let sectors = (orders.len() / ORDERS).clamp(SECTORS[0], SECTORS[1]);
        bands.push(Band { orders, sectors });
        first *= 2;
    }
    bands
}

fn last(observed: &Observed) -> usize {
    observed.orders.last().copied().unwrap_or(0)
}

fn residual_count(run: &Observation) -> usize {
    let of = |channel: &Observed| {
        let bands: usize = bands(last(channel)).iter().map(|band| band.sectors).sum();
        bands + 2 * lowest(channel).count()
    };
    run.channels.iter().map(of).sum()
}

fn lowest(observed: &Observed) -> impl Iterator<Item = &usize> {
    observed.orders.iter().take_while(|k| **k < FIRST)
}

impl Band {
    /// The signal of its orders over the grid of crank angles.
    fn signal(&self, lines: &[Complex64]) -> Vec<Complex64> {
        let mut signal = vec![Complex64::ZERO; POINTS];
        for k in self.orders.clone() {
            signal[k] = lines.get(k).copied().unwrap_or_default();
        }
        fourier::inverse_complex(&mut signal);
        signal
    }

    /// The sector of each point of the grid, and the point's share in it. Sectors overlap by half.
    fn shares(&self) -> Vec<(usize, f64)> {
        let width = POINTS as f64 / self.sectors as f64;
        let of = |point: usize| {
            let place = point as f64 / width;
            let share = 0.5 * (1.0 + (PI * place.fract()).cos());
            (place.floor() as usize, share)
        };
        (0..POINTS).map(of).collect()
    }

    /// A share of its own energy, and its noise.
    fn floor(&self, observed: &Observed) -> f64 {
        let sum = |of: &[f64]| -> f64 { self.orders.clone().filter_map(|k| of.get(k)).sum() };
        let energies: Vec<f64> = observed
            .lines
            .amplitude
            .iter()
            .map(|c| c.norm_sqr())
            .collect();
        let floor = sum(&observed.lines.variance) + QUIET * sum(&energies);
        floor.max(f64::MIN_POSITIVE)
    }
}

impl Recorded {
    /// What an observation shows in a band.
    fn new(band: Band, observed: &Observed) -> Self {
        let signal = band.signal(&observed.lines.amplitude);
        let mut recorded = Self {
            shares: band.shares(),
            floor: band.floor(observed),
            energies: Vec::new(),
            band,
        };
        recorded.energies = recorded.means(|i| signal[i].norm_sqr());
        recorded
    }

    /// Means of a function of the grid over the sectors.
    fn means(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        let count = self.band.sectors;
        let mut means = vec![0.0; count];
        for (point, (sector, share)) in self.shares.iter().enumerate() {
            let value = of(point);
            means[*sector] += share * value;
            means[(sector + 1) % count] += (1.0 - share) * value;
        }
        let scale = count as f64 / POINTS as f64;
        means.iter().map(|mean| mean * scale).collect()
    }
}

impl<'a> Run<'a> {
    fn new(observed: &'a Observation) -> Self {
        let of_channel = |channel: &Observed| -> Vec<Recorded> {
            let bands = bands(last(channel)).into_iter();
            bands.map(|band| Recorded::new(band, channel)).collect()
        };
        Self {
            observed,
            channels: observed.channels.iter().map(of_channel).collect(),
        }
    }

    /// The residuals of a run, channel by channel: its lowest lines, then its bands; with their derivatives by `count`
    /// coordinates.
    fn compared(&self, prediction: &Prediction, count: usize) -> (Vec<f64>, DMatrix<f64>) {
        let mut all = Vec::new();
        let mut slopes: Vec<Vec<f64>> = vec![Vec::new(); count];
        let channels = self.observed.channels.iter();
        let predicted = channels.zip(&prediction.lines).zip(&self.channels);
        for (channel, ((observed, predicted), recorded)) in predicted.enumerate() {
            let derivative = |parameter: usize| -> &[Complex64] {
                let of = prediction.derivatives.get(parameter);
                of.and_then(|of| of.get(channel)).map_or(&[], Vec::as_slice)
            };
            let weights = weights(observed, predicted, TIMING);
            for (k, weight) in lowest(observed).zip(weights) {
                let apart = amplitude(predicted, *k) - observed.lines.amplitude[*k];
                push(&mut all, apart * weight, *k);
                for (parameter, slopes) in slopes.iter_mut().enumerate() {
                    let slope = derivative(parameter).get(*k).copied().unwrap_or_default();
                    push(slopes, slope * weight, *k);
                }
            }
            for recorded in recorded {
                let floor = recorded.floor;
                let signal_of = |lines| recorded.band.signal(lines);
                let signal = signal_of(&predicted.amplitude);
                let here = recorded.means(|i| signal[i].norm_sqr());
                let apart = here.iter().zip(&recorded.energies);
                all.extend(
                    apart.map(|(here, there)| ((here + floor) / (there + floor)).ln() / SPREAD),
                );
                for (parameter, slopes) in slopes.iter_mut().enumerate() {
                    let moved = signal_of(derivative(parameter));
                    let change = recorded.means(|i| 2.0 * (signal[i].conj() * moved[i]).re);
                    let each = change.iter().zip(&here);
                    slopes.extend(each.map(|(change, here)| change / (here + floor) / SPREAD));
                }
            }
        }
        let rows = all.len();
        let slopes = DMatrix::from_vec(rows, count, slopes.concat());
        (all, slopes)
    }
}

impl<'a> Energies<'a> {
    /// Of this problem.
    pub fn new(problem: &'a Problem) -> Self {
        let runs = problem.runs.iter();
        let runs = runs.map(Run::new).collect();
        Self {
            problem,
            machine: Superposition::new(problem),
            runs,
        }
    }

    /// The sum of the squares of the residuals.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub fn squares(&self, x: &[f64]) -> Result<f64, Error> {
        self.squares_of_all(&[x.to_vec()]).swap_remove(0)
    }

    /// The same at each of several points, which are simulated side by side.
    ///
    /// # Errors
    /// Each its own, as [`squares`](Self::squares).
    pub(crate) fn squares_of_all(&self, all: &[Vec<f64>]) -> Vec<Result<f64, Error>> {
        let squares = |residuals: Vec<f64>| match residuals.contains(&FAILED) {
            true => Err(Error::Nothing("a run cannot be simulated")),
            false => Ok(residuals.iter().map(|r| r * r).sum()),
        };
        let residuals = self.residuals_of_all(all).into_iter();
        residuals.map(squares).collect()
    }

    /// The residuals of each of these runs at these coordinates.
    fn of_runs(&self, runs: &[(&Run, &[f64])]) -> Vec<Vec<f64>> {
        let wanted: Vec<_> = runs.iter().map(|(run, x)| (run.observed, *x)).collect();
        let predictions = self
            .machine
            .predictions(&wanted, Accuracy::Rough)
            .into_iter();
        let residuals = predictions.zip(runs).map(|(prediction, (run, _))| {
            prediction.map_or_else(
                |_| vec![FAILED; residual_count(run.observed)],
                |prediction| run.compared(&prediction, 0).0,
            )
        });
        residuals.collect()
    }

    /// The derivatives of a run's residuals: those of a motion that has settled.
    fn derivatives(&self, run: &Run, x: &[f64]) -> Result<DMatrix<f64>, Error> {
        let machine = &self.machine;
        let prediction = machine.with_derivatives(run.observed, x, Accuracy::Coarse)?;
        Ok(run.compared(&prediction, x.len()).1)
    }
}

impl LeastSquares for Energies<'_> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.problem
            .parameters
            .iter()
            .map(|p| p.box_bounds())
            .collect()
    }

    fn count(&self) -> usize {
        self.problem.runs.iter().map(residual_count).sum()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.residuals_of_all(&[x.to_vec()]).concat()
    }

    fn residuals_of_all(&self, all: &[Vec<f64>]) -> Vec<Vec<f64>> {
        self.problem.once_each(&"energies", all, |unknown| {
            let runs = unknown
                .iter()
                .flat_map(|x| self.runs.iter().map(move |run| (run, &x[..])));
            let runs: Vec<_> = runs.collect();
            let parts: Vec<Vec<f64>> = runs
                .par_chunks(to_a_thread(runs.len()))
                .flat_map_iter(|runs| self.of_runs(runs))
                .collect();
            let of_each = parts.chunks(self.runs.len().max(1));
            of_each.map(<[Vec<f64>]>::concat).collect()
        })
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let columns = || {
            let whole = stacked(&self.runs, |run| {
                let none = |_| DMatrix::zeros(residual_count(run.observed), x.len());
                self.derivatives(run, x).unwrap_or_else(none)
            });
            whole.as_slice().to_vec()
        };
        let values = self.problem.once(&"derivatives of energies", x, columns);
        DMatrix::from_vec(self.count(), x.len(), values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mechanism::drive::GivenSpeed;
    use signal::order_lines::OrderLines;
    use std::f64::consts::TAU;

    const LAST: usize = 70;

    /// Lines of a ring of order 40 that begins at `start` and dies off within a twelfth of a revolution.
    fn ring(start: f64, strength: f64) -> Vec<Complex64> {
        let decay = 12.0 / TAU;
        let line = |k: usize| {
            let beside = Complex64::new(decay, k as f64 - 40.0);
            strength * Complex64::from_polar(1.0, -(k as f64) * start) / beside
        };
        (0..=LAST).map(line).collect()
    }

    fn lines(amplitude: Vec<Complex64>) -> OrderLines {
        OrderLines {
            variance: vec![1e-6; amplitude.len()],
            amplitude,
            revolutions: 20,
        }
    }

    fn run(amplitude: Vec<Complex64>) -> Observation {
        Observation {
            id: String::new(),
            settings: Vec::new(),
            crank: GivenSpeed {
                speed: 50.0,
                fluctuation: Vec::new(),
            },
            channels: vec![Observed {
                column: "crosshead_acceleration_m_s2".into(),
                orders: (0..=LAST).collect(),
                lines: lines(amplitude),
            }],
        }
    }

    fn shown(run: &Observation) -> Run<'_> {
        Run::new(run)
    }

    fn predicted(amplitude: Vec<Complex64>, derivatives: Vec<Vec<Vec<Complex64>>>) -> Prediction {
        Prediction {
            lines: vec![lines(amplitude)],
            derivatives,
            periodic: true,
        }
    }

    #[test]
    fn a_ring_out_of_phase_has_the_same_energies_and_a_stronger_one_has_not() {
        let recorded = run(ring(1.0, 1.0));
        let norm = |amplitude| {
            let (residuals, _) = shown(&recorded).compared(&predicted(amplitude, Vec::new()), 0);
            assert_eq!(residuals.len(), residual_count(&recorded));
            residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
        };
        assert!(norm(ring(1.0, 1.0)) < 1e-9);
        // Half a cycle of order 40 later every line of it has another sign.
        let turned = norm(ring(1.0 + PI / 40.0, 1.0));
        let stronger = norm(ring(1.0, 2.0));
        assert!(2.0 * turned < stronger, "{turned} {stronger}");
        // Where it begins a quarter of a revolution later the energies stand elsewhere.
        let later = norm(ring(1.0 + 0.25 * TAU, 1.0));
        assert!(later > 2.0 * turned, "{turned} {later}");
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let recorded = run(ring(1.0, 1.0));
        let (here, by) = (ring(1.1, 1.4), ring(2.0, 0.7));
        let moved = |h: f64| here.iter().zip(&by).map(|(c, d)| c + d * h).collect();
        let at = |h| {
            shown(&recorded)
                .compared(&predicted(moved(h), Vec::new()), 0)
                .0
        };
        let with = predicted(here.clone(), vec![vec![by.clone()]]);
        let (_, slopes) = shown(&recorded).compared(&with, 1);
        let h = 1e-5;
        for ((up, down), slope) in at(h).iter().zip(at(-h)).zip(slopes.column(0).iter()) {
            let difference = (up - down) / (2.0 * h);
            assert!((difference - slope).abs() < 1e-6 * (1.0 + slope.abs()));
        }
    }
}
