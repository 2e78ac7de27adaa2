//! What a calibration has written, read back for its page.

use super::{CalibrationPage, Channel, Misfit, OrderResidual, Point, Pressure, Run};
use crate::Error;
use calibrate::pictures::{INDICATOR, ORDERS, STEPS, WAVEFORMS};
use calibrate::results::{MACHINE, RESULTS, Results};
use calibrate::run_condition::unit;
use recordings::Table;
use recordings::formats::parquet::read_table;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

impl CalibrationPage {
    /// The page of the calibration in `folder`.
    ///
    /// # Errors
    /// A file that cannot be read, or that no calibration writes.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let results = Results::read(&folder.join(RESULTS))?;
        let machine = input::machine_file::read(&folder.join(MACHINE))?;
        let tree = machine.to_tree();
        let parameters = results.parameters.iter();
        let runs = results.runs.iter().map(|(id, run)| Run {
            id: id.to_owned(),
            held_out: run.held_out,
            misfit: Misfit {
                before: run.nominal,
                after: run.calibrated,
            },
            channels: Vec::new(),
        });
        Ok(Self {
            name: machine_name(tree),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            units: parameters.map(|(path, _)| unit(tree, path)).collect(),
            runs: with_curves(folder, runs.collect())?,
            pressures: pressures(folder)?,
            results,
        })
    }
}

pub(crate) fn machine_name(tree: &Value) -> String {
    tree["name"].as_str().unwrap_or("machine").to_owned()
}

/// The runs with their curves, where the files of these are there.
pub(crate) fn with_curves(folder: &Path, mut runs: Vec<Run>) -> Result<Vec<Run>, Error> {
    let names = [
        "crank_angle_deg",
        "measured",
        "scatter",
        "noise",
        "before",
        "after",
    ];
    rows(&folder.join(WAVEFORMS), names, |run, column, row| {
        let [crank_angle_deg, measured, scatter, noise, before, after] = row;
        if let Some(channel) = channel(&mut runs, run, column) {
            channel.waveform.push(Point {
                crank_angle_deg,
                measured,
                scatter,
                noise,
                before,
                after,
            });
        }
    })?;
    let path = folder.join(STEPS);
    let labels = texts(&path, "step")?;
    let mut row_labels = labels.into_iter();
    rows(&path, ["simulated"], |run, column, [simulated]| {
        let label = row_labels.next().unwrap_or_default();
        if let Some(channel) = channel(&mut runs, run, column) {
            match channel.steps.last_mut() {
                Some((last, means)) if *last == label => means.push(simulated),
                _ => channel.steps.push((label, vec![simulated])),
            }
        }
    })?;
    let names = ["order", "before", "after"];
    rows(&folder.join(ORDERS), names, |run, column, row| {
        let [order, before, after] = row;
        if let Some(channel) = channel(&mut runs, run, column) {
            channel.orders.push(OrderResidual {
                order,
                before,
                after,
            });
        }
    })?;
    Ok(runs)
}

/// The channel of a run, which is added where the run does not have it yet.
fn channel<'a>(runs: &'a mut [Run], run: &str, column: &str) -> Option<&'a mut Channel> {
    let channels = &mut runs.iter_mut().find(|r| r.id == run)?.channels;
    let known = channels.iter().position(|c| c.column == column);
    let place = known.unwrap_or(channels.len());
    if known.is_none() {
        channels.push(Channel {
            column: column.to_owned(),
            ..Channel::default()
        });
    }
    channels.get_mut(place)
}

/// The pressures of each chamber, by run and column.
fn pressures(folder: &Path) -> Result<BTreeMap<String, BTreeMap<String, Vec<Pressure>>>, Error> {
    let names = [
        "crank_angle_deg",
        "distance_m",
        "fitted_distance_m",
        "measured_pa",
        "nominal_pa",
        "calibrated_pa",
    ];
    let mut pressures: BTreeMap<String, BTreeMap<String, Vec<Pressure>>> = BTreeMap::new();
    rows(&folder.join(INDICATOR), names, |run, column, row| {
        let [
            crank_angle_deg,
            distance,
            fitted,
            measured_pa,
            nominal,
            calibrated,
        ] = row;
        let of_run = pressures.entry(run.to_owned()).or_default();
        let of_column = of_run.entry(column.to_owned()).or_default();
        of_column.push(Pressure {
            crank_angle_deg,
            distance_m: [distance, fitted],
            measured_pa,
            simulated_pa: [nominal, calibrated],
        });
    })?;
    Ok(pressures)
}

/// The texts of a column of a file; none where the file is not there.
fn texts(path: &Path, name: &str) -> Result<Vec<String>, Error> {
    if !path.is_file() {
        return Ok(Vec::new());
    }
    let wrong = |error: recordings::Error| Error::Curves {
        path: path.to_owned(),
        error,
    };
    let table: Table = read_table(path).map_err(wrong)?;
    let values = table.values::<String>(name).map_err(wrong)?.iter();
    Ok(values
        .map(|text| text.clone().unwrap_or_default())
        .collect())
}

/// Gives `add` run, channel and values of each row of a file; a file that is not there has none.
fn rows<const N: usize>(
    path: &Path,
    names: [&str; N],
    mut add: impl FnMut(&str, &str, [f64; N]),
) -> Result<(), Error> {
    if !path.is_file() {
        return Ok(());
    }
    let wrong = |error: recordings::Error| Error::Curves {
        path: path.to_owned(),
        error,
    };
    let table: Table = read_table(path).map_err(wrong)?;
    let ids = table.values::<String>("run").map_err(wrong)?;
    let columns = table.values::<String>("channel").map_err(wrong)?;
    let values = names
        .iter()
        .map(|name| table.values::<f64>(name))
        .collect::<Result<Vec<_>, _>>()
        .map_err(wrong)?;
    for (i, (id, column)) in ids.iter().zip(columns).enumerate() {
        if let (Some(id), Some(column)) = (id, column) {
            let row = std::array::from_fn(|c| values[c][i].unwrap_or(f64::NAN));
            add(id, column, row);
        }
    }
    Ok(())
}
