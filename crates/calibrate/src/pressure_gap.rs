//! How far the fitted gas is from the measured pressures, and where in the cycle.
//!
//! The measure is the root mean square, over the samples of a run's first revolution, of simulated
//! less measured pressure, in Pa. It needs no estimate of the noise, and compares models that were fitted in
//! different ways. What a model cannot follow stands far above the noise here.

use crate::error::Error;
use crate::indicator::{Chamber, Indicator};
use crate::observation::Run;
use crate::prediction::predict;
use crate::problem::Problem;
use mechanism::Machine;
use signal::order_lines::OrderLines;
use std::f64::consts::TAU;

/// A pressure of a run beside the simulated one, over one revolution.
#[derive(Clone, Debug)]
pub struct PressureGap {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub column: String,
    /// Crank angle of each sample, as the machine has it: the offset of the recorded one is taken
    /// off. rad in [0, 2π).
    pub angles: Vec<f64>,
    /// The pressure as recorded, Pa.
    pub measured: Vec<f64>,
    /// The pressure simulated with the nominal parameters, Pa.
    pub nominal: Vec<f64>,
    /// The pressure simulated with the fitted parameters, Pa.
    pub fitted: Vec<f64>,
    /// The indicator diagram of the recording, at the nominal clearance; `None` where it shows no cycle.
    pub indicator: Option<Indicator>,
    /// The same of the fitted pressure, at the fitted clearance.
    pub fitted_indicator: Option<Indicator>,
}

/// A part of the cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// `expansion`, `suction`, `compression` or `discharge`.
    pub name: &'static str,
    /// Where it begins and ends, by the effective events of the measured pressure, rad.
    pub angles: [f64; 2],
    /// Root mean square of fitted less measured pressure in it, Pa.
    pub rms: f64,
    /// Its share of the squared differences of the revolution.
    pub share: f64,
}

impl PressureGap {
    /// Root mean square of simulated less measured pressure, Pa: with the nominal and with the
    /// fitted parameters.
    pub fn rms(&self) -> [f64; 2] {
        [&self.nominal, &self.fitted].map(|simulated| {
            let squares = self.squares(simulated);
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        })
    }

    /// The parts of the cycle, from the chamber's dead centre on; none where it shows no cycle.
    pub fn phases(&self) -> Vec<Phase> {
        let Some(indicator) = &self.indicator else {
            return Vec::new();
        };
        let squares = self.squares(&self.fitted);
        let whole: f64 = squares.iter().sum();
        let events = &indicator.events;
        let [opens, closes] = [events.suction_opens.angle, events.suction_closes.angle];
        let [raised, ended] = [events.discharge_opens.angle, events.discharge_closes.angle];
        let parts = [
            ("expansion", [ended, opens]),
            ("suction", [opens, closes]),
            ("compression", [closes, raised]),
            ("discharge", [raised, ended]),
        ];
        let phase = |(name, [from, to]): (&'static str, [f64; 2])| {
            let length = (to - from).rem_euclid(TAU);
            let inside = |angle: f64| (angle - from).rem_euclid(TAU) < length;
            let own: Vec<f64> = self
                .angles
                .iter()
                .zip(&squares)
                .filter(|(angle, _)| inside(**angle))
                .map(|(_, square)| *square)
                .collect();
            let sum: f64 = own.iter().sum();
            Phase {
                name,
                angles: [from, to],
                rms: (sum / own.len().max(1) as f64).sqrt(),
                share: sum / whole,
            }
        };
        parts.map(phase).into()
    }

    fn squares(&self, simulated: &[f64]) -> Vec<f64> {
        let both = simulated.iter().zip(&self.measured);
        both.map(|(a, b)| (a - b).powi(2)).collect()
    }
}

/// The cylinder pressures of the recorded runs beside those of the problem's machine, with the
/// parameters at the coordinates `x`. A run without a crank angle has none.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn pressure_gaps(
    problem: &Problem,
    recorded: &[Run],
    x: &[f64],
) -> Result<Vec<PressureGap>, Error> {
    let nominal = vec![0.0; x.len()];
    pressure_gaps_of([(problem, &nominal), (problem, x)], recorded)
}

/// The same of two models, each a problem with coordinates: what is called nominal is the first one's.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn pressure_gaps_of(
    models: [(&Problem, &[f64]); 2],
    recorded: &[Run],
) -> Result<Vec<PressureGap>, Error> {
    let [(first, zero), (problem, x)] = models;
    let mut gaps = Vec::new();
    for run in &problem.runs {
        let recorded = recorded.iter().find(|recorded| recorded.id == run.id);
        let Some(recorded) = recorded else { continue };
        let nominal = first.machine(run, zero)?.machine;
        let of_chamber = |column: &str| Chamber::of_column(&nominal, column).is_some();
        let pressures = run.channels.iter().enumerate();
        let pressures: Vec<(usize, &str)> = pressures
            .map(|(i, channel)| (i, channel.column.as_str()))
            .filter(|(_, column)| of_chamber(column))
            .collect();
        let Some(angles) = recorded
            .first_revolution()
            .filter(|_| !pressures.is_empty())
        else {
            continue;
        };
        let before = predict(first, run, zero)?;
        let after = predict(problem, run, x)?;
        let fitted = problem.machine(run, x)?.machine;
        let offset = problem.crank_angle_offset(run, x).0;
        for (i, column) in pressures {
            let Some(channel) = recorded.channels.iter().find(|c| c.column == column) else {
                continue;
            };
            let gap = PressureGap {
                run: run.id.clone(),
                column: column.to_owned(),
                angles: angles
                    .iter()
                    .map(|a| (a - offset).rem_euclid(TAU))
                    .collect(),
                measured: channel.samples[..angles.len()].to_vec(),
                nominal: waveform(&before.lines[i], angles),
                fitted: waveform(&after.lines[i], angles),
                indicator: None,
                fitted_indicator: None,
            };
            let diagram = |machine: &Machine, pressure: &[f64]| {
                let chamber = Chamber::of_column(machine, column)?;
                Indicator::from_pressure(chamber, &gap.angles, pressure)
            };
            gaps.push(PressureGap {
                indicator: diagram(&nominal, &gap.measured),
                fitted_indicator: diagram(&fitted, &gap.fitted),
                ..gap
            });
        }
    }
    Ok(gaps)
}

/// What lines amount to at crank angles.
fn waveform(lines: &OrderLines, angles: &[f64]) -> Vec<f64> {
    let at = |angle: &f64| -> f64 {
        let orders = lines.amplitude.iter().enumerate();
        orders
            .map(|(k, c)| {
                let (sine, cosine) = (k as f64 * angle).sin_cos();
                c.re * cosine - c.im * sine
            })
            .sum()
    };
    angles.iter().map(at).collect()
}
