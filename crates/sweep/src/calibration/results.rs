//! What a calibration has found, and the plan of a sweep with it.

use std::collections::BTreeSet;
use std::path::Path;

use calibrate::Results;
use calibrate::normal::QUANTILE;
use calibrate::results::{self, Known, MACHINE, RESULTS, not_excluded};
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use input::bundle::Bundle;
use input::paths;
use scalar::elementary::ln;
use serde_json::Value;

use super::{Calibration, Estimate, Relations, Sweep};
use crate::sweep_file::{Amount, Uncertainty, Undetermined};
use crate::{Error, Plan};

impl Sweep {
    /// The plan with the calibration that `folder` holds, and of its uncertainty what the sweep asks for.
    ///
    /// # Errors
    /// As [`Sweep::kept_with`].
    pub fn kept(&self, folder: &Path) -> Result<Plan, Error> {
        let asked = self.calibrate();
        let (uncertainty, undetermined) = asked
            .map(|asked| (asked.uncertainty, asked.undetermined))
            .unwrap_or_default();
        self.kept_with(folder, uncertainty, undetermined)
    }

    /// The plan with the calibration that `folder` holds, and so much of its uncertainty.
    ///
    /// # Errors
    /// A calibration that is damaged, or one without intervals where the sweep draws from them; and as
    /// [`Plan::read`].
    pub fn kept_with(
        &self,
        folder: &Path,
        uncertainty: Uncertainty,
        undetermined: Undetermined,
    ) -> Result<Plan, Error> {
        let mut calibration = Calibration::read(folder)?;
        let asked = self.calibrate();
        if uncertainty == Uncertainty::Sampled && !calibration.is_adequate {
            return Err(Error::NoIntervals(folder.join(RESULTS)));
        }
        // A relation that the sweep states is what its author knows.
        if asked.is_some_and(|asked| asked.settings.relation.is_some()) {
            calibration.relations = Relations::default();
        }
        if let Some(own) = self.machine()? {
            let fitted = |path: &str| calibration.estimates.iter().any(|e| e.path == path);
            let mut machine = calibration.machine.clone();
            for path in self.conditions(&own)?.iter().filter(|path| !fitted(path)) {
                let value = paths::get(&own, path)?.cloned();
                paths::set(&mut machine, path, value.unwrap_or_else(|| "ideal".into()))?;
            }
            calibration.machine = machine;
        }
        Ok(self.calibrated_with(&calibration, uncertainty, undetermined)?)
    }

    /// What the runs set in the machine file: speed, pressures, clearances. A sweep's own machine keeps
    /// its own; a joint of which it says nothing is ideal.
    fn conditions(&self, machine: &Value) -> Result<BTreeSet<String>, Error> {
        let mut conditions = BTreeSet::new();
        for folder in self.bundles() {
            for run in Bundle::read(&folder)?.runs {
                let settings = input::run_settings(&run.section, machine)?;
                conditions.extend(settings.into_iter().map(|(path, _)| path));
            }
        }
        Ok(conditions)
    }
}

impl Calibration {
    /// The calibration in `folder`.
    ///
    /// # Errors
    /// A file that is not what a calibration writes.
    fn read(folder: &Path) -> Result<Self, Error> {
        let results = Results::read(&folder.join(RESULTS));
        let results = results.map_err(|error| Error::DamagedCalibration(error.to_string()))?;
        let machine = input::machine_file::read(&folder.join(MACHINE))?;
        let machine = machine.to_tree().clone();
        let mut estimates = Vec::new();
        // The parameter of each estimate: one value may stand at several places.
        let mut names = Vec::new();
        // The zero of a crank angle and the conditions of a run are the recordings', not the machine's.
        let of_machine = |name: &str| name != CRANK_ANGLE_OFFSET && !name.starts_with("runs.");
        for (name, found) in results.parameters.iter() {
            // Told, but without an interval: neither drawn nor open.
            if !of_machine(name) || found.known() == Known::Fitted {
                continue;
            }
            for place in paths::matching(&machine, name)? {
                let estimate = Estimate::from_results(&machine, &place, found);
                let incomplete = || {
                    let path = folder.join(RESULTS);
                    Error::DamagedCalibration(format!("{}: {name} is not complete", path.display()))
                };
                estimates.push(estimate.ok_or_else(incomplete)?);
                names.push(name);
            }
        }
        let row = |a: &&str| {
            let others = names.iter();
            others.map(|b| results.correlation(a, b)).collect()
        };
        Ok(Self {
            correlations: names.iter().map(row).collect(),
            relations: Relations::not_excluded(&results, &machine)?,
            is_adequate: results.model_is_adequate,
            machine,
            estimates,
        })
    }
}

impl Relations {
    /// The relations to the clearance that the recordings do not exclude, weighted by Schwarz's
    /// criterion. If every run has the same clearances, these are all relations with a name,
    /// equally weighted. Fitted exponents are estimates like others.
    fn not_excluded(results: &Results, machine: &Value) -> Result<Self, Error> {
        let mut joints = Vec::new();
        for (joint, stated) in results.relation.iter() {
            let own = paths::get(machine, &format!("{joint}.contact.relation"))?;
            if own.is_some_and(Value::is_object) {
                return Ok(Self::default());
            }
            let clearance = stated.at_clearance_m.unwrap_or(stated.clearance_m);
            joints.push((joint.to_owned(), clearance));
        }
        Ok(Self {
            weights: not_excluded(results.relations.as_ref()),
            joints,
        })
    }
}

impl Estimate {
    /// The estimate `found` of the value at `place` of the calibrated machine; none if the machine has no
    /// number there.
    fn from_results(machine: &Value, place: &str, found: &results::Estimate) -> Option<Self> {
        let value = paths::get(machine, place).ok()??.clone();
        let dimension = Amount::from_value(&value)?.dimension;
        let width = match (found.known(), found.logarithmic) {
            (Known::Within([low, high]), true) => Some(ln(high / low)),
            (Known::Within([low, high]), false) => Some(high - low),
            (Known::Fitted | Known::Nothing, _) => None,
        };
        Some(Self {
            path: place.to_owned(),
            value,
            bounds: found.bounds.map(|si| Amount { si, dimension }.to_value()),
            logarithmic: found.logarithmic,
            deviation: width.map(|width| width / (2.0 * QUANTILE)),
        })
    }
}
