//! How far the envelopes of a prediction are from those of an observation, at any phase.
//!
//! The lines of an octave of orders are an analytic signal a(θ) = Σ c_k e^(ikθ). Its magnitude is
//! the envelope of the motion in this band (Gabor 1946). It shows when the machine rings, how loud,
//! in which octave and how long. It does not turn with the phase of the ringing: where lines have
//! many local minima, envelopes have few. Their logarithms are compared.

use crate::error::Error;
use crate::likelihood::FAILED;
use crate::observation::{Observation, Observed};
use crate::optimiser::LeastSquares;
use crate::prediction::{Accuracy, Prediction, predictions, to_a_thread, with_derivatives};
use crate::problem::Problem;
use nalgebra::DMatrix;
use rayon::prelude::*;
use signal::Complex64;
use std::f64::consts::TAU;

/// The first order of the lowest octave.
const LOWEST: usize = 5;
/// Energy over the mean of its band under which an envelope is as good as none.
const FLOOR: f64 = 0.05;

/// The differences of the logarithms of envelopes as residuals.
pub(crate) struct Envelopes<'a> {
    problem: &'a Problem,
}

impl<'a> Envelopes<'a> {
    pub(crate) fn new(problem: &'a Problem) -> Self {
        Self { problem }
    }

    /// Residuals of a run of `count` coordinates and what derivatives its prediction has: rows of at most `1 + count` values.
    fn of_run(
        run: &Observation,
        predicted: &Result<Prediction, Error>,
        count: usize,
    ) -> Vec<Vec<f64>> {
        let mut rows = Vec::with_capacity(residual_count(run));
        for (i, observed) in run.channels.iter().enumerate() {
            for octave in octaves(observed) {
                let Ok(predicted) = predicted else {
                    rows.extend(octave.angles().map(|_| vec![FAILED; 1 + count]));
                    continue;
                };
                let seen = &observed.lines.amplitude;
                let floor = octave.floor(observed);
                for angle in octave.angles() {
                    let energy = octave.at(seen, angle).norm_sqr() + floor;
                    let now = octave.at(&predicted.lines[i].amplitude, angle);
                    let own = now.norm_sqr() + floor;
                    let mut row = vec![0.5 * (own / energy).ln()];
                    row.extend(predicted.derivatives.iter().map(|of_parameter| {
                        let slope = octave.at(&of_parameter[i], angle);
                        (now.conj() * slope).re / own
                    }));
                    rows.push(row);
                }
            }
        }
        rows
    }
}

impl LeastSquares for Envelopes<'_> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        let parameters = self.problem.parameters.iter();
        parameters.map(|p| p.box_bounds()).collect()
    }

    fn count(&self) -> usize {
        self.problem.runs.iter().map(residual_count).sum()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.problem.once(&"envelopes", x, || {
            let runs = &self.problem.runs;
            let runs = runs.par_chunks(to_a_thread(runs.len()));
            let parts = runs.flat_map_iter(|runs| {
                let wanted: Vec<_> = runs.iter().map(|run| (run, x)).collect();
                let predicted = predictions(self.problem, &wanted, Accuracy::Coarse);
                let runs = runs.iter().zip(predicted);
                runs.map(|(run, predicted)| Self::of_run(run, &predicted, x.len()))
            });
            let parts: Vec<Vec<Vec<f64>>> = parts.collect();
            parts.concat().iter().map(|row| row[0]).collect()
        })
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let columns = || self.evaluated_jacobian(x).as_slice().to_vec();
        let values = self.problem.once(&"slopes of envelopes", x, columns);
        DMatrix::from_vec(self.count(), x.len(), values)
    }
}

impl Envelopes<'_> {
    fn evaluated_jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let runs = self.problem.runs.par_iter();
        let parts = runs.map(|run| {
            let predicted = with_derivatives(self.problem, run, x, Accuracy::Coarse);
            Self::of_run(run, &predicted, x.len())
        });
        let parts: Vec<Vec<Vec<f64>>> = parts.collect();
        let rows = parts.concat();
        // A run that fails, or does not repeat itself, has no derivatives.
        let slope = |i: usize, j: usize| match rows[i].get(1 + j) {
            Some(slope) if rows[i][0] < FAILED => *slope,
            _ => 0.0,
        };
        DMatrix::from_fn(rows.len(), x.len(), slope)
    }
}

/// The orders from `first` up to twice that.
struct Octave {
    first: usize,
}

impl Octave {
    /// As many angles as the envelope can resolve, and twice that.
    fn angles(&self) -> impl Iterator<Item = f64> {
        let count = 2 * self.first;
        (0..count).map(move |j| TAU * j as f64 / count as f64)
    }

    fn at(&self, amplitude: &[Complex64], angle: f64) -> Complex64 {
        let turn = Complex64::from_polar(1.0, angle);
        let end = (2 * self.first).min(amplitude.len());
        let lines = amplitude.get(self.first..end).unwrap_or_default();
        let sum = lines
            .iter()
            .rev()
            .fold(Complex64::ZERO, |sum, c| sum * turn + c);
        sum * Complex64::from_polar(1.0, self.first as f64 * angle)
    }

    /// The noise's energy, and a share of the signal's.
    fn floor(&self, observed: &Observed) -> f64 {
        let lines = &observed.lines;
        let orders = self.first..(2 * self.first).min(lines.amplitude.len());
        let energy = |k: usize| FLOOR * lines.amplitude[k].norm_sqr() + lines.variance[k];
        orders.map(energy).sum::<f64>().max(f64::MIN_POSITIVE)
    }
}

fn octaves(observed: &Observed) -> impl Iterator<Item = Octave> {
    let last = observed.orders.last().copied().unwrap_or(0);
    std::iter::successors(Some(LOWEST), |first| Some(2 * first))
        .take_while(move |first| 2 * first <= last)
        .map(|first| Octave { first })
}

fn residual_count(run: &Observation) -> usize {
    let channels = run.channels.iter();
    channels
        .flat_map(octaves)
        .map(|octave| 2 * octave.first)
        .sum()
}
