//! What of a run is looked at for a record: of a motion that repeats itself one period, of which the record is the
//! repetition.

use crate::chain::Sampling;
use crate::error::Error;
use crate::instants::Instants;
use crate::run::Run;
use crate::sensor::Sensor;
use crate::settings::Settings;
use integrate::Real;

/// Where a period starts, as a share of a revolution: not at a dead centre, where gas switches.
const START: f64 = 0.02;

/// A part of a run.
pub(crate) struct Span {
    /// How the record is sampled.
    pub sampling: Sampling,
    /// When the record begins, s.
    pub start: f64,
    /// The inner samples that are looked at.
    pub instants: Instants,
    /// Where these are one cycle: the number of the first in the record.
    first: Option<usize>,
}

impl Span {
    /// Of a motion that repeats itself after so many revolutions and stands at a whole one. Where its crank is free, a
    /// revolution more.
    pub fn of_period<S: Real>(
        run: &Run<S>,
        period: u32,
        sensors: &[Sensor],
        settings: &Settings,
    ) -> Result<Self, Error> {
        let revolution = run.revolution();
        let spare = u32::from(run.is_free());
        let revolutions = settings.revolutions.min(period + spare);
        let length = f64::from(revolutions) * revolution;
        let sampling = Sampling::for_sensors(sensors, settings, length)?;
        let begin = run.time();
        let first = (START * revolution * sampling.inner_rate).ceil();
        let from = begin + first / sampling.inner_rate;
        let cycle = sampling.cycle(length).filter(|_| revolutions == period);
        // A cycle is recorded from the whole revolution on, anything else as soon as there is enough
        // before its first sample.
        let (start, count) = match cycle {
            Some(count) => (begin, count),
            None => {
                let start = from + sampling.lead() as f64 / sampling.inner_rate;
                (start, sampling.instants(start).count)
            }
        };
        Ok(Self {
            instants: Instants {
                first: from,
                rate: sampling.inner_rate,
                count,
            },
            sampling,
            start,
            first: cycle.map(|_| first as usize),
        })
    }

    /// The revolutions after a transient of so many.
    pub fn after<S: Real>(
        run: &Run<S>,
        transient: u32,
        sensors: &[Sensor],
        settings: &Settings,
    ) -> Result<Self, Error> {
        let start = f64::from(transient) * run.revolution();
        let length = f64::from(settings.revolutions) * run.revolution();
        let sampling = Sampling::for_sensors(sensors, settings, length)?;
        Ok(Self {
            instants: sampling.instants(start),
            sampling,
            start,
            first: None,
        })
    }

    /// All inner samples of the record from those that were looked at.
    pub fn whole(&self, inner: Vec<f64>) -> Vec<f64> {
        match self.first {
            Some(first) => self.sampling.repeated(&inner, first),
            None => inner,
        }
    }
}
