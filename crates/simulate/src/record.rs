//! From machine to record: transient, sampling, energy ledger.

use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::task::{Asked, Task};
use crate::trace::Trace;
use mechanism::Machine;

/// Why a run failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The integration stopped.
    #[error("{0}")]
    Integration(#[from] integrate::Error),
    /// A filter of the measuring chain cannot be built.
    #[error("sensor {column}: {source}")]
    Sensor {
        /// The channel.
        column: String,
        /// What is wrong with it.
        source: signal::Error,
    },
    /// A free crank stands still, or swings.
    #[error(
        "the crank does not come round any more: none of its revolutions ended before t = {time} s"
    )]
    Stalled {
        /// Time reached, s.
        time: f64,
    },
    /// The motion left the range in which the model means anything.
    #[error("the motion is no longer finite at t = {time} s")]
    NotFinite {
        /// Time reached, s.
        time: f64,
    },
}

/// What the sensors of a run see before noise, and how the run went.
#[derive(Clone, Debug)]
pub struct Record {
    /// Samples per second.
    pub sample_rate: f64,
    /// Time of the first sample since the start of the machine, s.
    pub start: f64,
    /// One series of samples per sensor, in the order of the sensors and in SI.
    pub series: Vec<Vec<f64>>,
    /// Poses, rates and forces, where they were asked for.
    pub trace: Option<Trace>,
    /// Revolutions that were thrown away.
    pub transient: u32,
    /// True where the transient was found to have settled.
    pub settled: bool,
    /// Energy that the ledger misses over the recorded revolutions, as a share of the energy turned
    /// over: the run's own measure of its accuracy. Works are integrated where the motion is traced.
    pub energy_residual: Option<f64>,
    /// Steps, rejected steps and located switches of the integration.
    pub work: integrate::Work,
}

/// Runs `machine` and records `sensors`; with `traced` also the motion itself.
///
/// # Errors
/// Where the integration cannot meet its tolerance, or a sensor's filter does not fit the rate.
pub fn simulate(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    traced: bool,
) -> Result<Record, Error> {
    simulate_later(machine, sensors, settings, 0.0, traced)
}

/// The same, the record beginning `delay` seconds (0 or more) after the transient: at a crank angle
/// of choice, where without a delay a crank of given speed stands at angle 0.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_later(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    delay: f64,
    traced: bool,
) -> Result<Record, Error> {
    let asked = Asked {
        machine,
        sensors,
        settings,
    };
    Task::start(asked, delay, traced)?.finish()
}
