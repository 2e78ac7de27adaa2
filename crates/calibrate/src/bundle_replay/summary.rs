//! How far the replays are from the recordings, in words.

use super::Results;
use crate::relation_spread::RelationSpread;
use serde_json::Value;
use std::fmt;

/// Relative difference of mean speeds that is worth a word.
const SPEED: f64 = 1e-5;

/// A table of the channels, and what else is to be known of each run.
impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let runs = || self.runs.iter();
        let columns = runs().flat_map(|(_, run)| run.channels.iter());
        let wide = columns.map(|(column, _)| column.len()).max().unwrap_or(0);
        let wide = wide.max("channel".len());
        let long = runs().map(|(id, _)| id.len()).max().unwrap_or(0);
        let long = long.max("run".len());
        writeln!(
            f,
            "{:long$}  {:wide$}  {:>10}  {:>11}  {:>7}",
            "run", "channel", "difference", "noise floor", "misfit"
        )?;
        for (id, run) in runs() {
            for (column, channel) in run.channels.iter() {
                writeln!(
                    f,
                    "{id:long$}  {column:wide$}  {:>8.2} %  {:>9.2} %  {:>7.2}",
                    100.0 * channel.difference,
                    100.0 * channel.noise_floor,
                    channel.misfit
                )?;
            }
        }
        writeln!(
            f,
            "difference: of the synchronous means over the recording's RMS; misfit: 1 is noise alone"
        )?;
        for (id, run) in runs() {
            let faster = run.simulated_speed_rpm / run.recorded_speed_rpm - 1.0;
            if faster.abs() > SPEED {
                writeln!(
                    f,
                    "{id}: the simulated crank turns at {:.3} rpm, the recorded one at {:.3} rpm ({:+.3} %)",
                    run.simulated_speed_rpm,
                    run.recorded_speed_rpm,
                    100.0 * faster
                )?;
            }
            if !run.periodic {
                writeln!(
                    f,
                    "{id}: the simulated motion does not repeat itself; compare its means with the recording, not its waveform"
                )?;
            }
        }
        for (id, run) in runs() {
            if let Some(spread) = &run.relation_spread {
                spread_of(f, id, spread)?;
            }
        }
        Ok(())
    }
}

fn spread_of(f: &mut fmt::Formatter, id: &str, spread: &RelationSpread) -> fmt::Result {
    let joints = spread.joints.iter().map(|(path, joint)| {
        let [at, from] = [joint.clearance_m, joint.stated_for_m].map(|c| 1e3 * c);
        format!("{path} at {at:.4} mm, its contact known at {from:.4} mm")
    });
    writeln!(f, "{id}: {}", joints.collect::<Vec<String>>().join("; "))?;
    let named = spread
        .relations
        .iter()
        .map(|variant| match &variant.relation {
            Value::String(name) => name.clone(),
            exponents => exponents.to_string().replace('"', ""),
        });
    writeln!(
        f,
        "  spread over the relations that the recordings do not exclude ({}):",
        named.collect::<Vec<String>>().join(", ")
    )?;
    for (column, channel) in &spread.channels {
        let [low, high] = channel.difference.map(|share| 100.0 * share);
        writeln!(
            f,
            "  {column}: rms {:.4e} to {:.4e}, peak {:.4e} to {:.4e}, difference {low:.2} to {high:.2} %",
            channel.rms[0], channel.rms[1], channel.peak[0], channel.peak[1]
        )?;
    }
    for variant in &spread.relations {
        if let Some(failure) = &variant.failure {
            writeln!(f, "  {}: cannot be simulated: {failure}", variant.relation)?;
        }
    }
    Ok(())
}
