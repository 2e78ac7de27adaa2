//! Values of an effect that recordings show by themselves, without a model.

use crate::pressures::is_pressure;
use calibrate::Problem;
use calibrate::observation::{Observation, Observed};
use input::effects::Entry;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Lowest order, in cycles a revolution, that is no part of the stroke's own indicator diagram.
const RIPPLE: usize = 12;

/// What the recordings show of this effect, as values (SI) of its parameters; none where they show nothing.
pub(crate) fn recorded_values(entry: &Entry, problem: &Problem) -> Option<Vec<f64>> {
    match entry.name {
        "speed_fluctuation" => fluctuation(problem),
        "valve_flutter" => {
            let usual = entry.parameters.iter().map(|p| match p.key {
                "frequency" => ripple(problem).map(|f| f.clamp(p.bounds[0], p.bounds[1])),
                _ => Some(p.start),
            });
            usual.collect()
        }
        _ => None,
    }
}

/// The fluctuation of the speed that the encoders show, as values of the effect: amplitude and phase
/// of the first and the second harmonic, as means over the runs.
fn fluctuation(problem: &Problem) -> Option<Vec<f64>> {
    let harmonic = |k: usize| {
        let recorded = problem.runs.iter().filter_map(|run| {
            let harmonic = run.crank.fluctuation.get(k)?;
            Some(Complex::from_polar(harmonic.amplitude, harmonic.phase))
        });
        let recorded: Vec<Complex<f64>> = recorded.collect();
        let mean = recorded.iter().sum::<Complex<f64>>() / recorded.len() as f64;
        (!recorded.is_empty()).then(|| [mean.norm(), mean.arg()])
    };
    Some([harmonic(0)?, harmonic(1)?].concat())
}

/// Frequency of the strongest ripple of the cylinders' pressures, Hz: the line above the orders of the
/// indicator diagram, whose kinks fall off by the square of the order, that stands out the most.
fn ripple(problem: &Problem) -> Option<f64> {
    let of_channel = |(run, channel): (&Observation, &Observed)| {
        let orders = channel.orders.iter().copied().filter(|k| *k >= RIPPLE);
        let height = |k: usize| channel.lines.amplitude[k].norm() * k as f64;
        let strongest = orders.max_by(|a, b| height(*a).total_cmp(&height(*b)))?;
        let share = height(strongest) / channel.lines.amplitude[1].norm();
        Some((share, strongest as f64 * run.crank.speed.abs() / TAU))
    };
    let channels = problem.runs.iter().flat_map(|run| {
        let pressures = run.channels.iter().filter(|channel| is_pressure(channel));
        pressures.map(move |channel| (run, channel))
    });
    let ripples = channels.filter_map(of_channel);
    ripples
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, frequency)| frequency)
}
