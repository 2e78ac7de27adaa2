//! Why a run fails.

use crate::settings::Unrecordable;

/// Largest deviation of a free crank's mean speed from the machine's, as a share: 5 %. An induction motor
/// of design B has less slip at rated load (NEMA MG 1, 1.19). Beyond it a motor is off the straight part
/// of its torque–speed line. Labels, windows and orders go by the stated speed and would be wrong.
pub const MOST_SLIP: f64 = 0.05;

/// Largest share of the energy turned over that a ledger may miss. It is a hundred times what a ledger
/// misses at the default tolerance (2e-9 to 1e-8), and far below what shows in a signal.
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
    /// What carries a sensor swings for too long before it follows the machine.
    #[error(
        "sensor {sensor}: the housing swings by itself for {revolutions:.1e} revolutions, and at most {most} can be \
         waited for: raise its damping_ratio or its frequency"
    )]
    Swinging {
        /// The sensor.
        sensor: &'static str,
        /// How long it swings, revolutions.
        revolutions: f64,
        /// How long it may.
        most: f64,
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

impl Error {
    /// Whether whoever watched the run ended it.
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Integration(integrate::Error::Stopped { .. }))
    }
}
