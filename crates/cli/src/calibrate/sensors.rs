//! The measuring chain as the recordings show it: `noise` of `calibration.json`, and a summary.

use super::Task;
use crate::Failure;
use ::calibrate::fit::ADEQUATE;
use ::calibrate::likelihood::Likelihood;
use ::calibrate::recorded_sensor::{Look, RecordedSensor, recorded_sensors, sample_rate};
use ::calibrate::{Fit, sensor_section};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The sensors of the recordings, by column, and their sample rate.
pub struct Sensors {
    by_column: BTreeMap<String, RecordedSensor>,
    sample_rate: Option<f64>,
}

impl Sensors {
    /// Those that the recordings of `task` show, whose machine was fitted.
    ///
    /// # Errors
    /// A run that cannot be simulated.
    pub fn of(task: &Task, fit: &Fit) -> Result<Self, Failure> {
        let x: Vec<f64> = fit.coordinates();
        let predictions = Likelihood::new(&task.problem).predictions(&x);
        let predictions = predictions.map_err(Failure::work)?;
        let looks: Vec<Look> = task
            .runs
            .iter()
            .enumerate()
            .map(|(i, run)| Look {
                run,
                observation: &task.problem.runs[i],
                prediction: (fit.runs[i].calibrated <= ADEQUATE).then_some(&predictions[i]),
                has_encoder: task.recorders[i].has_encoder,
                is_timed: task.recorders[i].is_timed,
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
    pub fn write(&self, tree: &mut Value) -> Result<(), Failure> {
        sensor_section::write(tree, &self.by_column, self.sample_rate).map_err(Failure::work)
    }

    /// What `calibration.json` says of them.
    pub fn results(&self) -> Value {
        json!(self.by_column)
    }
}

/// Prints the sensors: the content of `noise` of `calibration.json`.
pub fn summary(results: &Value) {
    for (column, sensor) in results.as_object().into_iter().flatten() {
        let number = |key: &str| sensor[key].as_f64();
        let text = |key: &str| sensor[key].as_str().unwrap_or_default();
        let noise = match (number("rms"), number("at_most")) {
            (Some(rms), _) => {
                let share = number("of_signal");
                let share = share.map_or(String::new(), |s| {
                    format!(", {:.2} % of its signal", 100.0 * s)
                });
                let pink = 100.0 * number("pink_share").unwrap_or(0.0);
                format!("noise {rms:.3e} rms{share}, {pink:.0} % of it 1/f")
            }
            (None, Some(most)) => format!(
                "noise unknown, at most {most:.3e} rms: {}",
                text("noise_reason")
            ),
            (None, None) => format!("noise unknown: {}", text("noise_reason")),
        };
        let bits = match sensor["bits"].as_u64() {
            Some(bits) => format!("{bits} bits"),
            None => format!("no bits: {}", text("range_reason")),
        };
        println!("sensor {column}: {noise}; {bits}");
    }
}
