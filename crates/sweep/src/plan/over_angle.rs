//! Signals with equal steps of the crank angle in the place of equal times.

use std::f64::consts::TAU;

use input::{Error, Resolved};
use mechanism::drive::Drive;
use rand::Rng;
use scalar::random::{Purpose, stream};
use simulate::Settings;

use super::case::{Case, rpm};
use crate::design::hash::unit;
use crate::sweep_file::{Format, Run, Start, SweepFile};

/// Revolutions that are recorded beside those of the signals: the filters reach over one before and one after, and the
/// signals begin within the third.
const MARGIN: u32 = 3;

/// How signals are resampled over the crank angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverAngle {
    /// Samples in a revolution.
    pub samples_per_revolution: u32,
    /// Where the signals begin.
    pub start: Start,
}

impl OverAngle {
    /// As the sweep file asks for; none where it does not.
    ///
    /// # Errors
    /// A start or a second rate that does not belong, a format without angles, a crank whose angle is not known.
    pub(super) fn new(file: &SweepFile, base: &Resolved) -> Result<Option<Self>, Error> {
        let Run {
            samples_per_revolution,
            start,
            ..
        } = &file.run;
        let key = "run.samples_per_revolution";
        let Some(samples) = samples_per_revolution else {
            return match start {
                Some(_) => {
                    let found = "a start without samples_per_revolution";
                    let expected = "samples_per_revolution beside it, e.g. 512";
                    Err(Error::unexpected("run.start", found, expected))
                }
                None => Ok(None),
            };
        };
        if let Some(rate) = &file.run.sample_rate {
            let found = format_args!("{} beside sample_rate {} Hz", samples.get(), rate.si());
            let expected =
                "one of the two; sensors are recorded at the sample_rate of the machine file";
            let error = Error::unexpected(key, found, expected);
            return Err(error.against("/run.sample_rate"));
        }
        Self::check(file.format)?;
        let turns_evenly =
            matches!(&base.machine.drive, Drive::Given(given) if given.fluctuation.is_empty());
        let has_angle = base
            .sensors
            .iter()
            .any(|s| s.measured.entry().name == "crank_angle");
        if !turns_evenly && !has_angle {
            let found = "a crank whose speed changes and whose angle no sensor reads";
            let expected =
                "the sensor crank_angle in the machine file, to resample the channels by";
            return Err(Error::unexpected(key, found, expected));
        }
        Ok(Some(Self {
            samples_per_revolution: samples.get(),
            start: start.unwrap_or(Start::Zero),
        }))
    }

    /// Checks that recordings of this format can do without times.
    pub(super) fn check(format: Format) -> Result<(), Error> {
        if format == Format::Parquet {
            return Ok(());
        }
        let expected = "format parquet: in MCAP every sample has a time";
        let error = Error::unexpected("run.samples_per_revolution", "format mcap", expected);
        Err(error.against("/format"))
    }

    /// The settings by which a case of this speed, rad/s, is recorded.
    ///
    /// # Errors
    /// A recorder that takes fewer samples in a revolution.
    pub(super) fn settings(&self, signals: &Settings, speed: f64) -> Result<Settings, Error> {
        let recorded = signals.sample_rate * TAU / speed;
        let wanted = f64::from(self.samples_per_revolution);
        // The share that resampling takes for rounding.
        if wanted > 1.01 * recorded {
            let expected = format!(
                "at most {}: at {} rpm a recorder of {} Hz (sample_rate of the machine file) takes no more",
                (recorded + 1e-9).floor(),
                rpm(speed),
                signals.sample_rate
            );
            return Err(Error::unexpected(
                "run.samples_per_revolution",
                wanted,
                expected,
            ));
        }
        Ok(Settings {
            revolutions: signals.revolutions + MARGIN,
            ..*signals
        })
    }

    /// The point of a revolution at which the signals of `case` begin, from 0.
    pub(crate) fn start_of(&self, case: &Case) -> u32 {
        match self.start {
            Start::Zero => 0,
            Start::Random => {
                let drawn = stream(case.seed, case.index, Purpose::Start).next_u64();
                (unit(drawn) * f64::from(self.samples_per_revolution)) as u32
            }
        }
    }

    /// The crank angle at a point, rad.
    pub(crate) fn angle(&self, point: u32) -> f64 {
        TAU * f64::from(point) / f64::from(self.samples_per_revolution)
    }
}
