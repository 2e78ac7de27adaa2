//! Records of what sensors measure, and of its derivatives.

use crate::chain::Sampling;
use crate::error::Error;
use crate::moved::Moved;
use crate::sensor::Sensor;
use mechanism::Machine;
use scalar::Dual;
use std::f64::consts::TAU;

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

/// Makes a record of what sensors measure.
pub(crate) struct Recorder {
    /// How it is sampled.
    pub sampling: Sampling,
    /// When it begins, s.
    pub start: f64,
}

impl Recorder {
    /// What the sensors make of these inner samples.
    pub(crate) fn record(
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
    pub(crate) fn sensitivities(
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
                    let turn = match sensor.measured.is_angle() {
                        true => TAU,
                        false => f64::INFINITY,
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
