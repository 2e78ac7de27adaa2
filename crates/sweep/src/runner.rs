//! From cases to their recordings: the one place where sweeps meet the simulator.

use crate::Case;
use crate::dataset::{Failure, Recording};
use simulate::{Asked, Record, doubts, machine_motion, measure, simulate_together};

/// Simulates cases side by side and measures each with its sensors and its noise.
///
/// A failure is that of an integration; its message has the time.
pub fn simulate_cases(cases: &[Case]) -> Vec<Result<Recording, Failure>> {
    let asked: Vec<Asked> = cases
        .iter()
        .map(|case| {
            let resolved = &case.resolved;
            Asked::from_rest(&resolved.machine, &resolved.sensors, &case.settings)
        })
        .collect();
    simulate_together(&asked, |i, record| recording(&cases[i], &record?))
}

fn recording(case: &Case, record: &Record) -> Result<Recording, Failure> {
    let resolved = &case.resolved;
    let motion = match &case.judgement {
        Some(asked) => machine_motion(&resolved.machine, &asked.settings, asked.extent)?,
        None => None,
    };
    let throws = resolved.machine.throw_names();
    let channels = measure(record, &resolved.sensors, &throws, &mut case.noise());
    Ok(Recording {
        motion,
        warnings: doubts(record, &resolved.sensors, &channels),
        sample_rate_hz: record.sample_rate,
        channels,
    })
}
