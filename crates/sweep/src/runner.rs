//! From cases to their recordings: the one place where sweeps meet the simulator.

use crate::Case;
use crate::dataset::{Failure, Recording};
use simulate::{Asked, Record, machine_motion, measure, simulate_together};

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
    Ok(Recording {
        motion,
        warnings: (record.penetrations.iter())
            .filter(|joint| joint.is_too_deep())
            .map(ToString::to_string)
            .collect(),
        sample_rate_hz: record.sample_rate,
        channels: measure(
            record,
            &resolved.sensors,
            &resolved.machine.throw_names(),
            &mut case.noise(),
        ),
    })
}
