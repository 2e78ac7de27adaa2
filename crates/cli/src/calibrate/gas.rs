//! What a calibration tells about the gas: `gas` in `calibration.json`, and `indicator.parquet`.

use super::Task;
use crate::Failure;
use ::calibrate::Fit;
use ::calibrate::indicator::{Indicator, Polytrope, ValveEvents};
use ::calibrate::pressure_gap::{PressureGap, pressure_gaps};
use recordings::formats::parquet;
use recordings::{Column, Data, Kind, Schema, Table, WholeFile};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Name of the file of pressures over the piston's way.
pub const INDICATOR: &str = "indicator.parquet";
/// Rows per group of a Parquet file.
const ROWS_PER_GROUP: usize = 65_536;

/// The recorded pressures beside those of the fit; none in a bundle without a cylinder pressure.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn gaps(task: &Task, fit: &Fit) -> Result<Vec<PressureGap>, Failure> {
    let coordinate = |e: &::calibrate::fit::Estimate| e.parameter.coordinate(e.value);
    let x: Vec<f64> = fit.estimates.iter().map(coordinate).collect();
    pressure_gaps(&task.problem, &task.runs, &x).map_err(Failure::work)
}

/// Per run and channel: the misfit in Pa and where in the cycle it is, lines and exponents of the
/// recording by itself, effective valve events measured and fitted.
pub fn results(gaps: &[PressureGap]) -> Value {
    let mut runs: Map<String, Value> = Map::new();
    for gap in gaps {
        let of_run = runs.entry(gap.run.clone()).or_insert_with(|| json!({}));
        of_run[gap.column.as_str()] = of_channel(gap);
    }
    runs.into()
}

fn of_channel(gap: &PressureGap) -> Value {
    let [nominal, calibrated] = gap.rms();
    let phases: Vec<Value> = gap
        .phases()
        .iter()
        .map(|phase| {
            json!({
                "phase": phase.name,
                "crank_angle_deg": phase.angles.map(f64::to_degrees),
                "rms_pa": phase.rms,
                "share": phase.share,
            })
        })
        .collect();
    json!({
        "rms_pa": {"nominal": nominal, "calibrated": calibrated},
        "where": phases,
        "measured": gap.indicator.as_ref().map(diagram),
        "calibrated": gap.fitted_indicator.as_ref().map(diagram),
    })
}

fn diagram(indicator: &Indicator) -> Value {
    let stroke = indicator.chamber.stroke();
    let polytrope = |p: &Polytrope| {
        json!({
            "crank_angle_deg": p.angles.map(f64::to_degrees),
            "exponent": p.exponent,
            "exponent_per_clearance_share": p.exponent_per_clearance * stroke,
            "scatter": p.scatter,
        })
    };
    json!({
        "suction_pa": indicator.suction.pressure,
        "discharge_pa": indicator.discharge.pressure,
        "clearance_share": indicator.chamber.clearance / stroke,
        "compression": polytrope(&indicator.compression),
        "expansion": polytrope(&indicator.expansion),
        "alternatives": indicator.alternatives.map(|other| json!({
            "clearance_share": other.clearance / stroke,
            "compression_exponent": other.exponents[0],
            "expansion_exponent": other.exponents[1],
            "scatter": other.scatter,
        })),
        "valve_events": events(&indicator.events),
    })
}

fn events(events: &ValveEvents) -> Value {
    let all = [
        ("suction_opens", &events.suction_opens),
        ("suction_closes", &events.suction_closes),
        ("discharge_opens", &events.discharge_opens),
        ("discharge_closes", &events.discharge_closes),
    ];
    let of = |(name, event): (&str, &::calibrate::indicator::Event)| {
        let [low, high] = event.quartiles.map(f64::to_degrees);
        let angle = event.angle.to_degrees();
        let content = json!({"crank_angle_deg": angle, "low": low, "high": high});
        (name.to_owned(), content)
    };
    all.map(of).into_iter().collect::<Map<_, _>>().into()
}

/// Writes the pressures over the crank angle and the piston's distance from the cover.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, gaps: &[PressureGap]) -> Result<(), Failure> {
    let path = folder.join(INDICATOR);
    WholeFile::create(&path.with_extension("part"), &path)
        .and_then(|file| parquet::write_table(file, &table(gaps)?, ROWS_PER_GROUP))
        .and_then(WholeFile::commit)
        .map(drop)
        .map_err(Failure::work)
}

fn table(gaps: &[PressureGap]) -> Result<Table, recordings::Error> {
    let text = |of: fn(&PressureGap) -> &String| {
        let rows = gaps
            .iter()
            .flat_map(|gap| std::iter::repeat_n(Some(of(gap).clone()), gap.angles.len()));
        Data::Text(rows.collect())
    };
    let real = |of: &dyn Fn(&PressureGap, usize) -> Option<f64>| {
        let rows = gaps
            .iter()
            .flat_map(|gap| (0..gap.angles.len()).map(move |i| of(gap, i)));
        Data::Real(rows.collect())
    };
    let column =
        |name: &str, unit: &str, about: &str| Column::new(name, Kind::Real, about).unit(unit);
    let distance = |indicator: &Option<Indicator>, angle: f64| {
        let chamber = indicator.as_ref()?.chamber;
        Some(chamber.distance(angle))
    };
    Table::from_columns(
        Schema::new(vec![
            Column::new("run", Kind::Text, "the run"),
            Column::new("channel", Kind::Text, "column of the recording"),
            column(
                "crank_angle_deg",
                "deg",
                "crank angle, a fitted offset taken off",
            ),
            column(
                "distance_m",
                "m",
                "piston to cover, at the nominal clearance",
            ),
            column(
                "fitted_distance_m",
                "m",
                "piston to cover, at the calibrated clearance",
            ),
            column("measured_pa", "Pa", "recorded pressure"),
            column("nominal_pa", "Pa", "pressure with the nominal parameters"),
            column(
                "calibrated_pa",
                "Pa",
                "pressure with the calibrated parameters",
            ),
        ])?,
        vec![
            text(|gap| &gap.run),
            text(|gap| &gap.column),
            real(&|gap, i| Some(gap.angles[i].to_degrees())),
            real(&|gap, i| distance(&gap.indicator, gap.angles[i])),
            real(&|gap, i| distance(&gap.fitted_indicator, gap.angles[i])),
            real(&|gap, i| Some(gap.measured[i])),
            real(&|gap, i| Some(gap.nominal[i])),
            real(&|gap, i| Some(gap.fitted[i])),
        ],
    )
}

/// Prints what the results tell about the gas: `gas` in `calibration.json`.
pub fn summary(gas: &Value) {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    for (run, channels) in gas.as_object().into_iter().flatten() {
        for (column, found) in channels.as_object().into_iter().flatten() {
            let rms = ["nominal", "calibrated"].map(|key| number(&found["rms_pa"][key]) / 1e3);
            println!(
                "{run} {column}: {:.1} kPa RMS from the recording, {:.1} kPa before",
                rms[1], rms[0]
            );
            let event = |side: &str, name: &str| {
                number(&found[side]["valve_events"][name]["crank_angle_deg"])
            };
            if found["measured"].is_object() && found["calibrated"].is_object() {
                let names = ["suction_closes", "discharge_opens", "suction_opens"];
                let told = names.map(|name| {
                    format!(
                        "{} at {:.0} deg, in the fit at {:.0}",
                        name.replace('_', " "),
                        event("measured", name),
                        event("calibrated", name)
                    )
                });
                println!("  {}", told.join("; "));
            }
        }
    }
}
