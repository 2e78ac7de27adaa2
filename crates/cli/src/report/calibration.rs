//! The page of a calibration, from what `crosshead calibrate` has written.

use super::gas;
use crate::Failure;
use ::calibrate::calibration::MACHINE;
use ::calibrate::converter;
use ::calibrate::pictures::{ORDERS, WAVEFORMS};
use ::calibrate::recorded_sensor::RecordedSensor;
use ::calibrate::results::RESULTS;
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use ::report::calibration_page::{
    Bounded, CalibrationPage, Channel, Converter, Correction, Estimate, Forecast, Hypothesis,
    Known, Misfit, Noise, OrderResidual, Point, Run, Sensor, Transfer,
};
use input::paths;
use input::unit::{self, Dimension};
use recordings::Table;
use recordings::formats::parquet::read_table;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Whether a calibration has written into `folder`.
pub(crate) fn is_at(folder: &Path) -> bool {
    folder.join(RESULTS).is_file()
}

/// What the page of the calibration in `folder` tells.
///
/// # Errors
/// A file that cannot be read, or is none that a calibration writes.
pub(crate) fn page(folder: &Path) -> Result<CalibrationPage, Failure> {
    let path = folder.join(RESULTS);
    let results = Results::read(&path)?;
    let machine = input::machine_file::read(&folder.join(MACHINE))?;
    let tree = machine.to_tree();
    let number = |key: &str| results.number(&results.content["fit"], &format!("fit.{key}"), key);
    let held_out = &results.content["fit"]["heldout_calibrated"];
    let fit = &results.content["fit"];
    let parameters = results.entries("parameters")?;
    let mut estimates = Vec::new();
    for (path, content) in &parameters {
        estimates.push(results.estimate(path, content, tree)?);
    }
    let row = |path: &String| -> Vec<f64> {
        let of = |other: &String| match path == other {
            true => 1.0,
            false => results.content["correlations"][path][other]
                .as_f64()
                .unwrap_or(0.0),
        };
        parameters.iter().map(|(other, _)| of(other)).collect()
    };
    Ok(CalibrationPage {
        name: machine_name(tree),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        optimiser: results.content["optimiser"]
            .as_str()
            .unwrap_or("unknown")
            .to_owned(),
        evaluations: results.content["evaluations"].as_u64().unwrap_or(0),
        complete: results.content["complete"].as_bool().unwrap_or(true),
        adequate: results.content["model_is_adequate"] != false,
        corrections: results.corrections(),
        fitted: Misfit {
            before: number("nominal")?,
            after: number("calibrated")?,
        },
        held_out: match held_out.as_f64() {
            Some(after) => Some(Misfit {
                before: results.number(fit, "fit.heldout_nominal", "heldout_nominal")?,
                after,
            }),
            None => None,
        },
        correlations: parameters.iter().map(|(path, _)| row(path)).collect(),
        parameters: estimates,
        runs: runs(folder, &results, ["nominal", "calibrated"])?,
        sensors: results.sensors()?,
        gas: gas::chambers(folder, &results.content["gas"])?,
        transfer: transfer(&results.content),
    })
}

pub(super) fn machine_name(tree: &Value) -> String {
    tree["name"].as_str().unwrap_or("machine").to_owned()
}

/// `calibration.json`, or `gap.json`.
pub(super) struct Results<'a> {
    path: &'a Path,
    pub content: Value,
}

impl<'a> Results<'a> {
    pub fn read(path: &'a Path) -> Result<Self, Failure> {
        let wrong = |reason: String| Failure::input(format!("{}: {reason}", path.display()));
        let text = files::read_text(path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        let content = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        Ok(Self { path, content })
    }

    fn wrong(&self, key: &str, expected: &str) -> Failure {
        Failure::input(format!(
            "{}: {key}: expected {expected}; this is no result of this program",
            self.path.display()
        ))
    }

    pub fn number(&self, section: &Value, place: &str, key: &str) -> Result<f64, Failure> {
        section[key]
            .as_f64()
            .ok_or_else(|| self.wrong(place, "a number"))
    }

    /// The entries of a section, in the order of the file.
    fn entries(&self, key: &str) -> Result<Vec<(String, Value)>, Failure> {
        let section = self.content[key].as_object();
        let section = section.ok_or_else(|| self.wrong(key, "a section"))?;
        let entries = section.iter().map(|(k, v)| (k.clone(), v.clone()));
        Ok(entries.collect())
    }

    fn corrections(&self) -> Vec<Correction> {
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let of = |content: &Value| {
            let text = |key: &str| content[key].as_str().unwrap_or_default().to_owned();
            Correction {
                path: text("path"),
                unit: text("unit"),
                nominal: content["nominal"].as_f64(),
                value: number(&content["value"]),
                interval: bounded(content).interval,
                probability: number(&content["probability"]),
                misfit: number(&content["misfit"]),
                applied: content["applied"] == true,
            }
        };
        let all = self.content["corrections"].as_array();
        all.into_iter().flatten().map(of).collect()
    }

    fn sensors(&self) -> Result<Vec<Sensor>, Failure> {
        let noise = &self.content["noise"];
        if noise.is_null() {
            return Ok(Vec::new());
        }
        let found: BTreeMap<String, RecordedSensor> = Deserialize::deserialize(noise)
            .map_err(|error| self.wrong("noise", &format!("the sensors by column ({error})")))?;
        Ok(found.into_iter().map(sensor).collect())
    }

    fn estimate(&self, path: &str, content: &Value, tree: &Value) -> Result<Estimate, Failure> {
        let number = |key: &str| self.number(content, &format!("parameters.{path}.{key}"), key);
        let identifiable = content["identifiable"] == true;
        Ok(Estimate {
            path: path.to_owned(),
            unit: unit_of(tree, path),
            nominal: number("nominal")?,
            value: number("value")?,
            known: match (identifiable, content["low"].is_null()) {
                (false, _) => Known::Nothing,
                (true, true) => Known::Fitted,
                (true, false) => Known::Within([number("low")?, number("high")?]),
            },
            at_bound: content["at_bound"] == true,
            reason: content["reason"].as_str().unwrap_or_default().to_owned(),
        })
    }
}

/// A measuring chain as the page has it.
fn sensor((column, found): (String, RecordedSensor)) -> Sensor {
    let reason = found.noise.noise_reason.unwrap_or_default();
    Sensor {
        column,
        noise: match (found.noise.rms, found.noise.at_most) {
            (Some(rms), _) => Noise::Known {
                rms,
                of_signal: found.noise.of_signal,
                pink_share: found.noise.pink_share.unwrap_or(0.0),
            },
            (None, Some(rms)) => Noise::AtMost { rms, reason },
            (None, None) => Noise::Unknown { reason },
        },
        converter: match found.converter {
            converter::Converter::RangeAssumed {
                resolution,
                bits_needed,
                bits,
                range,
            } => Converter::RangeAssumed {
                resolution,
                bits_needed,
                bits,
                range,
            },
            converter::Converter::RangePerRun {
                resolution,
                finest,
                bits,
            } => Converter::RangePerRun {
                resolution,
                finest,
                bits,
            },
            converter::Converter::Encoder { resolution, bits } => {
                Converter::Encoder { resolution, bits }
            }
            converter::Converter::Unknown { converter_reason } => Converter::Unknown {
                reason: converter_reason,
            },
        },
        sample_rate_hz: found.sample_rate_hz,
    }
}

/// What the relations between clearances come to; none where it was not asked.
fn transfer(content: &Value) -> Option<Transfer> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let entries = |value: &Value| value.as_object().cloned().unwrap_or_default();
    let relations = &content["relations"];
    let decision = &relations["decision"];
    let hypothesis = |content: &Value| Hypothesis {
        relation: text(&content["relation"]),
        exponents: entries(&content["exponents"])
            .into_iter()
            .map(|(path, value)| (path, bounded(&value)))
            .collect(),
        fitted: content["fitted"].as_f64().unwrap_or(f64::NAN),
        held_out: content["held_out"].as_f64(),
        criterion: content["criterion"].as_f64(),
    };
    let forecast = |content: &Value| Forecast {
        run: text(&content["run"]),
        relation: text(&content["relation"]),
        clearances: entries(&content["clearance_m"])
            .into_iter()
            .map(|(path, value)| (path, value.as_f64().unwrap_or(f64::NAN)))
            .collect(),
        peaks: entries(&content["channels"])
            .into_iter()
            .map(|(column, shown)| {
                let recorded = shown["recorded"][1].as_f64();
                (column, bounded(&shown["peak"]), recorded)
            })
            .collect(),
    };
    relations.is_object().then(|| Transfer {
        left: list(&decision["relations"]).iter().map(text).collect(),
        by_held_out: decision["runs"] == "held_out",
        relations: list(&relations["compared"])
            .iter()
            .map(hypothesis)
            .collect(),
        forecasts: list(&content["predictions"]).iter().map(forecast).collect(),
    })
}

pub(super) fn bounded(content: &Value) -> Bounded {
    let ends = content["low"].as_f64().zip(content["high"].as_f64());
    Bounded {
        value: content["value"].as_f64().unwrap_or(f64::NAN),
        interval: ends.map(|(low, high)| [low, high]),
    }
}

/// The unit of a value of the machine file; empty for a pure number.
fn unit_of(tree: &Value, path: &str) -> String {
    let offset = format!(".{path}");
    if offset.ends_with(&format!(".{CRANK_ANGLE_OFFSET}")) {
        return "rad".to_owned();
    }
    // A value of one run alone stands behind the run's name.
    let names = offset.match_indices('.').map(|(i, _)| &offset[i + 1..]);
    let value = names
        .filter_map(|name| paths::get(tree, name).ok().flatten())
        .next();
    let measure = value
        .and_then(Value::as_str)
        .and_then(|text| unit::parse(text).ok());
    match measure {
        Some(measure) if measure.dimension != Dimension::NONE => measure.dimension.to_string(),
        _ => String::new(),
    }
}

/// The runs, with their curves where the files of these are there; `before` and `after` are the
/// keys of their misfits.
fn runs(folder: &Path, results: &Results, [before, after]: [&str; 2]) -> Result<Vec<Run>, Failure> {
    let mut runs = Vec::new();
    for (id, content) in results.entries("runs")? {
        let number = |key: &str| results.number(&content, &format!("runs.{id}.{key}"), key);
        runs.push(Run {
            held_out: content["held_out"] == true,
            misfit: Misfit {
                before: number(before)?,
                after: number(after)?,
            },
            channels: Vec::new(),
            id,
        });
    }
    with_curves(folder, runs)
}

/// The runs with their curves, where the files of these are there.
pub(super) fn with_curves(folder: &Path, mut runs: Vec<Run>) -> Result<Vec<Run>, Failure> {
    let names = [
        "crank_angle_deg",
        "measured",
        "scatter",
        "noise",
        "before",
        "after",
    ];
    rows(&folder.join(WAVEFORMS), &mut runs, names, |channel, row| {
        let [crank_angle_deg, measured, scatter, noise, before, after] = row;
        channel.waveform.push(Point {
            crank_angle_deg,
            measured,
            scatter,
            noise,
            before,
            after,
        });
    })?;
    let names = ["order", "before", "after"];
    rows(&folder.join(ORDERS), &mut runs, names, |channel, row| {
        let [order, before, after] = row;
        channel.orders.push(OrderResidual {
            order,
            before,
            after,
        });
    })?;
    Ok(runs)
}

/// Adds the rows of a file to the channels that they are of; a file that is not there has none.
fn rows<const N: usize>(
    path: &Path,
    runs: &mut [Run],
    names: [&str; N],
    add: impl Fn(&mut Channel, [f64; N]),
) -> Result<(), Failure> {
    if !path.is_file() {
        return Ok(());
    }
    let wrong = |error: recordings::Error| Failure::input(format!("{}: {error}", path.display()));
    let table: Table = read_table(path).map_err(wrong)?;
    let ids = table.values::<String>("run").map_err(wrong)?;
    let columns = table.values::<String>("channel").map_err(wrong)?;
    let values = names
        .iter()
        .map(|name| table.values::<f64>(name))
        .collect::<Result<Vec<_>, _>>()
        .map_err(wrong)?;
    for (i, (id, column)) in ids.iter().zip(columns).enumerate() {
        let (Some(id), Some(column)) = (id, column) else {
            continue;
        };
        let Some(run) = runs.iter_mut().find(|run| run.id == *id) else {
            continue;
        };
        if run.channels.last().is_none_or(|c| c.column != *column)
            && !run.channels.iter().any(|c| c.column == *column)
        {
            run.channels.push(Channel {
                column: column.clone(),
                ..Channel::default()
            });
        }
        let row = std::array::from_fn(|c| values[c][i].unwrap_or(f64::NAN));
        if let Some(channel) = run.channels.iter_mut().find(|c| c.column == *column) {
            add(channel, row);
        }
    }
    Ok(())
}
