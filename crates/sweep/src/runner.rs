//! From a case to its recording: the one place where sweeps meet the simulator.

use crate::Case;
use crate::dataset::{Failure, Recording};
use simulate::{measure, simulate};

/// Simulates `case` and measures it with its sensors and its noise.
///
/// # Errors
/// Where the integration fails; the message has the time.
pub fn simulate_case(case: &Case) -> Result<Recording, Failure> {
    let resolved = &case.resolved;
    let record = simulate(&resolved.machine, &resolved.sensors, &case.settings, false)?;
    let throws = resolved.machine.throws.iter();
    let names: Vec<&str> = throws.map(|throw| throw.name.as_str()).collect();
    Ok(Recording {
        sample_rate_hz: record.sample_rate,
        channels: measure(&record, &resolved.sensors, &names, &mut case.noise()),
    })
}
