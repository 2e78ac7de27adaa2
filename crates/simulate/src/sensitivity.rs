//! How a record changes with the machine's parameters: exact derivatives by dual numbers.
//!
//! The motion is integrated once more over dual numbers, whose tangents carry the derivative of
//! every coordinate with respect to every parameter; switches count, because the integrator carries
//! the derivative of their times. After a given number of revolutions they are those of the motion
//! from its start; of a motion that has settled, those of the periodic [`orbit`](crate::orbit). On a
//! chaotic one the derivative grows without bound, and statistics have to be compared by differences
//! instead.

use crate::chain::Sampling;
use crate::orbit::Orbit;
use crate::record::Error;
use crate::run::Run;
use crate::sensor::{Measured, Sensor};
use crate::settings::{Settings, Transient};
use integrate::Real;
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
    /// Steps of the integrator that it took; one with eight tangents counts as seven.
    pub steps: u64,
}

/// Runs `machine` and records `sensors` with the derivatives toward each of `moved`. Of a motion that
/// settles no more is recorded than its period, and a revolution beyond where the crank is free and
/// does not keep to its reference speed. Of one that was to settle and does not there are no
/// derivatives. A motion that takes some 50 times as many steps as a usual one is given up.
///
/// # Errors
/// As [`simulate`](crate::simulate()).
pub fn sensitivities(
    machine: &Machine,
    sensors: &[Sensor],
    moved: &[Moved],
    settings: &Settings,
) -> Result<Sensitivities, Error> {
    if matches!(settings.transient, Transient::Revolutions(_)) {
        return from_start(machine, sensors, moved, settings);
    }
    let mut run = Run::start(lift::constants(machine), settings.tolerance, false);
    run.hurry();
    let (transient, period) = run.leave_transient(settings.transient)?;
    let Some(period) = period else {
        let (recorder, inner) = recorded(&mut run, transient, sensors, settings)?;
        let unsettled = recorder.sensitivities(machine, sensors, &[], &inner, &[])?;
        return Ok(Sensitivities {
            steps: run.steps(),
            ..unsettled
        });
    };
    let orbit = Orbit {
        machine,
        sensors,
        moved,
        settings,
        period,
    };
    let carried = orbit.carried(run)?;
    let (inner, tangents) = (&carried.values, &carried.tangents);
    let recorder = &carried.recorder;
    Ok(Sensitivities {
        settled: true,
        steps: carried.steps,
        ..recorder.sensitivities(machine, sensors, moved, inner, tangents)?
    })
}

/// The derivatives of the motion from its start, eight of them at a time; the last tangents of an
/// incomplete chunk are 0.
fn from_start(
    machine: &Machine,
    sensors: &[Sensor],
    moved: &[Moved],
    settings: &Settings,
) -> Result<Sensitivities, Error> {
    let part = |chunk: &[Moved]| match chunk.len() {
        0 => tangents::<0>(machine, sensors, chunk, settings),
        1 => tangents::<1>(machine, sensors, chunk, settings),
        _ => tangents::<8>(machine, sensors, chunk, settings),
    };
    let mut chunks = moved.chunks(8);
    let mut all = part(chunks.next().unwrap_or_default())?;
    for chunk in chunks {
        let part = part(chunk)?;
        all.derivatives.extend(part.derivatives);
        all.steps += part.steps;
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
    let (recorder, inner) = recorded(&mut run, transient, sensors, settings)?;
    let (values, tangents) = apart(&inner);
    Ok(Sensitivities {
        settled: period.is_some(),
        steps: run.steps(),
        ..recorder.sensitivities(machine, sensors, moved, &values, &tangents)?
    })
}

/// The values of each sensor, and for each direction the tangents of each.
pub(crate) fn apart<const N: usize>(
    inner: &[Vec<Dual<f64, N>>],
) -> (Vec<Vec<f64>>, Vec<Vec<Vec<f64>>>) {
    let part = |of: &dyn Fn(&Dual<f64, N>) -> f64| -> Vec<Vec<f64>> {
        let of_sensor = |x: &Vec<Dual<f64, N>>| x.iter().map(of).collect();
        inner.iter().map(of_sensor).collect()
    };
    let tangents = (0..N).map(|i| part(&|x| x.tangent[i]));
    (part(&|x| x.value), tangents.collect())
}

/// What the sensors measure in the revolutions after a transient.
fn recorded<S: Real>(
    run: &mut Run<S>,
    transient: u32,
    sensors: &[Sensor],
    settings: &Settings,
) -> Result<(Recorder, Vec<Vec<S>>), Error> {
    let start = f64::from(transient) * run.revolution();
    let length = f64::from(settings.revolutions) * run.revolution();
    let sampling = Sampling::for_sensors(sensors, settings, length)?;
    let mut inner = vec![Vec::new(); sensors.len()];
    run.show(sampling.instants(start), |at| {
        for (sensor, inner) in sensors.iter().zip(&mut inner) {
            inner.push(sensor.measured.value(at));
        }
    })?;
    Ok((Recorder { sampling, start }, inner))
}

/// Makes a record of what sensors measure.
pub(crate) struct Recorder {
    /// How it is sampled.
    pub sampling: Sampling,
    /// When it begins, s.
    pub start: f64,
}

impl Recorder {
    fn record(
        &self,
        machine: &Machine,
        sensors: &[Sensor],
        inner: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Error> {
        let of_sensor = |(sensor, inner): (&Sensor, &Vec<f64>)| {
            self.sampling.record(sensor, machine, self.start, inner)
        };
        sensors.iter().zip(inner).map(of_sensor).collect()
    }

    /// The record of these inner samples, and of their `tangents` toward each of `moved`.
    fn sensitivities(
        &self,
        machine: &Machine,
        sensors: &[Sensor],
        moved: &[Moved],
        values: &[Vec<f64>],
        tangents: &[Vec<Vec<f64>>],
    ) -> Result<Sensitivities, Error> {
        let series = self.record(machine, sensors, values)?;
        let linear: Vec<Sensor> = sensors.iter().map(Sensor::without_additions).collect();
        let mut derivatives = Vec::with_capacity(moved.len());
        for (moved, tangents) in moved.iter().zip(tangents) {
            let mut derivative = self.record(machine, &linear, tangents)?;
            // What moves in the chain itself comes on top.
            if moved.sensors != sensors {
                let other = self.record(machine, &moved.sensors, values)?;
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
            settled: false,
            steps: 0,
        })
    }
}
