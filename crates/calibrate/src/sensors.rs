//! The measuring chains that the recordings of a fitted machine show.

use crate::error::Error;
use crate::fit::ADEQUATE;
use crate::likelihood::Likelihood;
use crate::observation::Run;
use crate::problem::Problem;
use crate::recorded_sensor::{Look, RecordedSensor, recorded_sensors, sample_rate};
use crate::sensor_section;
use serde_json::Value;
use std::collections::BTreeMap;

/// A model that was fitted to recordings.
pub struct Fitted<'a> {
    /// The model, with what was observed in the runs.
    pub problem: &'a Problem,
    /// Its parameters' coordinates.
    pub x: &'a [f64],
    /// What it leaves of each run, in units of the noise.
    pub misfits: Vec<f64>,
    /// The runs as they were recorded.
    pub runs: &'a [Run],
    /// For each run whether an encoder gave the crank angle.
    pub encoded: &'a [bool],
}

/// The sensors of the recordings, by column, and their sample rate.
pub struct Sensors {
    /// Each sensor, by the column of its channel.
    pub by_column: BTreeMap<String, RecordedSensor>,
    sample_rate: Option<f64>,
}

impl Sensors {
    /// Those that the recordings show.
    ///
    /// # Errors
    /// A run that cannot be simulated.
    pub fn from_recordings(model: &Fitted) -> Result<Self, Error> {
        let predictions = Likelihood::new(model.problem).predictions(model.x)?;
        let looks: Vec<Look> = model
            .runs
            .iter()
            .enumerate()
            .map(|(i, run)| Look {
                run,
                observation: &model.problem.runs[i],
                prediction: (model.misfits[i] <= ADEQUATE).then_some(&predictions[i]),
                has_encoder: model.encoded[i],
            })
            .collect();
        Ok(Self {
            by_column: recorded_sensors(&looks),
            sample_rate: sample_rate(&looks),
        })
    }

    /// Gives the machine file `tree` these sensors.
    ///
    /// # Errors
    /// An invalid machine file.
    pub fn write(&self, tree: &mut Value) -> Result<(), Error> {
        sensor_section::write(tree, &self.by_column, self.sample_rate)
    }
}
