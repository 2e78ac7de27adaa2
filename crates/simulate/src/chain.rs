//! The measuring chain up to the recorder: filters at the inner rate, then decimation.

use crate::error::Error;
use crate::instants::Instants;
use crate::sensor::{Chain, Sensor};
use crate::settings::Settings;
use mechanism::Machine;
use scalar::Scalar;
use signal::biquad::Filter;
use signal::decimate::Decimator;
use signal::delay::Delay;
use signal::high_pass::HighPass;
use std::f64::consts::TAU;

/// Fewest inner samples per recorded one.
const LEAST_FACTOR: f64 = 4.0;
/// Most inner samples per recorded one: a slow recording still sees the contacts.
const MOST_FACTOR: f64 = 4096.0;

/// Revolutions that structures may take to settle.
const MOST_SETTLING: f64 = 1000.0;

/// Checks that what carries these sensors settles where a revolution takes so long, s.
///
/// # Errors
/// A structure that takes more than 1000 revolutions.
pub(crate) fn check_settling(sensors: &[Sensor], revolution: f64) -> Result<(), Error> {
    for sensor in sensors {
        let settling = sensor.chain.structure.map_or(0.0, |s| s.settling());
        if settling > MOST_SETTLING * revolution {
            return Err(Error::Swinging {
                sensor: sensor.measured.entry().name,
                revolutions: settling / revolution,
                most: MOST_SETTLING,
            });
        }
    }
    Ok(())
}

/// How a record is sampled: more finely first, then decimated.
#[derive(Clone)]
pub(crate) struct Sampling {
    decimator: Decimator,
    /// Inner samples before those of the decimator, in which structures settle.
    settling: usize,
    /// Inner samples per recorded one.
    pub factor: usize,
    /// Samples per second before decimation.
    pub inner_rate: f64,
    /// Recorded samples.
    pub samples: usize,
}

impl Sampling {
    /// `length` seconds of what `sensors` see, as `settings` say.
    pub(crate) fn new(sensors: &[Sensor], settings: &Settings, length: f64) -> Result<Self, Error> {
        let rate = settings.sample_rate;
        let factor = (settings.inner_rate / rate).clamp(LEAST_FACTOR, MOST_FACTOR);
        let mut sampling = Self::by(factor.ceil(), rate, length)?;
        let structures = sensors.iter().filter_map(|s| s.chain.structure);
        let longest = structures.map(|s| s.settling()).fold(0.0, f64::max);
        sampling.settling = (longest * sampling.inner_rate).ceil() as usize;
        Ok(sampling)
    }

    /// How long structures settle before the record, s.
    pub(crate) fn settling(&self) -> f64 {
        self.settling as f64 / self.inner_rate
    }

    /// The same for these sensors: contacts hardly move the gas, so that pressures by themselves need
    /// no look at the ringing. Their kinks fall off with the square of the order.
    pub(crate) fn for_sensors(
        sensors: &[Sensor],
        settings: &Settings,
        length: f64,
    ) -> Result<Self, Error> {
        match sensors.iter().all(Sensor::is_smooth) {
            true => Self::by(1.0, settings.sample_rate, length),
            false => Self::new(sensors, settings, length),
        }
    }

    fn by(factor: f64, rate: f64, length: f64) -> Result<Self, Error> {
        let decimator = Decimator::new(factor as usize).map_err(|source| Error::Sensor {
            column: "all".into(),
            source,
        })?;
        Ok(Self {
            decimator,
            settling: 0,
            factor: factor as usize,
            inner_rate: rate * factor,
            // A sample that falls on the end of the last revolution belongs to the next.
            samples: (length * rate - 1e-9).ceil().max(1.0) as usize,
        })
    }

    /// Inner samples before the first recorded one.
    pub(crate) fn lead(&self) -> usize {
        self.settling + self.decimator.half_length()
    }

    /// All inner samples.
    fn count(&self) -> usize {
        self.settling + self.decimator.input_length(self.samples)
    }

    /// The inner samples of a record that begins at `start`, s.
    pub(crate) fn instants(&self, start: f64) -> Instants {
        Instants {
            first: start - self.lead() as f64 / self.inner_rate,
            rate: self.inner_rate,
            count: self.count(),
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
        let samples = 0..self.count();
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
        let mut under_way = self.begin(sensor, machine)?;
        under_way.extend(inner.iter().copied());
        Ok(under_way.end(start))
    }

    /// Begins a record of `sensor`.
    pub(crate) fn begin(&self, sensor: &Sensor, machine: &Machine) -> Result<UnderWay, Error> {
        let rate = self.inner_rate / self.factor as f64;
        let coupled = |cutoff: f64| HighPass::new(cutoff, rate);
        let high_pass = sensor.chain.high_pass.map(coupled).transpose();
        let filters = filters(sensor, self.inner_rate);
        let both = filters.and_then(|filters| Ok((filters, high_pass?)));
        let (filters, high_pass) = both.map_err(|source| {
            let names = machine.throw_names();
            Error::Sensor {
                column: sensor.measured.column(&names),
                source,
            }
        })?;
        Ok(UnderWay {
            high_pass,
            delay: Delay::new(sensor.chain.delay * self.inner_rate),
            sensor: sensor.clone(),
            filters,
            seen: 0,
            waiting: Vec::new(),
            recorded: Vec::with_capacity(self.samples),
            sampling: self.clone(),
        })
    }
}

/// Recorded samples that are made at a time.
const AT_A_TIME: usize = 256;

/// A sensor's record under way: inner samples go in one after another, and only those are kept that
/// the decimation still needs.
pub(crate) struct UnderWay {
    sensor: Sensor,
    delay: Delay,
    filters: Vec<Filter>,
    high_pass: Option<HighPass>,
    /// Inner samples so far.
    seen: usize,
    /// Those of them, filtered, that are not decimated yet.
    waiting: Vec<f64>,
    recorded: Vec<f64>,
    sampling: Sampling,
}

impl UnderWay {
    /// Takes the next inner samples.
    pub(crate) fn extend(&mut self, inner: impl IntoIterator<Item = f64>) {
        for x in inner {
            // An angle has a jump a revolution, which no filter must touch.
            match self.sensor.measured.is_angle() {
                true => self.pick(x),
                false => self.filter(x),
            }
            self.seen += 1;
        }
    }

    fn pick(&mut self, angle: f64) {
        let since = self.seen.checked_sub(self.sampling.lead());
        let due = since.is_some_and(|since| since.is_multiple_of(self.sampling.factor));
        if due && self.recorded.len() < self.sampling.samples {
            let offset = self.sensor.chain.angle_offset;
            self.recorded.push(shifted(angle, offset));
        }
    }

    fn filter(&mut self, x: f64) {
        let x = self.delay.run(x * self.sensor.chain.gain);
        if self.seen == 0 {
            self.filters.iter_mut().fold(x, |x, f| f.settle(x));
        }
        let x = self.filters.iter_mut().fold(x, |x, f| f.run(x));
        if self.seen < self.sampling.settling {
            return;
        }
        self.waiting.push(x);
        if self.waiting.len() >= self.sampling.decimator.input_length(AT_A_TIME) {
            self.decimate();
        }
    }

    fn decimate(&mut self) {
        let recorded = self.sampling.decimator.apply(&self.waiting);
        self.waiting.drain(..recorded.len() * self.sampling.factor);
        self.recorded.extend(recorded);
    }

    /// The record, which begins at `start`, s.
    pub(crate) fn end(mut self, start: f64) -> Vec<f64> {
        self.decimate();
        let rate = self.sampling.inner_rate / self.sampling.factor as f64;
        let Chain { hum, offset, .. } = self.sensor.chain;
        if self.sensor.measured.is_angle() {
            return self.recorded;
        }
        if let Some(high_pass) = self.high_pass {
            high_pass.apply(&mut self.recorded);
        }
        if let Some(hum) = hum {
            for (i, x) in self.recorded.iter_mut().enumerate() {
                let time = start + i as f64 / rate;
                let (_, cosine) = Scalar::sin_cos(TAU * hum.frequency * time + hum.phase);
                *x += hum.amplitude * cosine;
            }
        }
        // Not where it is 0, which would change the sign of a 0.
        if offset != 0.0 {
            self.recorded.iter_mut().for_each(|x| *x += offset);
        }
        self.recorded
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
    if let Some(structure) = chain.structure {
        filters.push(structure.filter(rate)?);
    }
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
