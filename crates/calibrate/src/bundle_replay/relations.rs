//! The relations to the clearance that the recordings do not exclude.

use crate::error::Error;
use crate::observation::{Observation, Run};
use crate::problem::Problem;
use crate::relation_spread::{RelationSpread, relation_spread};
use crate::replay::Replay;
use crate::results::MACHINE;
use crate::results::{RESULTS, Results, bounds_of_not_excluded};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The relations that are possible for a machine.
pub struct Possible {
    /// Those that the calibration beside its file does not exclude, or all that have a name.
    relations: Vec<Value>,
    /// The clearances that joints had in the recordings of that calibration, by path, m.
    known_at: BTreeMap<String, f64>,
}

impl Possible {
    /// Those of the machine file at this path, or of the bundle's own machine if there is no path.
    ///
    /// # Errors
    /// A calibration beside it that cannot be read.
    pub fn read(machine: Option<&Path>) -> Result<Self, Error> {
        let calibrated = machine.filter(|path| path.file_name() == Some(MACHINE.as_ref()));
        let beside = calibrated.map(|path| path.with_file_name(RESULTS));
        let Some(path) = beside.filter(|path| path.is_file()) else {
            return Ok(Self {
                relations: bounds_of_not_excluded(None),
                known_at: BTreeMap::new(),
            });
        };
        let results = Results::read(&path)?;
        let joints = results.relation.iter();
        Ok(Self {
            relations: bounds_of_not_excluded(results.relations.as_ref()),
            known_at: joints
                .map(|(path, joint)| (path.to_owned(), joint.clearance_m))
                .collect(),
        })
    }

    /// The spread of a run over them; none where it was recorded at the clearances that the machine
    /// states.
    ///
    /// # Errors
    /// A machine file whose joints cannot be read.
    pub(super) fn spread(
        &self,
        problem: &Problem,
        run: &Run,
        observation: &Observation,
        own: &Replay,
    ) -> Result<Option<RelationSpread>, Error> {
        let (relations, known_at) = (&self.relations, &self.known_at);
        relation_spread(problem, run, observation, own, relations, known_at)
    }
}
