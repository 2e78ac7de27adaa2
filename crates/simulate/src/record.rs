//! What a run leaves behind.

use crate::penetration::Penetration;
use crate::trace::Trace;

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
    /// accuracy. Over the recorded revolutions and what leads into them where the motion is traced, over the revolution
    /// after those that were integrated where many machines run together.
    pub energy_residual: Option<f64>,
    /// Mean speed of the crank over the record and what leads into it, rad/s; negative clockwise.
    pub mean_speed: f64,
    /// How deep each joint with clearance was pressed in.
    pub penetrations: Vec<Penetration>,
    /// Steps, rejected steps and located switches of the integration.
    pub work: integrate::Work,
}
