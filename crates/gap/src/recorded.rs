//! What was recorded: pressures, accelerations, or both.

use calibrate::observation::Observed;
use calibrate::pressure_gap::PressureGap;
use calibrate::recorded_sensor::RecordedSensor;
use calibrate::{Problem, ShutValve};
use std::collections::BTreeMap;

/// Whether a channel is a cylinder's pressure.
pub(crate) fn is_pressure(channel: &Observed) -> bool {
    channel.column.contains("cylinder_pressure")
}

/// Whether a cylinder's pressure was recorded.
pub(crate) fn shows_pressure(problem: &Problem) -> bool {
    let mut channels = problem.runs.iter().flat_map(|run| &run.channels);
    channels.any(is_pressure)
}

/// Whether nothing else was.
pub(crate) fn is_of_pressures(problem: &Problem) -> bool {
    let mut channels = problem.runs.iter().flat_map(|run| &run.channels);
    channels.all(is_pressure)
}

/// What the recordings show by themselves.
pub struct Recorded<'a> {
    /// Recorded pressures beside simulated ones.
    pub gas: &'a [PressureGap],
    /// The valves that they do not open.
    pub shut_valves: &'a [ShutValve],
    /// The measuring chains, by column.
    pub noise: BTreeMap<String, RecordedSensor>,
}
