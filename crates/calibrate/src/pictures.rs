//! What the pictures of a calibration or an explanation are drawn from: `waveforms.parquet`, `orders.parquet`,
//! `indicator.parquet` and `steps.parquet`.

use crate::comparison::{Comparison, SimulatedMean};
use crate::error::Error;
use crate::indicator::Indicator;
use crate::pressure_gap::PressureGap;
use recordings::formats::parquet;
use recordings::formats::parquet::ROWS_PER_GROUP;
use recordings::{Column, Data, Kind, Schema, Table, WholeFile};
use std::path::Path;

/// Name of the file of curves over the crank angle.
pub const WAVEFORMS: &str = "waveforms.parquet";
/// Name of the file of residuals by order.
pub const ORDERS: &str = "orders.parquet";
/// Name of the file of curves of each step of an explanation.
pub const STEPS: &str = "steps.parquet";
/// Name of the file of pressures over the piston's way.
pub const INDICATOR: &str = "indicator.parquet";

/// Writes the curves over the crank angle and the residuals by order.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, comparisons: &[Comparison]) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
    write_table(&folder.join(WAVEFORMS), &waveforms(comparisons)?)?;
    write_table(&folder.join(ORDERS), &orders(comparisons)?)
}

/// Writes the simulated curves of each step of an explanation.
///
/// # Errors
/// A file that cannot be written.
pub fn write_steps(folder: &Path, steps: &[(String, Vec<SimulatedMean>)]) -> Result<(), Error> {
    let [mut runs, mut channels, mut labels] = [const { Vec::new() }; 3];
    let [mut angles, mut simulated] = [const { Vec::new() }; 2];
    for (label, means) in steps {
        for SimulatedMean { run, column, means } in means {
            for (i, mean) in means.iter().enumerate() {
                runs.push(Some(run.clone()));
                channels.push(Some(column.clone()));
                labels.push(Some(label.clone()));
                angles.push(Some(360.0 * i as f64 / means.len() as f64));
                simulated.push(Some(*mean));
            }
        }
    }
    let angle = Column::new(
        "crank_angle_deg",
        Kind::Real,
        "crank angle from top dead centre",
    );
    let table = Table::from_columns(
        Schema::new(vec![
            Column::new("run", Kind::Text, "the run"),
            Column::new("channel", Kind::Text, "column of the recording"),
            Column::new(
                "step",
                Kind::Text,
                "what the model has that the one before has not",
            ),
            angle.unit("deg"),
            Column::new(
                "simulated",
                Kind::Real,
                "mean of the simulation, in the unit of the channel",
            ),
        ])?,
        vec![
            Data::Text(runs),
            Data::Text(channels),
            Data::Text(labels),
            Data::Real(angles),
            Data::Real(simulated),
        ],
    )?;
    write_table(&folder.join(STEPS), &table)
}

/// Writes the pressures over the crank angle and the piston's distance from the cover.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_indicator(folder: &Path, gaps: &[PressureGap]) -> Result<(), Error> {
    write_table(&folder.join(INDICATOR), &indicator(gaps)?)
}

/// Writes a table that appears whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_table(path: &Path, table: &Table) -> Result<(), Error> {
    let file = WholeFile::create(&path.with_extension("part"), path)?;
    parquet::write_table(file, table, ROWS_PER_GROUP)?.commit()?;
    Ok(())
}

fn waveforms(comparisons: &[Comparison]) -> Result<Table, recordings::Error> {
    table(
        comparisons,
        |comparison| &comparison.means,
        &[
            (
                "crank_angle_deg",
                "deg",
                "crank angle from top dead centre",
                &|comparison, i| 360.0 * i as f64 / comparison.means.len() as f64,
            ),
            (
                "measured",
                "",
                "mean of the measured revolutions, in the unit of the channel",
                &|comparison, i| comparison.means[i].measured,
            ),
            (
                "scatter",
                "",
                "standard deviation from revolution to revolution",
                &|comparison, i| comparison.means[i].scatter,
            ),
            (
                "noise",
                "",
                "standard deviation of the measured mean",
                &|comparison, i| comparison.means[i].noise,
            ),
            (
                "before",
                "",
                "mean of the simulation before: with nominal parameters, or without an effect",
                &|comparison, i| comparison.means[i].before,
            ),
            (
                "after",
                "",
                "mean of the simulation after: with calibrated parameters, or with the effect",
                &|comparison, i| comparison.means[i].after,
            ),
        ],
    )
}

fn orders(comparisons: &[Comparison]) -> Result<Table, recordings::Error> {
    table(
        comparisons,
        |comparison| &comparison.orders,
        &[
            (
                "order",
                "",
                "multiple of the crank's speed",
                &|comparison, i| comparison.orders[i].order as f64,
            ),
            (
                "before",
                "",
                "difference of amplitudes over the standard deviation of its noise, before",
                &|comparison, i| comparison.orders[i].before,
            ),
            ("after", "", "the same after", &|comparison, i| {
                comparison.orders[i].after
            }),
        ],
    )
}

/// Name, unit and meaning of a column, and the value of a comparison's row in it.
type Of<'a> = (
    &'a str,
    &'a str,
    &'a str,
    &'a dyn Fn(&Comparison, usize) -> f64,
);

/// The rows of all comparisons, led by run and channel.
fn table<'a, T: 'a>(
    comparisons: &'a [Comparison],
    rows: impl Fn(&'a Comparison) -> &'a Vec<T>,
    values: &[Of],
) -> Result<Table, recordings::Error> {
    let mut columns = vec![
        Column::new("run", Kind::Text, "the run"),
        Column::new("channel", Kind::Text, "column of the recording"),
    ];
    let text = |of: fn(&Comparison) -> &String| {
        let all = comparisons.iter().flat_map(|comparison| {
            std::iter::repeat_n(Some(of(comparison).clone()), rows(comparison).len())
        });
        Data::Text(all.collect())
    };
    let mut data = vec![text(|c| &c.run), text(|c| &c.column)];
    for (name, unit, about, value) in values {
        let column = Column::new(*name, Kind::Real, *about);
        columns.push(if unit.is_empty() {
            column
        } else {
            column.unit(*unit)
        });
        let all = comparisons.iter().flat_map(|comparison| {
            (0..rows(comparison).len()).map(move |i| Some(value(comparison, i)))
        });
        data.push(Data::Real(all.collect()));
    }
    Table::from_columns(Schema::new(columns)?, data)
}

fn indicator(gaps: &[PressureGap]) -> Result<Table, recordings::Error> {
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
