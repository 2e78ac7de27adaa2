//! The spread over the relations to the clearance that the recordings do not exclude.

use super::Listed;
use crate::Failure;
use crate::calibrate::{output, relation};
use ::calibrate::relation_spread::{RelationSpread, relation_spread};
use ::calibrate::{Observation, Problem, Replay};
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The relations that are possible for a machine.
pub(super) struct Possible {
    /// Those that the calibration beside its file does not exclude, or all that have a name.
    relations: Vec<Value>,
    /// The clearances that joints had in the recordings of that calibration, by path, m.
    known_at: BTreeMap<String, f64>,
}

impl Possible {
    /// Those of the machine file at this path; of a bundle's own machine where there is none.
    ///
    /// # Errors
    /// A calibration beside it that cannot be read.
    pub(super) fn read(machine: Option<&Path>) -> Result<Self, Failure> {
        let beside = machine.map(|path| path.with_file_name(output::RESULTS));
        let is_calibrated =
            machine.is_some_and(|path| path.file_name() == Some(output::MACHINE.as_ref()));
        let Some(path) = beside.filter(|path| is_calibrated && path.is_file()) else {
            return Ok(Self {
                relations: relation::bounds_of_not_excluded(&Value::Null),
                known_at: BTreeMap::new(),
            });
        };
        let wrong = |reason: String| Failure::input(format!("{}: {reason}", path.display()));
        let text = files::read_text(&path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        let results: Value =
            serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        let joints = results["relation"].as_object().into_iter().flatten();
        let clearance = |(path, stated): (&String, &Value)| {
            Some((path.clone(), stated["clearance_m"].as_f64()?))
        };
        Ok(Self {
            relations: relation::bounds_of_not_excluded(&results["relations"]),
            known_at: joints.filter_map(clearance).collect(),
        })
    }
}

/// The spread of each run; none where it was recorded at the clearances that the machine states.
///
/// # Errors
/// A machine file whose joints cannot be read.
pub(super) fn spreads(
    problem: &Problem,
    runs: &[Listed],
    replays: &[Replay],
    possible: &Possible,
) -> Result<Vec<Option<RelationSpread>>, Failure> {
    let runs = runs.par_iter().zip(&problem.runs).zip(replays);
    let spread = |((listed, observation), own): ((&Listed, &Observation), &Replay)| {
        relation_spread(
            problem,
            &listed.run,
            observation,
            own,
            &possible.relations,
            &possible.known_at,
        )
    };
    runs.map(spread)
        .collect::<Result<_, _>>()
        .map_err(Failure::work)
}

/// Prints them.
pub(super) fn summary(runs: &[Listed], spreads: &[Option<RelationSpread>]) {
    for (Listed { run, .. }, spread) in runs.iter().zip(spreads) {
        let Some(spread) = spread else { continue };
        let joints = spread.joints.iter().map(|(path, joint)| {
            let [at, from] = [joint.clearance_m, joint.stated_for_m].map(|c| 1e3 * c);
            format!("{path} at {at:.4} mm, its contact known at {from:.4} mm")
        });
        println!("{}: {}", run.id, joints.collect::<Vec<String>>().join("; "));
        let named = spread
            .relations
            .iter()
            .map(|variant| match &variant.relation {
                Value::String(name) => name.clone(),
                exponents => exponents.to_string().replace('"', ""),
            });
        println!(
            "  spread over the relations that the recordings do not exclude ({}):",
            named.collect::<Vec<String>>().join(", ")
        );
        for (column, channel) in &spread.channels {
            let [low, high] = channel.difference.map(|share| 100.0 * share);
            println!(
                "  {column}: rms {:.4e} to {:.4e}, peak {:.4e} to {:.4e}, difference {low:.2} to {high:.2} %",
                channel.rms[0], channel.rms[1], channel.peak[0], channel.peak[1]
            );
        }
        for variant in &spread.relations {
            if let Some(failure) = &variant.failure {
                println!("  {}: cannot be simulated: {failure}", variant.relation);
            }
        }
    }
}
