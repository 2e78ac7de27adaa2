//! The measuring chain up to the recorder: filters at the inner rate, then decimation.

use crate::record::Error;
use crate::sensor::{Axis, ChamberEnd, Measured, Sensor};
use crate::settings::Settings;
use integrate::Real;
use mechanism::{Evaluation, Machine};
use scalar::Scalar;
use signal::biquad::Filter;
use signal::decimate::Decimator;
use std::f64::consts::TAU;

use crate::run::Instants;

/// Fewest inner samples per recorded one.
const LEAST_FACTOR: f64 = 4.0;
/// Most inner samples per recorded one: a slow recording still sees the contacts.
const MOST_FACTOR: f64 = 4096.0;

/// How a record is sampled: more finely first, then decimated.
pub(crate) struct Sampling {
    decimator: Decimator,
    /// Inner samples per recorded one.
    pub factor: usize,
    /// Samples per second before decimation.
    pub inner_rate: f64,
    /// Recorded samples.
    pub samples: usize,
}

impl Sampling {
    /// `length` seconds as `settings` say.
    pub(crate) fn new(settings: &Settings, length: f64) -> Result<Self, Error> {
        let rate = settings.sample_rate;
        let factor = (settings.inner_rate / rate).clamp(LEAST_FACTOR, MOST_FACTOR);
        Self::by(factor.ceil(), rate, length)
    }

    /// The same for these sensors: contacts hardly move the gas, so that pressures by themselves need
    /// no look at the ringing. Their kinks fall off with the square of the order.
    pub(crate) fn for_sensors(
        sensors: &[Sensor],
        settings: &Settings,
        length: f64,
    ) -> Result<Self, Error> {
        match sensors.iter().all(Sensor::is_of_gas) {
            true => Self::by(1.0, settings.sample_rate, length),
            false => Self::new(settings, length),
        }
    }

    fn by(factor: f64, rate: f64, length: f64) -> Result<Self, Error> {
        let decimator = Decimator::new(factor as usize).map_err(|source| Error::Sensor {
            column: "all".into(),
            source,
        })?;
        Ok(Self {
            decimator,
            factor: factor as usize,
            inner_rate: rate * factor,
            // A sample that falls on the end of the last revolution belongs to the next.
            samples: (length * rate - 1e-9).ceil().max(1.0) as usize,
        })
    }

    /// Inner samples before the first recorded one.
    pub(crate) fn lead(&self) -> usize {
        self.decimator.half_length()
    }

    /// The inner samples of a record that begins at `start`, s.
    pub(crate) fn instants(&self, start: f64) -> Instants {
        Instants {
            first: start - self.lead() as f64 / self.inner_rate,
            rate: self.inner_rate,
            count: self.decimator.input_length(self.samples),
        }
    }

    /// How many inner samples a motion that repeats itself after the `length` of the record has in it,
    /// where they are a whole number.
    pub(crate) fn cycle(&self, length: f64) -> Option<usize> {
        let count = length * self.inner_rate;
        let whole = (count - count.round()).abs() < 1e-6;
        let count = count.round() as usize;
        (whole && count == self.samples * self.factor).then_some(count)
    }

    /// The inner samples of a record from those of one cycle of it, whose first is number `first` of
    /// the record itself.
    pub(crate) fn repeated(&self, cycle: &[f64], first: usize) -> Vec<f64> {
        let count = cycle.len();
        let before = (first + self.lead()).div_ceil(count) * count - first - self.lead();
        let samples = 0..self.decimator.input_length(self.samples);
        samples.map(|i| cycle[(i + before) % count]).collect()
    }

    /// What `sensor` makes of the inner samples of its quantity in a record that begins at `start`,
    /// s: filtered, amplified, decimated, with the hum of the mains.
    pub(crate) fn record(
        &self,
        sensor: &Sensor,
        machine: &Machine,
        start: f64,
        inner: &[f64],
    ) -> Result<Vec<f64>, Error> {
        // An angle has a jump a revolution, which no filter must touch.
        if sensor.measured == Measured::CrankAngle {
            let recorded = inner[self.lead()..].iter().step_by(self.factor);
            let offset = sensor.chain.angle_offset;
            return Ok(recorded
                .take(self.samples)
                .map(|x| shifted(*x, offset))
                .collect());
        }
        let mut filters = filters(sensor, self.inner_rate).map_err(|source| {
            let names: Vec<&str> = machine.throws.iter().map(|t| t.name.as_str()).collect();
            Error::Sensor {
                column: sensor.measured.column(&names),
                source,
            }
        })?;
        let gain = sensor.chain.gain;
        if let Some(first) = inner.first() {
            filters.iter_mut().for_each(|f| f.settle(first * gain));
        }
        let filtered: Vec<f64> = inner
            .iter()
            .map(|x| filters.iter_mut().fold(x * gain, |x, f| f.run(x)))
            .collect();
        let mut recorded = self.decimator.apply(&filtered);
        if let Some(hum) = sensor.chain.hum {
            let rate = self.inner_rate / self.factor as f64;
            for (i, x) in recorded.iter_mut().enumerate() {
                let time = start + i as f64 / rate;
                let (_, cosine) = Scalar::sin_cos(TAU * hum.frequency * time + hum.phase);
                *x += hum.amplitude * cosine;
            }
        }
        Ok(recorded)
    }
}

/// An angle from 0 to one turn, turned on by `offset`.
fn shifted(angle: f64, offset: f64) -> f64 {
    match offset {
        0.0 => angle,
        offset => (angle + offset).rem_euclid(TAU),
    }
}

fn filters(sensor: &Sensor, rate: f64) -> Result<Vec<Filter>, signal::Error> {
    let chain = &sensor.chain;
    let mut filters = Vec::new();
    if let Some(mounting) = chain.mounting {
        filters.push(Filter::resonance(
            mounting.frequency,
            mounting.damping_ratio,
            rate,
        )?);
    }
    if let Some(low_pass) = chain.low_pass {
        filters.push(Filter::butterworth_low_pass(
            low_pass.order,
            low_pass.cutoff,
            rate,
        )?);
    }
    Ok(filters)
}

impl Measured {
    /// The quantity at an instant, SI.
    pub fn value<S: Real>(&self, at: &Evaluation<S>) -> S {
        self.wrapped(self.unwrapped(at))
    }

    /// What is shown of an angle that grows without end: where it stands in its turn.
    pub(crate) fn wrapped<S: Real>(&self, x: S) -> S {
        match *self {
            Measured::CrankAngle => x - TAU * (x.value() / TAU).floor(),
            _ => x,
        }
    }

    /// The quantity, an angle since the start.
    pub(crate) fn unwrapped<S: Scalar>(&self, at: &Evaluation<S>) -> S {
        match *self {
            Measured::CrossheadAcceleration { throw } => {
                let throw = &at.throws[throw];
                throw.accelerations.crosshead + throw.carried.x
            }
            Measured::CrossheadLateralAcceleration { throw } => {
                let throw = &at.throws[throw];
                throw.accelerations.guide.x + throw.carried.y
            }
            Measured::FrameAcceleration { axis: Axis::X } => at.frame_acceleration().x,
            Measured::FrameAcceleration { axis: Axis::Y } => at.frame_acceleration().y,
            Measured::CylinderPressure { throw, end } => {
                let gas = &at.throws[throw].gas;
                match end {
                    ChamberEnd::Head => gas.head_end.pressure,
                    ChamberEnd::Crank => gas.crank_end.pressure,
                }
            }
            Measured::CrankAngle => at.angle,
        }
    }
}
