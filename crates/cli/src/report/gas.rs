//! What a calibration found about the gas, for its page: `gas` of `calibration.json`, and
//! `indicator.parquet`.

use crate::Failure;
use ::calibrate::pictures::INDICATOR;
use ::report::calibration_page::{Chamber, Diagram, Misfit, Phase, Pressure};
use recordings::Table;
use recordings::formats::parquet::read_table;
use serde_json::Value;
use std::path::Path;

/// The chambers whose pressures were recorded, with their curves where the file of these is there.
///
/// # Errors
/// A file that is not what a calibration writes.
pub(super) fn chambers(folder: &Path, gas: &Value) -> Result<Vec<Chamber>, Failure> {
    let mut chambers: Vec<Chamber> = Vec::new();
    for (run, columns) in gas.as_object().into_iter().flatten() {
        for (column, found) in columns.as_object().into_iter().flatten() {
            chambers.push(chamber(run, column, found));
        }
    }
    let path = folder.join(INDICATOR);
    if !chambers.is_empty() && path.is_file() {
        points(&path, &mut chambers)?;
    }
    Ok(chambers)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn chamber(run: &str, column: &str, found: &Value) -> Chamber {
    let phase = |content: &Value| Phase {
        name: content["phase"].as_str().unwrap_or_default().to_owned(),
        crank_angle_deg: [0, 1].map(|i| number(&content["crank_angle_deg"][i])),
        rms_pa: number(&content["rms_pa"]),
        share: number(&content["share"]),
    };
    let phases = found["where"].as_array().into_iter().flatten();
    Chamber {
        run: run.to_owned(),
        column: column.to_owned(),
        rms_pa: Misfit {
            before: number(&found["rms_pa"]["nominal"]),
            after: number(&found["rms_pa"]["calibrated"]),
        },
        phases: phases.map(phase).collect(),
        measured: diagram(&found["measured"]),
        calibrated: diagram(&found["calibrated"]),
        points: Vec::new(),
    }
}

fn diagram(content: &Value) -> Option<Diagram> {
    let both = ["compression", "expansion"];
    let events = content["valve_events"].as_object()?;
    let alternatives = content["alternatives"].as_array().into_iter().flatten();
    Some(Diagram {
        clearance: number(&content["clearance_share"]),
        exponents: both.map(|key| number(&content[key]["exponent"])),
        polytropes: both.map(|key| [0, 1].map(|i| number(&content[key]["crank_angle_deg"][i]))),
        events: events
            .iter()
            .map(|(name, event)| {
                let range = ["low", "high"].map(|key| number(&event[key]));
                (name.clone(), number(&event["crank_angle_deg"]), range)
            })
            .collect(),
        alternatives: alternatives
            .map(|other| {
                let exponents = both.map(|key| number(&other[format!("{key}_exponent")]));
                (
                    number(&other["clearance_share"]),
                    exponents,
                    number(&other["scatter"]),
                )
            })
            .collect(),
    })
}

/// Adds the rows of the file to the chambers that they are of.
fn points(path: &Path, chambers: &mut [Chamber]) -> Result<(), Failure> {
    let wrong = |error: recordings::Error| Failure::input(format!("{}: {error}", path.display()));
    let table: Table = read_table(path).map_err(wrong)?;
    let text = |name: &str| table.values::<String>(name).map_err(wrong);
    let (runs, columns) = (text("run")?, text("channel")?);
    let names = [
        "crank_angle_deg",
        "distance_m",
        "fitted_distance_m",
        "measured_pa",
        "nominal_pa",
        "calibrated_pa",
    ];
    let values = names
        .iter()
        .map(|name| table.values::<f64>(name))
        .collect::<Result<Vec<_>, _>>()
        .map_err(wrong)?;
    for (i, (run, column)) in runs.iter().zip(columns).enumerate() {
        let of =
            |c: &&mut Chamber| Some(&c.run) == run.as_ref() && Some(&c.column) == column.as_ref();
        let at = |c: usize| values[c][i].unwrap_or(f64::NAN);
        if let Some(chamber) = chambers.iter_mut().find(of) {
            chamber.points.push(Pressure {
                crank_angle_deg: at(0),
                distance_m: [at(1), at(2)],
                measured_pa: at(3),
                simulated_pa: [at(4), at(5)],
            });
        }
    }
    Ok(())
}
