//! Recordings in Parquet: a column per channel, or a row per recording with lists of samples.

use super::ParquetFile;
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, TimeColumn, TimeUnit, name_and_unit,
    one_rate, selected, time_unit,
};
use crate::{Column, Data, Error, Kind, Table, Value};
use std::path::Path;

/// Rows of plain columns that are decoded at a time.
const BATCH_ROWS: usize = 1 << 13;

/// The column with the sample rate of a row's lists.
const RATE: &str = "sample_rate_hz";

/// The columns with the samples in a revolution of lists over the crank angle, and with its speed.
const PER_TURN: [&str; 2] = ["samples_per_revolution", "speed_rpm"];

/// Opens a file. Where a column holds lists of samples, every row is a recording, and the other
/// columns are its labels. Otherwise the columns of numbers are the channels of one recording; the time is a column that is
/// called so, or else the first one of points in time.
pub(crate) fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let file = ParquetFile::open(path)?;
    let lists = file
        .schema()
        .columns()
        .iter()
        .any(|c| c.kind == Kind::Samples);
    match (lists, file.rows()) {
        // A split of a dataset may have no case.
        (true, _) => rows(path, &file, options),
        (false, 0) => Err(Error::damaged("Parquet", path, "it has no rows")),
        (false, _) => columns(path, &file, options),
    }
}

fn channel(column: &Column) -> MeasuredChannel {
    let (name, unit) = name_and_unit(&column.name);
    MeasuredChannel {
        column: column.name.clone(),
        name,
        unit: column.unit.clone().or(unit),
    }
}

fn columns(path: &Path, file: &ParquetFile, options: &Options) -> Result<MeasuredFile, Error> {
    let numbers = file.schema().columns().iter();
    let numbers = numbers.filter(|c| matches!(c.kind, Kind::Real | Kind::Integer));
    let (times, rest): (Vec<_>, Vec<_>) = numbers
        .map(channel)
        .partition(|c| time_unit(&c.name, c.unit.as_deref()).is_some());
    if rest.is_empty() {
        return Err(Error::damaged(
            "Parquet",
            path,
            "it has no column of numbers",
        ));
    }
    let is_there = |name: &&String| rest.iter().any(|channel| channel.is_called(name));
    if let Some(name) = options.columns.iter().find(|name| !is_there(name)) {
        // Of a type that has no numbers, it says so.
        file.wanted(name)?;
    }
    let wanted = selected(&rest, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| rest[i].clone()).collect();
    let points = file.points_in_time();
    let point = points.first().filter(|_| times.is_empty());
    let of_point = point.map(|(name, seconds)| TimeColumn {
        name: (*name).to_owned(),
        unit: TimeUnit::Seconds(*seconds),
        single_precision: false,
    });
    let time = times.first().map(|c| TimeColumn {
        name: c.column.clone(),
        unit: time_unit(&c.name, c.unit.as_deref()).unwrap_or(TimeUnit::Unstated),
        single_precision: file.is_single_precision(&c.column),
    });
    let time = time.or(of_point);
    let names = time.iter().map(|t| t.name.as_str());
    let names: Vec<&str> = names
        .chain(channels.iter().map(|c| c.column.as_str()))
        .collect();
    let samples = ColumnSamples {
        batches: Box::new(file.batches_of(&names, BATCH_ROWS)?),
        has_time: time.is_some(),
        point_s: point.map(|(_, seconds)| *seconds),
        first_point: None,
        table: None,
        next: 0,
    };
    let stated = file
        .schema()
        .metadata()
        .get(RATE)
        .and_then(|rate| rate.parse().ok());
    let rate = one_rate(path, stated, options)?;
    let count = channels.len();
    MeasuredFile::of_one(channels, Vec::new(), |labels| {
        Recording::new(path, labels, count, rate, time, samples)
    })
}

/// Plain columns, the time first where there is one.
struct ColumnSamples {
    batches: Box<dyn Iterator<Item = Result<Table, Error>> + Send>,
    has_time: bool,
    /// Seconds of one unit of the time where it holds points in time, and the first of them.
    point_s: Option<f64>,
    first_point: Option<i64>,
    table: Option<Table>,
    next: usize,
}

impl Samples for ColumnSamples {
    fn origin_s(&self) -> f64 {
        let first = self.first_point.zip(self.point_s);
        first.map_or(0.0, |(point, seconds)| point as f64 * seconds)
    }

    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let table = loop {
            match self.table.take() {
                Some(table) if self.next < table.rows() => break table,
                _ => {
                    let Some(next) = self.batches.next() else {
                        return Ok(0);
                    };
                    self.table = Some(next?);
                    self.next = 0;
                }
            }
        };
        let rows = self.next..table.rows().min(self.next.saturating_add(most));
        self.next = rows.end;
        let mut columns = table.columns().iter();
        if self.has_time
            && let Some(data) = columns.next()
        {
            let first = &mut self.first_point;
            let mut since_first =
                |point: i64| point.saturating_sub(*first.get_or_insert(point)) as f64;
            match (self.point_s, data) {
                (Some(_), Data::Integer(points)) => {
                    let points = points[rows.clone()].iter().copied();
                    times.extend(points.map(|point| point.map_or(f64::NAN, &mut since_first)));
                }
                _ => times.extend(rows.clone().map(|row| real(data, row))),
            }
        }
        for (channel, data) in channels.iter_mut().zip(columns) {
            channel.extend(rows.clone().map(|row| real(data, row)));
        }
        self.table = Some(table);
        Ok(rows.len())
    }
}

/// A number of a column; NaN where it is missing.
fn real(data: &Data, row: usize) -> f64 {
    match data {
        Data::Real(values) => values[row].unwrap_or(f64::NAN),
        Data::Integer(values) => values[row].map_or(f64::NAN, |whole| whole as f64),
        _ => f64::NAN,
    }
}

fn rows(path: &Path, file: &ParquetFile, options: &Options) -> Result<MeasuredFile, Error> {
    let all = file.schema().columns();
    let lists: Vec<_> = all
        .iter()
        .filter(|c| c.kind == Kind::Samples)
        .map(channel)
        .collect();
    let wanted = selected(&lists, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| lists[i].clone()).collect();
    let labels: Vec<Column> = all
        .iter()
        .filter(|c| c.kind != Kind::Samples && c.name != RATE)
        .map(|c| c.clone().optional())
        .collect();
    let has_rate = all.iter().any(|c| c.name == RATE && c.kind == Kind::Real);
    let names = labels.iter().map(|c| c.name.as_str());
    let names = names.chain(has_rate.then_some(RATE));
    let names: Vec<&str> = names
        .chain(channels.iter().map(|c| c.column.as_str()))
        .collect();
    let (path, options) = (path.to_owned(), options.clone());
    let (plain, lists) = (labels.len(), channels.len());
    let recordings = file.batches_of(&names, 1)?.map(move |table| {
        let table = table?;
        let labels = table.columns()[..plain].iter().map(value).collect();
        let of_file = match has_rate {
            true => table.columns().get(plain).map(|data| real(data, 0)),
            false => rate_over_angle(&table),
        };
        let of_file = of_file.filter(|rate| !rate.is_nan());
        let rate = one_rate(&path, of_file, &options)?;
        let samples = row_samples(&path, &table, table.columns().len() - lists)?;
        Recording::new(&path, labels, lists, rate, None, samples)
    });
    Ok(MeasuredFile::of_rows(channels, labels, recordings))
}

/// The mean sample rate of a row whose samples stand at equal steps of the crank angle, Hz.
fn rate_over_angle(table: &Table) -> Option<f64> {
    let columns = table.schema().columns();
    let [samples, speed_rpm] = PER_TURN.map(|name| {
        let place = columns.iter().position(|c| c.name == name)?;
        Some(real(&table.columns()[place], 0))
    });
    Some(samples? * speed_rpm? / 60.0)
}

/// The first value of a column.
fn value(data: &Data) -> Value {
    match data {
        Data::Text(values) => values[0].clone().into(),
        Data::Integer(values) => values[0].into(),
        Data::Real(values) => values[0].filter(|real| real.is_finite()).into(),
        Data::Flag(values) => values[0].into(),
        Data::Samples(_) => Value::Missing,
    }
}

/// The lists of a row, from column `first` on.
fn row_samples(path: &Path, table: &Table, first: usize) -> Result<RowSamples, Error> {
    let mut channels: Vec<Vec<f32>> = Vec::new();
    for (column, data) in table
        .schema()
        .columns()
        .iter()
        .zip(table.columns())
        .skip(first)
    {
        let Data::Samples(values) = data else {
            continue;
        };
        let samples = values[0].clone().unwrap_or_default();
        if let Some(expected) = channels.first().map(Vec::len)
            && expected != samples.len()
        {
            return Err(Error::damaged(
                "Parquet",
                path,
                format!(
                    "column `{}` has {} samples where the one before has {expected}",
                    column.name,
                    samples.len()
                ),
            ));
        }
        channels.push(samples);
    }
    Ok(RowSamples { channels, next: 0 })
}

struct RowSamples {
    channels: Vec<Vec<f32>>,
    next: usize,
}

impl Samples for RowSamples {
    fn read(
        &mut self,
        most: usize,
        _times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let there = self.channels.first().map_or(0, Vec::len);
        let rows = self.next..there.min(self.next.saturating_add(most));
        for (to, from) in channels.iter_mut().zip(&self.channels) {
            to.extend(from[rows.clone()].iter().copied().map(f64::from));
        }
        self.next = rows.end;
        Ok(rows.len())
    }
}
