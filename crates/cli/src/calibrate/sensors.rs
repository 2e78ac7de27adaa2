//! The measuring chain as the recordings show it: `noise` of `calibration.json`, and a summary.

use crate::Failure;
use ::calibrate::converter::Converter;
use ::calibrate::fit::ADEQUATE;
use ::calibrate::likelihood::Likelihood;
use ::calibrate::recorded_sensor::{
    Look, RecordedNoise, RecordedSensor, recorded_sensors, sample_rate,
};
use ::calibrate::{Problem, Run, sensor_section};
use serde::Deserialize;
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
    by_column: BTreeMap<String, RecordedSensor>,
    sample_rate: Option<f64>,
}

impl Sensors {
    /// Those that the recordings show.
    ///
    /// # Errors
    /// A run that cannot be simulated.
    pub fn of(model: &Fitted) -> Result<Self, Failure> {
        let predictions = Likelihood::new(model.problem).predictions(model.x);
        let predictions = predictions.map_err(Failure::work)?;
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
    pub fn write(&self, tree: &mut Value) -> Result<(), Failure> {
        sensor_section::write(tree, &self.by_column, self.sample_rate).map_err(Failure::work)
    }

    /// What `calibration.json` says of them.
    ///
    /// # Errors
    /// None that is known.
    pub fn results(&self) -> Result<Value, Failure> {
        let results = serde_json::to_value(&self.by_column);
        let mut results = results.map_err(Failure::work)?;
        let sensors = results.as_object_mut().into_iter().flatten();
        for sensor in sensors.filter_map(|(_, sensor)| sensor.as_object_mut()) {
            // Other programs look these up, whatever is known of a converter.
            for key in ["bits", "range"] {
                sensor.entry(key).or_insert(Value::Null);
            }
        }
        Ok(results)
    }
}

/// The sensors that a file of results has, by column; none where it has no such section.
///
/// # Errors
/// A section that this program has not written, in words.
pub(crate) fn read(noise: &Value) -> Result<BTreeMap<String, RecordedSensor>, serde_json::Error> {
    match noise {
        Value::Null => Ok(BTreeMap::new()),
        noise => BTreeMap::deserialize(noise),
    }
}

/// Prints the sensors.
pub fn summary(sensors: &BTreeMap<String, RecordedSensor>) {
    for (column, sensor) in sensors {
        println!(
            "sensor {column}: {}; {}",
            noise(&sensor.noise),
            converter(&sensor.converter)
        );
    }
}

fn noise(found: &RecordedNoise) -> String {
    let reason = found.noise_reason.as_deref().unwrap_or_default();
    match (found.rms, found.at_most) {
        (Some(rms), _) => {
            let share = found.of_signal.map_or(String::new(), |share| {
                format!(", {:.2} % of its signal", 100.0 * share)
            });
            let pink = 100.0 * found.pink_share.unwrap_or(0.0);
            format!("noise {rms:.3e} rms{share}, {pink:.0} % of it 1/f")
        }
        (None, Some(most)) => format!("noise unknown, at most {most:.3e} rms: {reason}"),
        (None, None) => format!("noise unknown: {reason}"),
    }
}

fn converter(found: &Converter) -> String {
    match found {
        Converter::RangeAssumed {
            resolution,
            bits_needed,
            bits,
            range,
        } => format!(
            "steps of {resolution:.3e}, {bits_needed} bits or more; its range is not identifiable, \
             {bits} bits are assumed, or {range:.3e}"
        ),
        Converter::RangePerRun {
            resolution,
            finest,
            bits,
        } => format!(
            "steps of {finest:.3e} to {resolution:.3e}, {bits} bits over a range set to each run"
        ),
        Converter::Encoder { bits, .. } => format!("{bits} bits to the turn"),
        Converter::Unknown { converter_reason } => format!("no bits: {converter_reason}"),
    }
}
