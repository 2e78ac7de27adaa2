//! From a case to its recording: the one place where sweeps meet the simulator.

use crate::Case;
use crate::dataset::{Failure, Recording};
use simulate::{machine_motion, measure, simulate};

/// Simulates `case` and measures it with its sensors and its noise.
///
/// # Errors
/// Where the integration fails; the message has the time.
pub fn simulate_case(case: &Case) -> Result<Recording, Failure> {
    let resolved = &case.resolved;
    let record = simulate(&resolved.machine, &resolved.sensors, &case.settings, false)?;
    let throws = resolved.machine.throws.iter();
    let names: Vec<&str> = throws.map(|throw| throw.name.as_str()).collect();
    let motion = match &case.judgement {
        Some(asked) => machine_motion(&resolved.machine, &asked.settings, asked.extent)?,
        None => None,
    };
    Ok(Recording {
        motion,
        sample_rate_hz: record.sample_rate,
        channels: measure(&record, &resolved.sensors, &names, &mut case.noise()),
    })
}
