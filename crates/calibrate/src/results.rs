//! What a calibration finds: the content of `calibration.json`.
//!
//! Values are SI, misfits are in standard deviations of the noise: 1 is noise alone. The same inputs give
//! the same bytes.

mod by_name;
mod gas;
mod relations;
mod summary;

use crate::correction::{self, Corrected};
use crate::error::Error;
use crate::fit::{self, Fit};
use crate::forecast::Forecast;
use crate::parameter::Scale;
use crate::pressure_gap::PressureGap;
use crate::problem::Problem;
use crate::recorded_sensor::RecordedSensor;
use crate::relation::ClearJoint;
use crate::sensors::Sensors;
use crate::shut_valve::ShutValve;
use crate::task::Task;
use crate::transfer::Transfer;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

pub use by_name::ByName;
pub use gas::{Alternative, Diagram, Event, Gas, Phase, Polytrope, Rms, ValveEvents};
pub use relations::{Relations, bounds_of_not_excluded, not_excluded};

/// Name of the file of results.
pub const RESULTS: &str = "calibration.json";
/// Name of the calibrated machine.
pub const MACHINE: &str = "machine.yaml";

/// What a calibration finds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// How the best fit was searched.
    pub optimiser: String,
    /// Evaluations of the model, all runs being one; those before an interruption included.
    pub evaluations: u64,
    /// Always none: the time that it took is this computer's.
    pub seconds: Option<f64>,
    /// False where the search was stopped before its end.
    pub complete: bool,
    /// Whether the model explains the recordings; where it does not, no interval is known.
    pub model_is_adequate: bool,
    /// Digest of its inputs.
    pub fingerprint: String,
    /// What was fitted, by path.
    pub parameters: ByName<Estimate>,
    /// Correlation of each pair of estimates (of their logarithms where they have a ratio), by path.
    #[serde(default)]
    pub correlations: ByName<ByName<f64>>,
    /// The values of the data sheet that would explain the recordings, the most probable first.
    #[serde(default)]
    pub corrections: Vec<Correction>,
    /// The values of the data sheet that were fitted; none where no more than noise is left at once.
    pub corrections_tried: Option<Vec<Tried>>,
    /// The misfits over the runs.
    pub fit: Misfits,
    /// The runs.
    pub runs: ByName<Run>,
    /// The runs that were held out.
    #[serde(default)]
    pub heldout_runs: Vec<String>,
    /// The crank angle at which the pulse of a tacho was found to come, by run, where its place was not known, rad.
    #[serde(default)]
    pub pulse_angles_rad: ByName<f64>,
    /// The clear joints, by path.
    #[serde(default)]
    pub relation: ByName<JointRelation>,
    /// What the relations between clearances come to; none where the search was stopped.
    pub relations: Option<Relations>,
    /// What each relation shows at other clearances; none where the search was stopped.
    pub predictions: Option<Vec<Forecast>>,
    /// The measuring chains that the recordings show, by column.
    #[serde(default)]
    pub noise: BTreeMap<String, RecordedSensor>,
    /// The valves that recorded pressures do not open.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shut_valves: Vec<ShutValve>,
    /// The gas, by run and column; none where it was not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas: Option<ByName<ByName<Gas>>>,
}

/// What is known of a parameter, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Its value; the nominal one where it is not identifiable.
    pub value: f64,
    /// The lower end of its 95 % interval, where it has one.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// The value before.
    pub nominal: f64,
    /// Whether the recordings determine it. In a model that is not adequate it has no interval then
    /// either.
    pub identifiable: bool,
    /// Whether the value lies at the edge of its search range.
    pub at_bound: bool,
    /// Least and greatest value of the search.
    pub bounds: [f64; 2],
    /// Whether it was searched on a logarithmic scale.
    pub logarithmic: bool,
}

/// How well an estimate is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Its 95 % interval.
    Within([f64; 2]),
    /// It was fitted with a model that does not explain the recordings: there is no interval.
    Fitted,
    /// It is not identifiable from the recordings.
    Nothing,
}

/// A value of the data sheet that is wrong, or may be, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Its path in the machine file.
    pub path: String,
    /// The value that explains the recordings.
    pub value: f64,
    /// The lower end of its 95 % interval, where it has one.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// The value that is stated, where one is.
    pub nominal: Option<f64>,
    /// Probability that this value is the one that is wrong.
    pub probability: f64,
    /// Misfit of the fitted runs with it.
    pub misfit: f64,
    /// Its unit; empty for a bare number.
    pub unit: String,
    /// Whether the calibrated machine has it.
    pub applied: bool,
}

/// A value of the data sheet that was fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Its path in the machine file.
    pub path: String,
    /// Misfit of the fitted runs with it.
    pub misfit: f64,
}

/// Root mean squares of the runs' misfits; none where there is no such run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Misfits {
    /// What they are in.
    pub unit: String,
    /// What noise alone leaves.
    pub noise_floor: f64,
    /// Of the fitted runs with the nominal parameters.
    pub nominal: Option<f64>,
    /// Of the fitted runs with the calibrated ones.
    pub calibrated: Option<f64>,
    /// Of the held-out runs with the nominal parameters.
    pub heldout_nominal: Option<f64>,
    /// Of the held-out runs with the calibrated ones.
    pub heldout_calibrated: Option<f64>,
}

/// A run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// True where it was predicted and not fitted to.
    pub held_out: bool,
    /// Its misfit with the nominal parameters.
    pub nominal: f64,
    /// Its misfit with the calibrated ones.
    pub calibrated: f64,
}

/// The relation of a clear joint's contact to its clearance, as the fit began with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointRelation {
    /// The relation, as the machine file has it, where it has one.
    pub relation: Option<Value>,
    /// The clearance from which it leads, m, where the machine file states one.
    pub at_clearance_m: Option<f64>,
    /// The smallest clearance of the joint in the runs, m.
    pub clearance_m: f64,
}

/// What a calibration has come to.
pub struct Found<'a> {
    /// The fit.
    pub fit: &'a Fit,
    /// What it comes to at other clearances; none where the search was stopped.
    pub transfer: Option<Transfer>,
    /// What was looked for in the data sheet; none where no more than noise is left at once.
    pub corrected: Option<&'a Corrected>,
    /// The sensors that the recordings show.
    pub sensors: &'a Sensors,
    /// The recorded pressures beside the simulated ones, where the gas was fitted.
    pub gas: Option<&'a [PressureGap]>,
    /// Digest of its inputs.
    pub fingerprint: String,
    /// Evaluations of the model.
    pub evaluations: u64,
}

impl Results {
    /// The results of a task.
    ///
    /// # Errors
    /// A clearance that is no length.
    pub fn from_search(task: &Task, found: Found) -> Result<Self, Error> {
        let fit = found.fit;
        let adequate = fit.model_is_adequate();
        let transfer = found.transfer.map(|transfer| {
            let relations = Relations {
                decision: transfer.decision,
                compared: transfer.relations,
            };
            (relations, transfer.predictions)
        });
        let (relations, predictions) = transfer.unzip();
        let estimates = fit.estimates.iter();
        let run = |run: &fit::RunFit| {
            let misfits = Run {
                held_out: run.held_out,
                nominal: run.nominal,
                calibrated: run.calibrated,
            };
            (run.id.clone(), misfits)
        };
        let tried = |(path, misfit): &(String, f64)| Tried {
            path: path.clone(),
            misfit: *misfit,
        };
        let corrected = found.corrected;
        Ok(Self {
            optimiser: task.settings.optimiser.name().to_owned(),
            evaluations: found.evaluations,
            seconds: None,
            complete: fit.complete,
            model_is_adequate: adequate,
            fingerprint: found.fingerprint,
            parameters: estimates
                .map(|e| (e.parameter.path.clone(), Estimate::from_fit(e, adequate)))
                .collect(),
            correlations: correlations(fit),
            corrections: corrected.map_or_else(Vec::new, corrections),
            corrections_tried: corrected.map(|c| c.tried.iter().map(tried).collect()),
            fit: Misfits {
                unit: "standard deviations of the synchronous mean's noise".to_owned(),
                noise_floor: 1.0,
                nominal: fit.misfit(false, |run| run.nominal),
                calibrated: fit.misfit(false, |run| run.calibrated),
                heldout_nominal: fit.misfit(true, |run| run.nominal),
                heldout_calibrated: fit.misfit(true, |run| run.calibrated),
            },
            runs: fit.runs.iter().map(run).collect(),
            heldout_runs: task.settings.held_out.clone(),
            pulse_angles_rad: task.pulses(&task.problem, &fit.coordinates()),
            relation: joint_relations(&task.problem)?,
            relations,
            predictions,
            noise: found.sensors.by_column.clone(),
            shut_valves: task.shut_valves.clone(),
            gas: found.gas.map(gas::by_run),
        })
    }

    /// Reads a file of results.
    ///
    /// # Errors
    /// A file that cannot be read, or that no calibration has written.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |reason: String| Error::file(path, reason);
        let text = files::read_text(path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
    }

    /// Correlation of two estimates, by path.
    pub fn correlation(&self, a: &str, b: &str) -> f64 {
        let between = || self.correlations.get(a)?.get(b).copied();
        match a == b {
            true => 1.0,
            false => between().unwrap_or(0.0),
        }
    }
}

impl Estimate {
    /// What is known of a parameter. Where the model is not `adequate`, it has no interval.
    pub fn from_fit(estimate: &fit::Estimate, adequate: bool) -> Self {
        let interval = estimate.interval.filter(|_| adequate);
        Self {
            value: estimate.value,
            low: interval.map(|[low, _]| low),
            high: interval.map(|[_, high]| high),
            nominal: estimate.parameter.nominal,
            identifiable: estimate.interval.is_some(),
            at_bound: estimate.at_bound(),
            bounds: estimate.parameter.bounds,
            logarithmic: estimate.parameter.scale == Scale::Logarithmic,
        }
    }

    /// How well it is known.
    pub fn known(&self) -> Known {
        match self.low.zip(self.high) {
            Some((low, high)) => Known::Within([low, high]),
            None if self.identifiable => Known::Fitted,
            None => Known::Nothing,
        }
    }
}

impl Correction {
    /// Its 95 % interval, where it has one.
    pub fn interval(&self) -> Option<[f64; 2]> {
        Some([self.low?, self.high?])
    }
}

fn correlations(fit: &Fit) -> ByName<ByName<f64>> {
    let paths = || fit.estimates.iter().map(|e| e.parameter.path.clone());
    let row = |i: usize| {
        let others = paths().enumerate().filter(|(j, _)| *j != i);
        others
            .map(|(j, other)| (other, fit.correlations[(i, j)]))
            .collect()
    };
    paths()
        .enumerate()
        .map(|(i, path)| (path, row(i)))
        .collect()
}

fn corrections(corrected: &Corrected) -> Vec<Correction> {
    let of = |(i, correction): (usize, &correction::Correction)| {
        let fit::Estimate {
            parameter,
            value,
            interval,
        } = &correction.estimate;
        Correction {
            path: parameter.path.clone(),
            value: *value,
            low: interval.map(|[low, _]| low),
            high: interval.map(|[_, high]| high),
            nominal: correction.stated.then_some(parameter.nominal),
            probability: correction.probability,
            misfit: correction.misfit,
            unit: parameter
                .dimension
                .map_or(String::new(), |unit| unit.to_string()),
            applied: corrected.applied && i == 0,
        }
    };
    corrected.corrections.iter().enumerate().map(of).collect()
}

fn joint_relations(problem: &Problem) -> Result<ByName<JointRelation>, Error> {
    let of_runs = problem.runs.iter().map(|run| &run.settings[..]);
    let of = |joint: ClearJoint| {
        let relation = JointRelation {
            relation: joint.relation(&problem.tree)?.cloned(),
            at_clearance_m: joint.at_clearance(&problem.tree)?,
            clearance_m: joint.clearance,
        };
        Ok((joint.path, relation))
    };
    let joints = ClearJoint::in_runs(&problem.tree, of_runs)?;
    joints.into_iter().map(of).collect()
}
