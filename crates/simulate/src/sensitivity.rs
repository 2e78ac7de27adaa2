//! How a record changes with the machine's parameters: exact derivatives by dual numbers.
//!
//! The motion is integrated once more over dual numbers, whose tangents carry the derivative of
//! every coordinate with respect to every parameter; switches count, because the integrator carries
//! the derivative of their times. On a periodic motion the derivative settles with the motion. On a
//! chaotic one it grows without bound, and statistics have to be compared by differences instead.

use crate::chain::Sampling;
use crate::record::Error;
use crate::run::Run;
use crate::sensor::{Measured, Sensor};
use crate::settings::Settings;
use mechanism::{Machine, lift};
use scalar::Dual;
use std::f64::consts::TAU;

/// A machine and its sensors with one parameter moved by one unit.
///
/// What is derived is the straight line from the machine to this one: the moved machine must have
/// the same build (laws, throws, joints clear or ideal).
#[derive(Clone, Debug)]
pub struct Moved {
    /// The machine.
    pub machine: Machine,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
}

/// What the sensors see before noise, and its derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivities {
    /// One series per sensor, SI.
    pub series: Vec<Vec<f64>>,
    /// For each parameter one series per sensor: change per unit of the parameter.
    pub derivatives: Vec<Vec<Vec<f64>>>,
    /// True where the transient was found to have settled.
    pub settled: bool,
}

/// Runs `machine` and records `sensors` with the derivatives toward each of `moved`. Of a motion that
/// settles no more is recorded than its period, and a revolution beyond where the crank is free and
/// does not keep to its reference speed. A motion that takes some 50 times as many steps as a usual one
/// is given up.
///
/// # Errors
/// As [`simulate`](crate::simulate()).
pub fn sensitivities(
    machine: &Machine,
    sensors: &[Sensor],
    moved: &[Moved],
    settings: &Settings,
) -> Result<Sensitivities, Error> {
    // Eight tangents at a time; the last tangents of an incomplete chunk are 0.
    let part = |chunk: &[Moved]| match chunk.len() {
        0 => tangents::<0>(machine, sensors, chunk, settings),
        1 => tangents::<1>(machine, sensors, chunk, settings),
        2 => tangents::<2>(machine, sensors, chunk, settings),
        3 | 4 => tangents::<4>(machine, sensors, chunk, settings),
        _ => tangents::<8>(machine, sensors, chunk, settings),
    };
    let mut chunks = moved.chunks(8);
    let mut all = part(chunks.next().unwrap_or_default())?;
    for chunk in chunks {
        all.derivatives.extend(part(chunk)?.derivatives);
    }
    Ok(all)
}

fn tangents<const N: usize>(
    machine: &Machine,
    sensors: &[Sensor],
    moved: &[Moved],
    settings: &Settings,
) -> Result<Sensitivities, Error> {
    let towards = std::array::from_fn(|i| moved.get(i).map_or(machine, |moved| &moved.machine));
    let lifted = lift::gradient::<N, Machine>(machine, towards);
    let mut run = Run::<Dual<f64, N>>::start(lifted, settings.tolerance, false);
    run.hurry();
    let (transient, period) = run.leave_transient(settings.transient)?;
    let start = f64::from(transient) * run.revolution();
    let spare = u32::from(run.is_free());
    let enough = period.map_or(settings.revolutions, |period| period + spare);
    let revolutions = settings.revolutions.min(enough);
    let length = f64::from(revolutions) * run.revolution();
    let sampling = Sampling::for_sensors(sensors, settings, length)?;
    let mut inner: Vec<Vec<Dual<f64, N>>> = vec![Vec::new(); sensors.len()];
    run.show(sampling.instants(start), |at| {
        for (sensor, inner) in sensors.iter().zip(&mut inner) {
            inner.push(sensor.measured.value(at));
        }
    })?;
    let values: Vec<Vec<f64>> = inner
        .iter()
        .map(|x| x.iter().map(|x| x.value).collect())
        .collect();
    let record = |sensors: &[Sensor], inner: &[Vec<f64>]| {
        sensors
            .iter()
            .zip(inner)
            .map(|(sensor, inner)| sampling.record(sensor, machine, start, inner))
            .collect::<Result<Vec<_>, _>>()
    };
    let series = record(sensors, &values)?;
    let linear: Vec<Sensor> = sensors.iter().map(Sensor::without_additions).collect();
    let mut derivatives = Vec::with_capacity(moved.len());
    for (i, moved) in moved.iter().enumerate() {
        let tangents: Vec<Vec<f64>> = inner
            .iter()
            .map(|x| x.iter().map(|x| x.tangent[i]).collect())
            .collect();
        let mut derivative = record(&linear, &tangents)?;
        // What moves in the chain itself comes on top.
        if moved.sensors != sensors {
            let other = record(&moved.sensors, &values)?;
            let parts = derivative.iter_mut().zip(&other).zip(&series);
            for (((d, other), series), sensor) in parts.zip(sensors) {
                let turn = match sensor.measured {
                    Measured::CrankAngle => TAU,
                    _ => f64::INFINITY,
                };
                // An angle that passes a whole turn jumps back.
                let change = |a: f64, b: f64| a - b - ((a - b) / turn).round() * TAU;
                let changes = other.iter().zip(series).map(|(a, b)| change(*a, *b));
                d.iter_mut()
                    .zip(changes)
                    .for_each(|(d, change)| *d += change);
            }
        }
        derivatives.push(derivative);
    }
    Ok(Sensitivities {
        series,
        derivatives,
        settled: period.is_some(),
    })
}
