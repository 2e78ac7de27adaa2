//! From machine to record: transient, sampling, energy ledger.

use crate::penetration::Penetration;
use crate::sensor::Sensor;
use crate::settings::{Settings, Unrecordable};
use crate::task::{Asked, Kept, Task};
use crate::trace::Trace;
use mechanism::Machine;

/// Largest deviation of a free crank's mean speed from the machine's, as a share: 5 %, the slip at rated
/// load that an induction motor of design B stays below (NEMA MG 1, 1.19). Beyond it a motor is off the
/// straight part of its torque–speed line, and labels, windows and orders, which are by the stated speed,
/// would be of another machine.
pub const MOST_SLIP: f64 = 0.05;

/// Largest share of the energy turned over that a ledger may miss: a hundred times what it misses at the
/// default tolerance (2e-9 to 1e-8), and far below what shows in a signal.
pub const MOST_MISSING: f64 = 1e-6;

/// Why a run failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The integration stopped.
    #[error("{0}")]
    Integration(#[from] integrate::Error),
    /// The settings give no record of this machine.
    #[error("{0}")]
    Settings(#[from] Unrecordable),
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
    /// A free crank came to a stop and turns the other way.
    #[error(
        "the crank has stopped and turns back after {revolutions:.1} revolutions, at t = {time:.3} s: its \
         motor cannot turn the machine at {stated} rpm; raise crank.drive.free.mean_torque or lower the load"
    )]
    TurnsBack {
        /// Time at which it was found, s.
        time: f64,
        /// How far it had come, revolutions.
        revolutions: f64,
        /// The reference speed, rev/min.
        stated: f64,
    },
    /// A free crank runs at another speed than the machine's.
    #[error(
        "the crank turns at {mean} rpm on average, {:.1} % off the {stated} rpm of the machine, and at \
         most {:.0} % are allowed: change crank.drive.free.mean_torque to what the load takes, or state the \
         speed that it reaches",
        100.0 * (mean / stated - 1.0).abs(), 100.0 * MOST_SLIP
    )]
    OffSpeed {
        /// Mean speed over the record, rev/min.
        mean: f64,
        /// The reference speed, rev/min.
        stated: f64,
    },
    /// The ledger of the energy does not close.
    #[error(
        "the energy ledger misses {missing:.1e} of the energy turned over, and at most {MOST_MISSING:.0e} is \
         allowed: look for a value that is many powers of ten off (a mass, an inertia, a stiffness), or lower \
         the tolerance"
    )]
    EnergyMissing {
        /// What is missing, over the energy turned over.
        missing: f64,
    },
    /// The gas did more work than it can.
    #[error(
        "the gas gave the pistons {gained:.1e} of the energy turned over more than it held: energy from \
         nothing, which ideal valves cannot give"
    )]
    EnergyFromGas {
        /// What it gave too much, over the energy turned over.
        gained: f64,
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
    /// Energy that the ledger misses, as a share of the energy turned over: the run's own measure of its
    /// accuracy. Over the recorded revolutions where the motion is traced, over the revolution after them
    /// where many machines run together.
    pub energy_residual: Option<f64>,
    /// Mean speed of the crank over the record and what leads into it, rad/s; negative clockwise.
    pub mean_speed: f64,
    /// How deep each joint with clearance was pressed in.
    pub penetrations: Vec<Penetration>,
    /// Steps, rejected steps and located switches of the integration.
    pub work: integrate::Work,
}

/// Runs `machine` and records `sensors`; with `traced` also the motion itself.
///
/// # Errors
/// Where the integration cannot meet its tolerance, a sensor's filter does not fit the rate, a free crank
/// does not keep its speed, or the energy ledger of a traced run does not close.
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
    let kept = if traced { Kept::Trace } else { Kept::Series };
    Task::start(asked, delay, kept)?.finish(&mut |_| ())
}

/// As [`simulate`] with a trace; `watch` is told after each step which share of the run is done.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_watched(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    watch: &mut dyn FnMut(f64),
) -> Result<Record, Error> {
    let asked = Asked {
        machine,
        sensors,
        settings,
    };
    Task::start(asked, 0.0, Kept::Trace)?.finish(watch)
}
