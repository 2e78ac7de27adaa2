//! Recordings over the crank angle: as many points in each revolution.

use crate::column::Column;
use crate::failure::{failed, wrong};
use crate::table::Table;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, Int64Type};
use arrow_array::{ArrayRef, Float32Array, RecordBatch};
use cli::Failure;
use pyo3::prelude::*;
use rayon::prelude::*;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The column with the crank angle at each sample.
const CRANK_ANGLE: &str = "crank_angle_rad";
/// The column of signals over the crank angle.
const OF_TURN: &str = "samples_per_revolution";

/// The column of the angle at which such signals begin.
const START: &str = "start_angle_rad";

/// A row: its channels one after the other, and at which point of a revolution they begin, counted from top dead centre.
type Resampled = (Vec<f32>, usize);

/// Resamples the channels of these names, in each row of `table`, to `points` in a revolution: whole revolutions, from the
/// middle of the recording. Without a column `crank_angle_rad` the speed gives the angle, which then begins at 0.
///
/// # Errors
/// A column that is not there, a recording of less than one revolution, or fewer than 32 points.
#[pyfunction]
pub fn over_crank_angle<'py>(
    py: Python<'py>,
    table: &Table,
    channels: Vec<String>,
    points: usize,
) -> PyResult<Vec<(Bound<'py, PyAny>, usize)>> {
    if channels.is_empty() {
        return Err(wrong("channels: found none, expected one at least"));
    }
    let batches = table.batches();
    let rows: Result<Vec<Vec<Resampled>>, Failure> = py.detach(|| {
        let of_batch = |batch: &RecordBatch| {
            let rows = (0..batch.num_rows()).into_par_iter();
            rows.map(|row| resampled(batch, row, &channels, points))
                .collect()
        };
        batches.iter().map(of_batch).collect()
    });
    let mut arrays = Vec::new();
    for (samples, first) in rows.map_err(crate::failure::raised)?.into_iter().flatten() {
        let column = Column::new(Arc::new(Float32Array::from(samples)));
        let column = column.ok_or_else(|| failed("a recording without samples"))?;
        let flat = column.into_numpy(py)?;
        arrays.push((flat.call_method1("reshape", (channels.len(), -1))?, first));
    }
    Ok(arrays)
}

fn resampled(
    batch: &RecordBatch,
    row: usize,
    channels: &[String],
    points: usize,
) -> Result<Resampled, Failure> {
    let place = |error: signal::Error| Failure::input(format!("row {row}: {error}"));
    let mut grid = None;
    let mut all = Vec::new();
    let start = start(batch, row, points)?;
    let mut first = start;
    for name in channels {
        let samples = samples(batch, name, row)?;
        let grid = match &mut grid {
            Some(grid) => grid,
            none => none
                .insert(AngleGrid::new(&angle(batch, row, samples.len())?, points).map_err(place)?),
        };
        let over_angle = grid.resample(&samples).map_err(place)?;
        first = (over_angle.first_point() + start) % points;
        all.extend(over_angle.samples().iter().map(|x| *x as f32));
    }
    Ok((all, first))
}

/// The crank angle of a row of so many samples.
fn angle(batch: &RecordBatch, row: usize, count: usize) -> Result<CrankAngle, Failure> {
    let angle = match batch.column_by_name(CRANK_ANGLE) {
        Some(_) => CrankAngle::from_encoder(&samples(batch, CRANK_ANGLE, row)?),
        None => {
            let rpm = number(batch, "speed_rpm", row)?;
            CrankAngle::from_speed(count, rate(batch, row, rpm)?, rpm)
        }
    };
    angle.map_err(|error| Failure::input(format!("row {row}, crank angle: {error}")))
}

/// Samples per second of a row at its mean speed, Hz.
fn rate(batch: &RecordBatch, row: usize, rpm: f64) -> Result<f64, Failure> {
    let Some(of_turn) = batch.column_by_name(OF_TURN) else {
        return number(batch, "sample_rate_hz", row);
    };
    let of_turn = of_turn.as_primitive_opt::<Int64Type>();
    let kind = || Failure::input(format!("column `{OF_TURN}` holds no whole numbers"));
    Ok(of_turn.ok_or_else(kind)?.value(row) as f64 * rpm / 60.0)
}

/// The point at which signals begin whose angle no sensor reads.
fn start(batch: &RecordBatch, row: usize, points: usize) -> Result<usize, Failure> {
    let known = batch.column_by_name(CRANK_ANGLE).is_some();
    match batch.column_by_name(START) {
        Some(_) if !known => {
            let turns = number(batch, START, row)? / TAU;
            Ok((turns * points as f64).round() as usize)
        }
        _ => Ok(0),
    }
}

fn column<'a>(batch: &'a RecordBatch, name: &str) -> Result<&'a ArrayRef, Failure> {
    let column = batch.column_by_name(name);
    column.ok_or_else(|| Failure::input(format!("no column `{name}` in the recordings")))
}

fn samples(batch: &RecordBatch, name: &str, row: usize) -> Result<Vec<f64>, Failure> {
    let kind = || Failure::input(format!("column `{name}` holds no recordings"));
    let lists = column(batch, name)?.as_list_opt::<i32>().ok_or_else(kind)?;
    let samples = lists.value(row);
    let samples = samples.as_primitive_opt::<Float32Type>().ok_or_else(kind)?;
    Ok(samples.values().iter().map(|x| f64::from(*x)).collect())
}

fn number(batch: &RecordBatch, name: &str, row: usize) -> Result<f64, Failure> {
    let kind = || Failure::input(format!("column `{name}` holds no numbers"));
    let numbers = column(batch, name)?.as_primitive_opt::<Float64Type>();
    let numbers = numbers.ok_or_else(kind)?;
    Ok(numbers.value(row))
}
