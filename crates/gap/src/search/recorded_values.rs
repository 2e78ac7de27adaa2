//! Values of an effect that recordings show by themselves, without a model.

use crate::recorded::is_pressure;
use calibrate::Problem;
use calibrate::observation::{Observation, Observed};
use input::effects::{Entry, Kind, Parameter, Proposal};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Lowest order, in cycles a revolution, that is no part of the stroke's own indicator diagram.
const RIPPLE: usize = 12;

/// What the recordings show of this effect, as values (SI) of its parameters; none where they show nothing.
pub(crate) fn recorded_values(entry: &Entry, problem: &Problem) -> Option<Vec<f64>> {
    if entry.proposal == Proposal::CrankSpeed {
        return fluctuation(problem);
    }
    let is_frequency = |p: &Parameter| p.unit == "Hz";
    if entry.kind != Kind::Gas || !entry.parameters.iter().any(is_frequency) {
        return None;
    }
    let values = entry.parameters.iter().map(|p| match is_frequency(p) {
        true => ripple(problem).map(|f| f.clamp(p.bounds[0], p.bounds[1])),
        false => Some(p.start),
    });
    values.collect()
}

/// The fluctuation of the speed that the encoders show, as values of the effect. They are amplitude and phase
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

/// Frequency of the strongest ripple of the cylinders' pressures, Hz. It is the line above the orders of the
/// indicator diagram that stands out the most. The kinks of the diagram fall off by the square of the order.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use input::effects::entry;

    #[test]
    fn a_ripple_of_the_pressure_has_its_frequency() {
        let flutter = entry("valve_flutter").unwrap();
        let mut problem = problem();
        assert_eq!(recorded_values(flutter, &problem), None);
        let run = &mut problem.runs[0];
        let mut pressure = run.channels[0].clone();
        pressure.column = "cylinder_pressure_pa".into();
        for (k, amplitude) in pressure.lines.amplitude.iter_mut().enumerate() {
            let height = 1e5 / (1 + k * k) as f64;
            *amplitude = Complex::new(if k == 30 { 2.0 * height } else { height }, 0.0);
        }
        for weak in [false, true] {
            let mut pressure = pressure.clone();
            if weak {
                pressure.lines.amplitude[30] *= 10.0;
            }
            problem.runs[0].channels.push(pressure);
        }
        let values = recorded_values(flutter, &problem).unwrap();
        let frequency = flutter.parameters.iter().position(|p| p.key == "frequency");
        let found = values[frequency.unwrap()];
        assert!((found - 30.0 * 400.0 / 60.0).abs() < 1e-9, "{found}");
    }
}
