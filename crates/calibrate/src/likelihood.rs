//! How far a prediction is from an observation, in units of the noise.

use crate::error::Error;
use crate::observation::{Observation, Observed};
use crate::optimiser::LeastSquares;
use crate::prediction::{Accuracy, Prediction, Wanted, predictions, to_a_thread, with_derivatives};
use crate::problem::Problem;
use crate::superposition::Superposition;
use nalgebra::DMatrix;
use rayon::prelude::*;
use signal::Complex64;
use signal::order_lines::OrderLines;

/// A misfit below this, in standard deviations of the noise, is noise: no better fit is looked for.
pub const NOISE: f64 = 1.15;

/// Accuracy of resampling and of the integration, as a share of a channel's greatest line: lines
/// are never trusted beyond it.
const ACCURACY: f64 = 2e-5;
/// Simulations of a motion that scatters over which something is a mean, and by how much their coordinates differ.
pub(crate) const SAMPLES: u32 = 8;
const BESIDE: f64 = 1e-6;
/// Residual that stands in for every one of a run that cannot be simulated.
pub(crate) const FAILED: f64 = 1e3;

/// The residuals of a problem: differences of amplitudes over their standard deviations.
///
/// The real and the imaginary part of a line are one residual each, its noise being divided evenly
/// between the two. Where the model is right, every residual has variance 1, and half the sum of
/// their squares is the negative logarithm of the likelihood.
pub struct Likelihood<'a> {
    problem: &'a Problem,
    /// Standard deviation of the crank angle at which a feature may stand, rad.
    timing: f64,
    /// The throws by themselves, where they are taken apart.
    parts: Option<Superposition<'a>>,
}

impl<'a> Likelihood<'a> {
    /// Of this problem.
    pub fn new(problem: &'a Problem) -> Self {
        Self::coarse(problem, 0.0)
    }

    /// The same with features that may stand `timing` away from where they are seen (a standard
    /// deviation, rad). An order k is then trusted only as far as it does not turn over this angle. The landscape
    /// becomes smoother, and the slow features of a signal count most.
    pub fn coarse(problem: &'a Problem, timing: f64) -> Self {
        Self {
            problem,
            timing,
            parts: None,
        }
    }

    /// The same with throws that do not act on each other: the crank turns as recorded.
    pub(crate) fn in_parts(problem: &'a Problem, timing: f64) -> Self {
        Self {
            parts: (timing > 0.0).then(|| Superposition::new(problem)),
            ..Self::coarse(problem, timing)
        }
    }

    /// Twice the negative logarithm of the likelihood, but for a constant: what is left over its variance, and the
    /// variance, which a greater allowance for timing makes greater. Without such an allowance the noise is taken for
    /// greater where more than noise is left, by a factor that makes the recordings likeliest.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub fn deviance(&self, x: &[f64]) -> Result<f64, Error> {
        Ok(self.deviance_of(&self.predictions(x)?, self.timing))
    }

    /// The deviance, and the variance that it has by chance: of motions that scatter, that of one simulation is one of many.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub(crate) fn mean_deviance(&self, x: &[f64]) -> Result<(f64, f64), Error> {
        let samples = self.samples(x).into_iter().map(|x| self.deviance(&x));
        let samples = samples.collect::<Result<Vec<f64>, Error>>()?;
        let count = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / count;
        let squares = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>();
        Ok((mean, squares / (count * (count - 1.0).max(1.0))))
    }

    /// Coordinates whose motions have the same means as those of `x`, and scatter otherwise; `x` alone where the recorded motions
    /// repeat themselves.
    pub(crate) fn samples(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let count = match self.problem.runs.iter().all(Observation::repeats) {
            true => 1,
            false => SAMPLES as usize,
        };
        beside(x).take(count).collect()
    }

    /// The allowance among `timings` with which the recordings are likeliest at `x`, and the deviance there.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub fn likeliest(&self, x: &[f64], timings: &[f64]) -> Result<(f64, f64), Error> {
        self.likeliest_of_all(&[x.to_vec()], timings).swap_remove(0)
    }

    /// The same at each of several points, which are simulated side by side.
    ///
    /// # Errors
    /// Each its own, as [`likeliest`](Self::likeliest).
    pub(crate) fn likeliest_of_all(
        &self,
        all: &[Vec<f64>],
        timings: &[f64],
    ) -> Vec<Result<(f64, f64), Error>> {
        let what = ("likeliest", self.timing, self.parts.is_some(), timings);
        let mut failures: Vec<(Vec<f64>, Error)> = Vec::new();
        let best = self.problem.once_each(&what, all, |unknown| {
            let of_point = |(x, predictions): (&Vec<f64>, Result<Vec<Prediction>, Error>)| {
                let predictions = match predictions {
                    Ok(predictions) => predictions,
                    Err(error) => {
                        failures.push((x.clone(), error));
                        return Vec::new();
                    }
                };
                let left = |timing: &f64| self.deviance_of(&predictions, *timing);
                let each = timings.iter().map(|timing| [*timing, left(timing)]);
                let best = each.min_by(|a, b| a[1].total_cmp(&b[1]));
                best.map_or_else(Vec::new, Vec::from)
            };
            let predictions = self.predictions_of_all(unknown);
            unknown.iter().zip(predictions).map(of_point).collect()
        });
        let of_point = |(best, x): (Vec<f64>, &Vec<f64>)| match best[..] {
            [timing, left] => Ok((timing, left)),
            _ => Err(match failures.iter().position(|(at, _)| at == x) {
                Some(i) => failures.swap_remove(i).1,
                None => Error::Nothing("a run cannot be simulated"),
            }),
        };
        best.into_iter().zip(all).map(of_point).collect()
    }

    fn deviance_of(&self, predictions: &[Prediction], timing: f64) -> f64 {
        let (mut spread, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (run, prediction) in self.problem.runs.iter().zip(predictions) {
            for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
                let weights = weights(observed, predicted, timing);
                for (k, weight) in observed.orders.iter().zip(weights) {
                    let parts = if *k == 0 { 1.0 } else { 2.0 };
                    spread -= 2.0 * parts * weight.ln();
                    count += parts;
                }
            }
            let residuals = residuals(run, prediction, timing);
            squares += residuals.iter().map(|r| r * r).sum::<f64>();
        }
        let mean = if count > 0.0 { squares / count } else { 0.0 };
        match timing > 0.0 || mean <= 1.0 {
            true => spread + squares,
            false => spread + count * (mean.ln() + 1.0),
        }
    }

    fn accuracy(&self) -> Accuracy {
        match self.timing > 0.0 {
            true => Accuracy::Coarse,
            false => Accuracy::Fine,
        }
    }

    fn with_derivatives(&self, run: &Observation, x: &[f64]) -> Result<Prediction, Error> {
        match &self.parts {
            Some(parts) => parts.with_derivatives(run, x, self.accuracy()),
            None => with_derivatives(self.problem, run, x, self.accuracy()),
        }
    }

    /// The predictions of these runs, or why there are none.
    fn predicted(&self, wanted: &[Wanted]) -> Vec<Result<Prediction, Error>> {
        let together = wanted.par_chunks(to_a_thread(wanted.len()));
        let of = |wanted: &[Wanted]| match &self.parts {
            Some(parts) => parts.predictions(wanted, self.accuracy()),
            None => predictions(self.problem, wanted, self.accuracy()),
        };
        together.flat_map_iter(of).collect()
    }

    /// The predictions of all runs.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub fn predictions(&self, x: &[f64]) -> Result<Vec<Prediction>, Error> {
        self.predictions_of_all(&[x.to_vec()]).swap_remove(0)
    }

    /// The predictions of all runs at each of several points.
    fn predictions_of_all(&self, all: &[Vec<f64>]) -> Vec<Result<Vec<Prediction>, Error>> {
        let mut predictions = self.predicted(&self.wanted(all)).into_iter();
        let of_point = |_| {
            let of_runs = predictions.by_ref().take(self.problem.runs.len());
            let of_runs: Vec<Result<Prediction, Error>> = of_runs.collect();
            of_runs.into_iter().collect()
        };
        all.iter().map(of_point).collect()
    }

    /// All runs at each of these points.
    fn wanted<'w>(&'w self, all: &'w [Vec<f64>]) -> Vec<Wanted<'w>> {
        let of_point = |x: &'w Vec<f64>| self.problem.runs.iter().map(move |run| (run, &x[..]));
        all.iter().flat_map(of_point).collect()
    }

    /// The residuals of each run.
    ///
    /// # Errors
    /// The first run that cannot be simulated.
    pub fn by_run(&self, x: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let predictions = self.predictions(x)?;
        let runs = self.problem.runs.iter().zip(&predictions);
        Ok(runs
            .map(|(run, p)| residuals(run, p, self.timing))
            .collect())
    }
}

impl LeastSquares for Likelihood<'_> {
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
        let what = ("residuals", self.timing, self.parts.is_some());
        self.problem.once_each(&what, all, |unknown| {
            let wanted = self.wanted(unknown);
            let of_run = |((run, _), prediction): (&Wanted, _)| match prediction {
                Ok(prediction) => residuals(run, &prediction, self.timing),
                Err(_) => vec![FAILED; residual_count(run)],
            };
            let found = self.predicted(&wanted);
            let parts: Vec<Vec<f64>> = wanted.iter().zip(found).map(of_run).collect();
            parts
                .chunks(self.problem.runs.len().max(1))
                .map(<[Vec<f64>]>::concat)
                .collect()
        })
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let what = ("derivatives", self.timing, self.parts.is_some());
        let columns = || self.evaluated_jacobian(x).as_slice().to_vec();
        let values = self.problem.once(&what, x, columns);
        DMatrix::from_vec(self.count(), x.len(), values)
    }
}

impl Likelihood<'_> {
    fn evaluated_jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        stacked(&self.problem.runs, |run| {
            match self.with_derivatives(run, x) {
                Ok(prediction) => derivatives(run, &prediction, x.len(), self.timing),
                Err(_) => DMatrix::zeros(residual_count(run), x.len()),
            }
        })
    }
}

/// Coordinates so near to `x`, itself first, that their machines are the same but for how their motions begin to part.
pub(crate) fn beside(x: &[f64]) -> impl Iterator<Item = Vec<f64>> {
    (0..SAMPLES).map(|number| x.iter().map(|x| x + f64::from(number) * BESIDE).collect())
}

/// The rows of each run, one under another.
pub(crate) fn stacked<R: Sync>(
    runs: &[R],
    of_run: impl Fn(&R) -> DMatrix<f64> + Sync + Send,
) -> DMatrix<f64> {
    let parts: Vec<DMatrix<f64>> = runs.par_iter().map(of_run).collect();
    let rows = parts.iter().map(DMatrix::nrows).sum();
    let mut whole = DMatrix::zeros(rows, parts.first().map_or(0, DMatrix::ncols));
    let mut row = 0;
    for part in &parts {
        whole.rows_mut(row, part.nrows()).copy_from(part);
        row += part.nrows();
    }
    whole
}

/// Root mean square of residuals, which are in standard deviations of the noise: 1 where noise is all that is left.
pub fn misfit(residuals: &[f64]) -> f64 {
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    (squares / residuals.len().max(1) as f64).sqrt()
}

fn residual_count(run: &Observation) -> usize {
    let channels = run.channels.iter();
    channels.map(|channel| channel.orders.len() * 2).sum()
}

/// The residuals of a run, channel by channel.
pub(crate) fn residuals(run: &Observation, prediction: &Prediction, timing: f64) -> Vec<f64> {
    let mut all = Vec::with_capacity(residual_count(run));
    for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
        let weights = weights(observed, predicted, timing);
        for (k, weight) in observed.orders.iter().zip(weights) {
            let apart = amplitude(predicted, *k) - observed.lines.amplitude[*k];
            push(&mut all, apart * weight, *k);
        }
    }
    all
}

fn derivatives(
    run: &Observation,
    prediction: &Prediction,
    count: usize,
    timing: f64,
) -> DMatrix<f64> {
    let mut whole = DMatrix::zeros(residual_count(run), count);
    // A motion that does not repeat itself has none.
    for (column, of_parameter) in prediction.derivatives.iter().enumerate() {
        let mut all = Vec::with_capacity(residual_count(run));
        let channels = run.channels.iter().zip(&prediction.lines).zip(of_parameter);
        for ((observed, predicted), derivative) in channels {
            let weights = weights(observed, predicted, timing);
            for (k, weight) in observed.orders.iter().zip(weights) {
                let slope = derivative.get(*k).copied().unwrap_or_default();
                push(&mut all, slope * weight, *k);
            }
        }
        whole.column_mut(column).copy_from_slice(&all);
    }
    whole
}

/// The mean of an acceleration belongs to the sensor; that of a pressure has no imaginary part.
pub(crate) fn push(all: &mut Vec<f64>, value: Complex64, order: usize) {
    all.push(value.re);
    all.push(if order == 0 { 0.0 } else { value.im });
}

pub(crate) fn amplitude(lines: &OrderLines, order: usize) -> Complex64 {
    lines.amplitude.get(order).copied().unwrap_or_default()
}

/// One over the standard deviation of the real part of each compared line. An error ε of the angle,
/// normal with variance τ², moves a line c by a mean square E|c e^(ikε) − c|² = 2|c|²(1 − e^(−k²τ²/2)).
pub(crate) fn weights(observed: &Observed, predicted: &OrderLines, timing: f64) -> Vec<f64> {
    let lines = &observed.lines.amplitude;
    let greatest = lines.iter().map(|c| c.norm()).fold(0.0, f64::max);
    let accuracy = (ACCURACY * greatest).powi(2);
    let of = |lines: &OrderLines, k: usize| lines.variance.get(k).copied().unwrap_or(0.0);
    // A prediction that scatters more than the recording is not forgiven for it: it is wrong.
    let shorter = observed.lines.revolutions as f64 / predicted.revolutions.max(1) as f64;
    observed
        .orders
        .iter()
        .map(|k| {
            let turned = 1.0 - (-0.5 * (*k as f64 * timing).powi(2)).exp();
            let moved = 2.0 * lines[*k].norm_sqr() * turned;
            let noise = of(&observed.lines, *k);
            let scatter = of(predicted, *k).min(noise * shorter);
            let variance = noise + scatter + accuracy + moved;
            // The mean has no imaginary part, and all of its noise is in the real one.
            let parts = if *k == 0 { 1.0 } else { 2.0 };
            (parts / variance).sqrt()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(amplitude: f64, variance: f64, revolutions: usize) -> OrderLines {
        OrderLines {
            amplitude: vec![Complex64::new(amplitude, 0.0); 31],
            variance: vec![variance; 31],
            revolutions,
        }
    }

    fn weights_of(observed: OrderLines, predicted: &OrderLines, timing: f64) -> Vec<f64> {
        let observed = Observed {
            scatter: Vec::new(),
            column: "crosshead_acceleration_m_s2".into(),
            orders: (0..31).collect(),
            lines: observed,
        };
        weights(&observed, predicted, timing)
    }

    #[test]
    fn an_order_that_turns_is_not_trusted() {
        let weights = weights_of(lines(1.0, 1e-4, 30), &lines(1.0, 0.0, 4), 0.1);
        // Order 10 turns by one radian of standard deviation: 2 (1 − e^(−1/2)) = 0.786939.
        let expected = (2.0_f64 / (1e-4 + 0.786939)).sqrt();
        assert!((weights[10] - expected).abs() < 1e-5, "{}", weights[10]);
        assert!((weights[1..]).is_sorted_by(|a, b| a > b));
    }

    #[test]
    fn a_prediction_is_not_forgiven_more_scatter_than_the_recording_has() {
        let weight = |predicted| weights_of(lines(1.0, 1e-4, 30), &lines(1.0, predicted, 24), 0.0);
        let as_recorded = weight(1e-4 * 30.0 / 24.0)[5];
        assert!((as_recorded - (2.0_f64 / 2.25e-4).sqrt()).abs() < 1e-3);
        assert_eq!(weight(1.0)[5], as_recorded);
        assert!(weight(1e-5)[5] > as_recorded);
    }
}
