//! Measured beside simulated, before and after: what a picture of a calibration shows.

use crate::error::Error;
use crate::few_revolutions;
use crate::likelihood::{Likelihood, residuals};
use crate::observation::{self, Observation, Observed, POINTS, Run};
use crate::prediction::Prediction;
use crate::problem::Problem;
use signal::Complex64;
use signal::angle_resampling::AngleGrid;
use signal::order_lines::OrderLines;
use std::f64::consts::TAU;

/// A channel of a run, measured and simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The run.
    pub run: String,
    /// Name of the channel's column.
    pub column: String,
    /// Synchronous means at equal steps of the crank angle from 0 on. That of an acceleration is
    /// without its mean over the revolution, which is its sensor's.
    pub means: Vec<Means>,
    /// The compared orders.
    pub orders: Vec<OrderResidual>,
}

/// What stands at a crank angle, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Mean of the measured revolutions.
    pub measured: f64,
    /// Standard deviation from revolution to revolution; 0 where there are too few.
    pub scatter: f64,
    /// Standard deviation of the measured mean.
    pub noise: f64,
    /// Mean of the simulation with the nominal parameters.
    pub before: f64,
    /// With the calibrated ones.
    pub after: f64,
}

/// How far the simulation is from an order's amplitude, in standard deviations of its noise: the
/// root mean square of real and imaginary part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderResidual {
    /// The order.
    pub order: usize,
    /// With the nominal parameters.
    pub before: f64,
    /// With the calibrated ones.
    pub after: f64,
}

/// Compares the problem's runs with the nominal parameters and with those at the coordinates `x`.
/// `recordings` holds the runs that the problem's observations are of, in any order.
///
/// # Errors
/// A run that cannot be simulated.
pub fn compare(problem: &Problem, recordings: &[Run], x: &[f64]) -> Result<Vec<Comparison>, Error> {
    let nominal = vec![0.0; x.len()];
    compare_models([(problem, &nominal), (problem, x)], recordings)
}

/// Compares the runs with two models of them, each a problem with coordinates.
///
/// # Errors
/// A run that cannot be simulated.
pub fn compare_models(
    models: [(&Problem, &[f64]); 2],
    recordings: &[Run],
) -> Result<Vec<Comparison>, Error> {
    let [before, after] = models.map(|(problem, x)| Likelihood::new(problem).predictions(x));
    let (before, after) = (before?, after?);
    let mut comparisons = Vec::new();
    for (run, (before, after)) in models[1].0.runs.iter().zip(before.iter().zip(&after)) {
        let recording = recordings.iter().find(|recording| recording.id == run.id);
        for (i, channel) in run.channels.iter().enumerate() {
            let scatter = match recording {
                Some(recording) => scatter(recording, channel)?,
                None => None,
            };
            comparisons.push(of_channel(
                run,
                channel,
                scatter.as_deref(),
                [before, after],
                i,
            ));
        }
    }
    Ok(comparisons)
}

/// The synchronous mean of a channel as it is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedMean {
    /// The run.
    pub run: String,
    /// Name of the channel's column.
    pub column: String,
    /// Means at equal steps of the crank angle from 0 on, as [`Comparison::means`] has them.
    pub means: Vec<f64>,
}

/// The means of all channels of a problem's runs at the coordinates `x`.
///
/// # Errors
/// A run that cannot be simulated.
pub fn simulated_means(problem: &Problem, x: &[f64]) -> Result<Vec<SimulatedMean>, Error> {
    let predictions = Likelihood::new(problem).predictions(x)?;
    let runs = problem.runs.iter().zip(&predictions);
    let means = runs.flat_map(|(run, prediction)| {
        let channels = run.channels.iter().zip(&prediction.lines);
        channels.map(|(channel, lines)| SimulatedMean {
            run: run.id.clone(),
            column: channel.column.clone(),
            means: wave(lines, channel.quantity().has_mean()),
        })
    });
    Ok(means.collect())
}

fn of_channel(
    run: &Observation,
    channel: &Observed,
    scatter: Option<&[f64]>,
    predictions: [&Prediction; 2],
    index: usize,
) -> Comparison {
    let alone = Observation {
        channels: vec![channel.clone()],
        ..run.clone()
    };
    let has_mean = channel.quantity().has_mean();
    let measured = wave(&channel.lines, has_mean);
    let root = (channel.lines.revolutions as f64).sqrt();
    // Where revolutions cannot be compared, the noise of the orders stands for all angles alike.
    let variance = channel.lines.variance.iter().skip(1).sum::<f64>() / 2.0;
    let scatter_at = |i: usize| scatter.map_or(0.0, |scatter| scatter[i]);
    let noise_at = |i: usize| scatter.map_or(variance.sqrt(), |scatter| scatter[i] / root);
    let [before, after] = predictions.map(|prediction| {
        let lines = prediction.lines[index].clone();
        let wave = wave(&lines, has_mean);
        let prediction = Prediction::new(vec![lines], prediction.periodic);
        (wave, residuals(&alone, &prediction, 0.0))
    });
    let of_order = |(i, order): (usize, &usize)| {
        let size = |residuals: &[f64]| {
            // Order 0 has no imaginary part.
            let parts = if *order == 0 { 1.0 } else { 2.0_f64 };
            residuals[2 * i].hypot(residuals[2 * i + 1]) / parts.sqrt()
        };
        OrderResidual {
            order: *order,
            before: size(&before.1),
            after: size(&after.1),
        }
    };
    Comparison {
        run: run.id.clone(),
        column: channel.column.clone(),
        means: (0..POINTS)
            .map(|i| Means {
                measured: measured[i],
                scatter: scatter_at(i),
                noise: noise_at(i),
                before: before.0[i],
                after: after.0[i],
            })
            .collect(),
        orders: channel.orders.iter().enumerate().map(of_order).collect(),
    }
}

/// The synchronous mean of these lines, at [`POINTS`] crank angles.
fn wave(lines: &OrderLines, has_mean: bool) -> Vec<f64> {
    let first = usize::from(!has_mean);
    let at = |i: usize| {
        let turn = Complex64::cis(TAU * i as f64 / POINTS as f64);
        let amplitudes = lines.amplitude.iter().skip(first).rev();
        // Horner's rule in e^(iθ).
        let sum = amplitudes.fold(Complex64::ZERO, |sum, c| sum * turn + c);
        (sum * turn.powu(first as u32)).re
    };
    (0..POINTS).map(at).collect()
}

/// Standard deviation from revolution to revolution at [`POINTS`] crank angles; none where there are
/// too few.
fn scatter(run: &Run, channel: &Observed) -> Result<Option<Vec<f64>>, Error> {
    let error = |source| Error::Signal {
        run: run.id.clone(),
        channel: channel.column.clone(),
        source,
    };
    let recorded = run.channels.iter().find(|c| c.column == channel.column);
    let Some(recorded) = recorded else {
        return Ok(None);
    };
    let angle = observation::angle(run, recorded)?;
    if few_revolutions::is_short(&angle) {
        return Ok(None);
    }
    let grid = AngleGrid::new(&angle, POINTS).map_err(error)?;
    let revolutions = grid.resample(&recorded.samples).map_err(error)?;
    let mean = revolutions.synchronous_mean();
    let start = (revolutions.start_angle() / TAU * POINTS as f64).round() as usize;
    let mut squares = vec![0.0; POINTS];
    for revolution in revolutions.iter() {
        for (j, x) in revolution.iter().enumerate() {
            let at = (start + j) % POINTS;
            squares[at] += (x - mean[at]).powi(2);
        }
    }
    let free = revolutions.count().saturating_sub(1).max(1) as f64;
    let scatter = squares.into_iter().map(|sum| (sum / free).sqrt());
    Ok(Some(scatter.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_the_sum_of_their_lines() {
        let mut amplitude = vec![Complex64::ZERO; 40];
        amplitude[0] = Complex64::new(2.0, 0.0);
        amplitude[3] = Complex64::from_polar(1.5, 0.4);
        amplitude[31] = Complex64::new(0.0, 0.2);
        let lines = OrderLines {
            variance: vec![0.0; 40],
            amplitude,
            revolutions: 3,
        };
        for (has_mean, mean) in [(true, 2.0), (false, 0.0)] {
            for (i, x) in wave(&lines, has_mean).iter().enumerate() {
                let angle = TAU * i as f64 / POINTS as f64;
                let expected = mean + 1.5 * (3.0 * angle + 0.4).cos() - 0.2 * (31.0 * angle).sin();
                assert!((x - expected).abs() < 1e-10, "{i}: {x} {expected}");
            }
        }
    }
}
