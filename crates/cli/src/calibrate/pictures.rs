//! What the pictures of a calibration or an explanation are drawn from: `waveforms.parquet` and `orders.parquet`.

use crate::Failure;
use ::calibrate::Comparison;
use recordings::formats::parquet;
use recordings::{Column, Data, Kind, Schema, Table, WholeFile};
use std::path::Path;

/// Name of the file of curves over the crank angle.
pub const WAVEFORMS: &str = "waveforms.parquet";
/// Name of the file of residuals by order.
pub const ORDERS: &str = "orders.parquet";
/// Rows per group of a Parquet file.
const ROWS_PER_GROUP: usize = 65_536;

/// Writes both files.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, comparisons: &[Comparison]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    for (name, table) in [
        (WAVEFORMS, waveforms(comparisons)),
        (ORDERS, orders(comparisons)),
    ] {
        let path = folder.join(name);
        let table = table.map_err(Failure::work)?;
        WholeFile::create(&path.with_extension("part"), &path)
            .and_then(|file| parquet::write_table(file, &table, ROWS_PER_GROUP))
            .and_then(WholeFile::commit)
            .map_err(Failure::work)?;
    }
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
