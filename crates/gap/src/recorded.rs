//! What was recorded: pressures, accelerations, or both.

use calibrate::Problem;
use calibrate::observation::Observed;

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
