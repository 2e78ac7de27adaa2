//! How strongly a machine rings, where in its revolution, and in which band of orders.
//!
//! The phase of ringing has many local minima, its energy has few: a fit to energies leads to where a fit to lines may
//! begin. The lowest orders, which do not ring, count as lines. Where revolutions scatter, the mean of their energies is compared: that of
//! their mean is less, and differs by chance.

use crate::error::Error;
use crate::likelihood::{FAILED, amplitude, push, stacked, weights};
use crate::observation::{Observation, Observed};
use crate::optimiser::LeastSquares;
use crate::prediction::{Accuracy, Prediction, Wanted, to_a_thread};
use crate::problem::Problem;
use crate::sectors::{FIRST, KNOCKING, Sectors, between_orders, counts, knocks, noise};
use crate::superposition::{self, Superposition};
use nalgebra::DMatrix;
use rayon::prelude::*;
use signal::Complex64;

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
    noise: Noise,
    runs: Vec<Run<'a>>,
}

/// Below which noise energies are not told apart.
#[derive(Clone, Copy, Debug)]
enum Noise {
    /// That of the mean over all revolutions.
    Mean,
    /// That of a single revolution.
    Revolution,
}

/// A run with the recorded energies of each channel and band.
struct Run<'a> {
    observed: &'a Observation,
    channels: Vec<Vec<Recorded>>,
}

/// What was recorded in a band.
struct Recorded {
    sectors: Sectors,
    /// What is added to each energy before its logarithm is taken.
    floor: f64,
    /// The energy of each sector, in the mean over the revolutions where these scatter.
    energies: Vec<f64>,
    /// What of that is noise.
    noise: f64,
    /// Scatter that would not show beside the noise.
    unseen: f64,
}

fn residual_count(run: &Observation) -> usize {
    let of =
        |channel: &Observed| counts(&channel.orders).sum::<usize>() + 2 * lowest(channel).count();
    run.channels.iter().map(of).sum()
}

fn lowest(observed: &Observed) -> impl Iterator<Item = &usize> {
    observed.orders.iter().take_while(|k| **k < FIRST)
}

impl Recorded {
    /// What an observation shows in a band, with the scatter of its sectors. Its noise is that of the mean over its revolutions,
    /// so many times.
    fn new(sectors: Sectors, observed: &Observed, scatter: &[f64], revolutions: f64) -> Self {
        let lines = &observed.lines;
        let sum = |of: &[f64]| -> f64 { sectors.orders.clone().filter_map(|k| of.get(k)).sum() };
        let powers: Vec<f64> = lines.amplitude.iter().map(|c| c.norm_sqr()).collect();
        // A share of the band's own energy, and its noise.
        let floor = revolutions * sum(&lines.variance) + QUIET * sum(&powers);
        let mut recorded = Self {
            floor: floor.max(f64::MIN_POSITIVE),
            energies: sectors.energies(&lines.amplitude),
            noise: 0.0,
            unseen: 0.0,
            sectors,
        };
        let between = between_orders(lines, recorded.sectors.orders.clone());
        let noise = noise(scatter, between);
        match knocks(scatter, noise) {
            true => {
                add(&mut recorded.energies, scatter);
                recorded.noise = noise;
            }
            false => recorded.unseen = KNOCKING * noise,
        }
        recorded
    }
}

/// Takes the next of these values, as many as there are at most.
fn next<'s>(values: &mut &'s [f64], count: usize) -> &'s [f64] {
    let (next, rest) = values.split_at(count.min(values.len()));
    *values = rest;
    next
}

fn add(sum: &mut [f64], of: &[f64]) {
    sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += of);
}

impl<'a> Run<'a> {
    fn new(observed: &'a Observation, noise: Noise) -> Self {
        let of_channel = |channel: &Observed| -> Vec<Recorded> {
            let mut scatter = &channel.scatter[..];
            let revolutions = match noise {
                Noise::Mean => 1.0,
                Noise::Revolution => channel.lines.revolutions as f64,
            };
            let of_band = |sectors: Sectors| {
                let of_band = next(&mut scatter, sectors.count);
                Recorded::new(sectors, channel, of_band, revolutions)
            };
            let sectors = Sectors::of_channel(&channel.orders).into_iter();
            sectors.map(of_band).collect()
        };
        Self {
            observed,
            channels: observed.channels.iter().map(of_channel).collect(),
        }
    }

    /// The residuals of a run where it could be simulated.
    fn residuals(&self, prediction: Result<Prediction, Error>) -> Vec<f64> {
        prediction.map_or_else(
            |_| vec![FAILED; residual_count(self.observed)],
            |prediction| self.compared(&prediction, 0).0,
        )
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
            let mut scatter = prediction
                .scatter
                .get(channel)
                .map_or(&[][..], Vec::as_slice);
            for recorded in recorded {
                let (floor, sectors) = (recorded.floor, &recorded.sectors);
                let signal = sectors.signal(&predicted.amplitude);
                let mut here = sectors.means(|i| signal[i].norm_sqr());
                for (here, scatter) in here.iter_mut().zip(next(&mut scatter, sectors.count)) {
                    *here += (scatter - recorded.unseen).max(0.0);
                }
                here.iter_mut().for_each(|energy| *energy += recorded.noise);
                let apart = here.iter().zip(&recorded.energies);
                all.extend(
                    apart.map(|(here, there)| ((here + floor) / (there + floor)).ln() / SPREAD),
                );
                for (parameter, slopes) in slopes.iter_mut().enumerate() {
                    let moved = sectors.signal(derivative(parameter));
                    let change = sectors.means(|i| 2.0 * (signal[i].conj() * moved[i]).re);
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
        Self::above(problem, Noise::Mean)
    }

    /// The same where energies below the noise of a single revolution are not told apart, for a search from far away: what is that
    /// quiet has many small valleys.
    pub fn loud(problem: &'a Problem) -> Self {
        Self::above(problem, Noise::Revolution)
    }

    fn above(problem: &'a Problem, noise: Noise) -> Self {
        let runs = problem.runs.iter();
        let runs = runs.map(|run| Run::new(run, noise)).collect();
        Self {
            problem,
            machine: Superposition::new(problem),
            noise,
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

    /// The residuals of other machines in the same runs, each at its own coordinates. Those that are not taken apart into throws are
    /// simulated side by side.
    pub fn residuals_of_machines(&self, machines: &[(Problem, Vec<f64>)]) -> Vec<Vec<f64>> {
        let apart: Vec<Superposition> = machines
            .iter()
            .map(|(problem, _)| Superposition::new(problem))
            .collect();
        let wanted = machines.iter().zip(&apart).flat_map(|((_, x), machine)| {
            let runs = self.runs.iter();
            runs.map(move |run| (machine, (run, &x[..])))
        });
        let wanted: Vec<(&Superposition, (&Run, &[f64]))> = wanted.collect();
        let parts: Vec<Vec<f64>> = wanted
            .par_chunks(to_a_thread(wanted.len()))
            .flat_map_iter(|wanted| {
                let runs = wanted.iter();
                let runs = runs.map(|(machine, (run, x))| (*machine, (run.observed, *x)));
                let runs: Vec<(&Superposition, Wanted)> = runs.collect();
                let found = superposition::predictions_of_machines(&runs, Accuracy::Rough);
                let found = found.into_iter().zip(wanted);
                found.map(|(prediction, (_, (run, _)))| run.residuals(prediction))
            })
            .collect();
        let of_each = parts.chunks(self.runs.len().max(1));
        of_each.map(<[Vec<f64>]>::concat).collect()
    }

    /// Where exchanges of throws lead from this choice of a point for each throw, and what is left there.
    fn exchange(&self, all: &[Vec<f64>], mut chosen: Vec<usize>) -> (Vec<usize>, f64) {
        let mut least = self.squares_of_mixture(&points(all, &chosen));
        let mut unchanged = 0;
        for throw in (0..chosen.len()).cycle() {
            if unchanged == chosen.len() {
                break;
            }
            let with = |number: usize| {
                let mut chosen = chosen.clone();
                chosen[throw] = number;
                (number, self.squares_of_mixture(&points(all, &chosen)))
            };
            let each: Vec<(usize, f64)> = (0..all.len()).into_par_iter().map(with).collect();
            let best = each.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
            match best.filter(|(_, left)| *left < least) {
                Some((number, left)) => {
                    (chosen[throw], least) = (number, left);
                    unchanged = 1;
                }
                None => unchanged += 1,
            }
        }
        (chosen, least)
    }

    /// The squares of a machine whose throws are each at one of these points; infinite where it cannot be simulated.
    fn squares_of_mixture(&self, points: &[&[f64]]) -> f64 {
        let of_run = |run: &Run| {
            let prediction = self.machine.mixture(run.observed, points);
            prediction.map_or(f64::INFINITY, |prediction| {
                let residuals = run.compared(&prediction, 0).0;
                residuals.iter().map(|r| r * r).sum()
            })
        };
        self.runs.iter().map(of_run).sum()
    }

    /// The residuals of each of these runs at these coordinates.
    fn of_runs(&self, runs: &[(&Run, &[f64])]) -> Vec<Vec<f64>> {
        let wanted: Vec<_> = runs.iter().map(|(run, x)| (run.observed, *x)).collect();
        let predictions = self
            .machine
            .predictions(&wanted, Accuracy::Rough)
            .into_iter();
        let residuals = predictions.zip(runs);
        residuals
            .map(|(prediction, (run, _))| run.residuals(prediction))
            .collect()
    }

    /// The derivatives of a run's residuals: those of a motion that has settled.
    fn derivatives(&self, run: &Run, x: &[f64]) -> Result<DMatrix<f64>, Error> {
        let machine = &self.machine;
        let prediction = machine.with_derivatives(run.observed, x, Accuracy::Coarse)?;
        Ok(run.compared(&prediction, x.len()).1)
    }
}

/// The point that is chosen for each throw.
fn points<'p>(all: &'p [Vec<f64>], chosen: &[usize]) -> Vec<&'p [f64]> {
    chosen.iter().map(|number| &all[*number][..]).collect()
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
        self.problem
            .once_each(&("energies", self.noise), all, |unknown| {
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

    /// The best machines whose throws are each as in one of the points `all`, from so many of the first of these points: throw after throw is
    /// exchanged for that of another point, as long as the squares become less. With what is left of each; the points themselves are
    /// left out where the throws are not simulated by themselves.
    fn mixed(&self, all: &[Vec<f64>], first: usize) -> Vec<(Vec<f64>, f64)> {
        let throws = self.machine.throws();
        let firsts = 0..if throws > 1 { first.min(all.len()) } else { 0 };
        let mut found: Vec<(Vec<usize>, f64)> = Vec::new();
        for number in firsts {
            let end = self.exchange(all, vec![number; throws]);
            if !found.contains(&end) {
                found.push(end);
            }
        }
        let point =
            |(chosen, left): (Vec<usize>, f64)| (self.machine.mixed(&points(all, &chosen)), left);
        found.into_iter().map(point).collect()
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let columns = || {
            let whole = stacked(&self.runs, |run| {
                let none = |_| DMatrix::zeros(residual_count(run.observed), x.len());
                self.derivatives(run, x).unwrap_or_else(none)
            });
            whole.as_slice().to_vec()
        };
        let values = self
            .problem
            .once(&("derivatives of energies", self.noise), x, columns);
        DMatrix::from_vec(self.count(), x.len(), values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sectors::scatter;
    use mechanism::drive::GivenSpeed;
    use signal::order_lines::OrderLines;
    use std::f64::consts::{PI, TAU};

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
                scatter: Vec::new(),
            }],
            warm_start: None,
        }
    }

    fn shown(run: &Observation) -> Run<'_> {
        Run::new(run, Noise::Mean)
    }

    fn predicted(amplitude: Vec<Complex64>, derivatives: Vec<Vec<Vec<Complex64>>>) -> Prediction {
        Prediction {
            derivatives,
            ..Prediction::new(vec![lines(amplitude)], true)
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
    fn revolutions_that_scatter_are_compared_by_the_mean_of_their_energies() {
        // Half of the revolutions ring at 1 rad, the others do not.
        let half = ring(1.0, 0.5);
        let opposite: Vec<Complex64> = half.iter().map(|c| -c).collect();
        let orders: Vec<usize> = (0..=LAST).collect();
        let revolutions = [&half, &half, &opposite, &opposite].map(Vec::clone);
        let scatter = scatter(&orders, &revolutions);
        let mut recorded = run(half.clone());
        recorded.channels[0].scatter = scatter.clone();
        recorded.channels[0].lines.variance.fill(1e-12);
        let residual = |predicted: &Prediction| {
            let (residuals, _) = shown(&recorded).compared(predicted, 0);
            residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
        };
        let mut same = predicted(half.clone(), Vec::new());
        same.scatter = vec![scatter];
        assert!(residual(&same) < 0.1, "{}", residual(&same));
        // Without its scatter, the mean rings with half the energy.
        let mean = residual(&predicted(half, Vec::new()));
        assert!(mean > 10.0 * residual(&same), "{mean}");
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
