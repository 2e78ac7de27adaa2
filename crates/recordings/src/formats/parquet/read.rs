//! Parquet to tables: our own, and those of other programs.

use super::pages::{self, Announced};
use super::widened;
use crate::measured::expansion;
use crate::{Column, Data, Error, Kind, Role, Schema, Table};
use arrow_array::cast::AsArray;
use arrow_array::{Array, RecordBatch};
use arrow_schema::{DataType, Field, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReader,
    ParquetRecordBatchReaderBuilder,
};
use parquet::basic::Compression;
use parquet::file::FOOTER_SIZE;
use parquet::file::metadata::PageIndexPolicy;
use parquet::file::metadata::{FooterTail, ParquetMetaData, ParquetMetaDataReader};
use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Rows decoded at a time.
const BATCH_ROWS: usize = 1 << 12;

/// A Parquet file whose columns can be read by name.
pub struct ParquetFile {
    path: PathBuf,
    file: File,
    metadata: ArrowReaderMetadata,
    announced: Announced,
    rows: usize,
    schema: Schema,
}

/// Reads every column of a file whose type tables have.
///
/// # Errors
/// When the file is not there, is damaged or is not a Parquet file.
pub fn read_table(path: &Path) -> Result<Table, Error> {
    let file = ParquetFile::open(path)?;
    let names: Vec<_> = file
        .schema
        .columns()
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    file.read(&names, 0..file.rows)
}

/// The rows that the footer of a file of `bytes` bytes states; `read` reads a range of it.
///
/// # Errors
/// When it is not a Parquet file, or `read` fails.
pub fn rows_of_footer<E: std::fmt::Display>(
    bytes: u64,
    read: impl Fn(Range<u64>) -> Result<Vec<u8>, E>,
    path: &Path,
) -> Result<u64, Error> {
    let read = |range| read(range).map_err(damaged(path));
    guarded(path, || {
        let end = bytes.checked_sub(FOOTER_SIZE as u64);
        let end = end.ok_or_else(|| damaged(path)("it is too short"))?;
        let tail: [u8; FOOTER_SIZE] = read(end..bytes)?
            .try_into()
            .map_err(|_| damaged(path)("it is too short"))?;
        let tail = FooterTail::try_new(&tail).map_err(damaged(path))?;
        let start = end.checked_sub(tail.metadata_length() as u64);
        let start = start.ok_or_else(|| damaged(path)("its footer is longer than the file"))?;
        let footer = read(start..end)?;
        let metadata = ParquetMetaDataReader::decode_metadata(&footer).map_err(damaged(path))?;
        u64::try_from(metadata.file_metadata().num_rows()).map_err(damaged(path))
    })
}

impl ParquetFile {
    /// Opens a file and reads what it says about itself.
    ///
    /// # Errors
    /// When the file is not there, is damaged or is not a Parquet file.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let file = files::open(path).map_err(Error::io("open", path))?;
        guarded(path, || {
            // Without an index of pages: it could name others than those whose headers are read here.
            let options = ArrowReaderOptions::new().with_page_index_policy(PageIndexPolicy::Skip);
            let metadata = ArrowReaderMetadata::load(&file, options).map_err(damaged(path))?;
            if let Some(reason) = unread_codec(metadata.metadata()) {
                return Err(damaged(path)(reason));
            }
            let announced = pages::announced(&file, metadata.metadata()).map_err(damaged(path))?;
            let length = file.metadata().map_err(Error::io("read", path))?.len();
            let most = expansion::most_of(length);
            if announced.bytes > most {
                return Err(damaged(path)(expansion::exceeded(most)));
            }
            let rows = metadata.metadata().file_metadata().num_rows();
            Ok(Self {
                path: path.to_owned(),
                rows: usize::try_from(rows).map_err(damaged(path))?,
                schema: schema(&metadata)?,
                announced,
                file: file.try_clone().map_err(Error::io("open", path))?,
                metadata,
            })
        })
    }

    /// The columns of a type that tables have. Columns of other types (dates, lists of lists, ...)
    /// stand beside them in the file and are left alone. A column of float32 is one of real
    /// numbers, narrower whole numbers are whole numbers, and lists of float64 are rounded to
    /// float32.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Some columns of some rows, the columns in the order asked for.
    ///
    /// # Errors
    /// When a column or a row is not there, tables do not have the column's type, or the
    /// file is damaged.
    pub fn read(&self, columns: &[&str], rows: Range<usize>) -> Result<Table, Error> {
        self.check_rows(&rows)?;
        let wanted = columns
            .iter()
            .map(|name| self.wanted(name))
            .collect::<Result<Vec<_>, _>>()?;
        let schema = Schema::new(wanted)?.with_metadata(self.schema.metadata().clone());
        let mut data: Vec<Data> = schema
            .columns()
            .iter()
            .map(|c| Data::empty(c.kind))
            .collect();
        guarded(&self.path, || {
            self.decode(columns, rows.clone(), &schema, &mut data)
        })?;
        if let Some(short) = data.iter().find(|data| data.len() != rows.len()) {
            let reason = format!("{} rows where it announces {}", short.len(), rows.len());
            return Err(damaged(&self.path)(reason));
        }
        Table::from_columns(schema, data)
    }

    pub(super) fn check_rows(&self, rows: &Range<usize>) -> Result<(), Error> {
        if rows.start <= rows.end && rows.end <= self.rows {
            return Ok(());
        }
        Err(Error::NoSuchRows {
            path: self.path.clone(),
            start: rows.start,
            end: rows.end,
            rows: self.rows,
        })
    }

    /// The rows of some columns from the first to the last, `rows` at a time, in the order asked
    /// for.
    ///
    /// # Errors
    /// When a column is not there, or tables do not have its type. Damage is found on the way.
    pub(crate) fn batches_of(
        &self,
        columns: &[&str],
        rows: usize,
    ) -> Result<impl Iterator<Item = Result<Table, Error>> + Send + use<>, Error> {
        let wanted = columns.iter().map(|name| self.wanted_samples(name));
        let wanted = Schema::new(wanted.collect::<Result<_, _>>()?)?;
        let path = self.path.clone();
        let mut batches = guarded(&path, || self.reader(columns, 0..self.rows, rows))?;
        let mut ended = false;
        Ok(std::iter::from_fn(move || {
            if ended {
                return None;
            }
            let read = guarded(&path, || {
                let Some(batch) = batches.next() else {
                    return Ok(None);
                };
                let batch = batch.map_err(damaged(&path))?;
                table(&path, &batch, &wanted).map(Some)
            });
            ended = read.is_err();
            read.transpose()
        }))
    }

    /// The columns of points in time, with the seconds of one unit.
    pub(crate) fn points_in_time(&self) -> Vec<(&str, f64)> {
        let fields = self.metadata.schema().fields().iter();
        let points = fields.filter_map(|field| match field.data_type() {
            DataType::Timestamp(unit, _) => Some((field.name().as_str(), seconds(*unit))),
            _ => None,
        });
        points.collect()
    }

    /// The column as channels and times have it: points in time are whole numbers.
    fn wanted_samples(&self, name: &str) -> Result<Column, Error> {
        let is_point = self.points_in_time().iter().any(|(point, _)| *point == name);
        match is_point {
            true => Ok(Column::new(name, Kind::Integer, "").optional()),
            false => self.wanted(name),
        }
    }

    /// Whether the file has the column in float32.
    pub(crate) fn is_single_precision(&self, name: &str) -> bool {
        let field = self.metadata.schema().field_with_name(name);
        field.is_ok_and(|field| *field.data_type() == DataType::Float32)
    }

    fn decode(
        &self,
        columns: &[&str],
        rows: Range<usize>,
        schema: &Schema,
        data: &mut [Data],
    ) -> Result<(), Error> {
        let mut texts = 0;
        for batch in self.batches(columns, rows)? {
            let batch = batch.map_err(damaged(&self.path))?;
            for (column, data) in schema.columns().iter().zip(&mut *data) {
                let before = data.len();
                append_column(&self.path, &batch, &column.name, data)?;
                if let Data::Text(values) = data {
                    let new = values[before..].iter().flatten();
                    texts += new.map(|text| text.len() as u64).sum::<u64>();
                }
            }
            if texts > expansion::ALWAYS {
                return Err(damaged(&self.path)(expansion::exceeded(expansion::ALWAYS)));
            }
        }
        Ok(())
    }

    pub(super) fn wanted(&self, name: &str) -> Result<Column, Error> {
        let missing = match self.schema.position(name) {
            Ok(position) => return Ok(self.schema.columns()[position].clone()),
            Err(missing) => missing,
        };
        let field = self.metadata.schema().field_with_name(name);
        Err(field.map_or(missing, |field| Error::ColumnType {
            path: self.path.clone(),
            column: name.to_owned(),
            found: field.data_type().to_string(),
        }))
    }

    /// A reader of some rows of some columns, in the order of the file, so many at a time that their texts fit.
    pub(super) fn batches(
        &self,
        columns: &[&str],
        rows: Range<usize>,
    ) -> Result<ParquetRecordBatchReader, Error> {
        // However long the texts of a batch are, they fit.
        let texts = expansion::ALWAYS / self.announced.longest_text.max(1);
        let most = usize::try_from(texts).map_or(BATCH_ROWS, |rows| rows.clamp(1, BATCH_ROWS));
        let at_a_time = most.min(rows.len().max(1));
        self.reader(columns, rows, at_a_time)
    }

    fn reader(
        &self,
        columns: &[&str],
        rows: Range<usize>,
        at_a_time: usize,
    ) -> Result<ParquetRecordBatchReader, Error> {
        let file = self
            .file
            .try_clone()
            .map_err(Error::io("open", &self.path))?;
        let roots = columns
            .iter()
            .filter_map(|name| self.metadata.schema().index_of(name).ok());
        let mask = ProjectionMask::roots(self.metadata.parquet_schema(), roots);
        ParquetRecordBatchReaderBuilder::new_with_metadata(file, self.metadata.clone())
            .with_projection(mask)
            .with_batch_size(at_a_time)
            .with_offset(rows.start)
            .with_limit(rows.len())
            .build()
            .map_err(damaged(&self.path))
    }
}

/// That a column is compressed by a codec that is not built in, and what to do.
fn unread_codec(metadata: &ParquetMetaData) -> Option<String> {
    let mut columns = metadata.row_groups().iter().flat_map(|group| group.columns());
    let is_read = |codec| matches!(codec, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_));
    let column = columns.find(|column| !is_read(column.compression()))?;
    let codec = column.compression().to_string();
    let codec = codec.split('(').next().unwrap_or_default();
    let name = column.column_path().string();
    Some(format!(
        "column `{name}` is compressed with {codec}, which is not read: write the file with zstd, snappy or no compression"
    ))
}

/// Seconds of a unit of time.
fn seconds(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e-3,
        TimeUnit::Microsecond => 1e-6,
        TimeUnit::Nanosecond => 1e-9,
    }
}

fn append_column(
    path: &Path,
    batch: &RecordBatch,
    name: &str,
    data: &mut Data,
) -> Result<(), Error> {
    let missing = || damaged(path)(format!("column `{name}` is not in its row groups"));
    let array = batch.column_by_name(name).ok_or_else(missing)?;
    append(array, data).map_err(damaged(path))
}

/// A batch as a table of the columns of `schema`.
fn table(path: &Path, batch: &RecordBatch, schema: &Schema) -> Result<Table, Error> {
    let mut data = Vec::new();
    for column in schema.columns() {
        let mut values = Data::empty(column.kind);
        append_column(path, batch, &column.name, &mut values)?;
        data.push(values);
    }
    Table::from_columns(schema.clone(), data)
}

/// The result of `read`: the Parquet library takes some damage to page headers (one flipped byte in 2000) for a mistake of
/// its own.
pub(super) fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    super::super::guarded::guarded(read, || damaged(path)("its pages contradict each other"))
}

pub(super) fn damaged<E: ToString>(path: &Path) -> impl FnOnce(E) -> Error {
    let path = path.to_owned();
    move |error| Error::Damaged {
        format: "Parquet",
        path,
        reason: error.to_string(),
    }
}

fn schema(metadata: &ArrowReaderMetadata) -> Result<Schema, Error> {
    let fields = metadata.schema().fields().iter();
    let columns = fields.filter_map(|field| column(field)).collect();
    let keys = metadata.metadata().file_metadata().key_value_metadata();
    let keys = keys.into_iter().flatten().filter(|key| !is_ours(&key.key));
    let keys = keys.filter_map(|key| Some((key.key.clone(), key.value.clone()?)));
    Ok(Schema::new(columns)?.with_metadata(keys.collect()))
}

/// Keys that are made from the columns, or by the Parquet library.
fn is_ours(key: &str) -> bool {
    matches!(
        key,
        "ARROW:schema" | "PANDAS_ATTRS" | "units" | "descriptions"
    )
}

fn column(field: &Field) -> Option<Column> {
    Some(Column {
        name: field.name().clone(),
        kind: kind(field.data_type())?,
        unit: field.metadata().get("unit").cloned(),
        description: field
            .metadata()
            .get("description")
            .cloned()
            .unwrap_or_default(),
        role: field.metadata().get("role").and_then(|name| Role::from_name(name)),
        optional: field.is_nullable(),
    })
}

fn kind(data_type: &DataType) -> Option<Kind> {
    match data_type {
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => Some(Kind::Text),
        DataType::Dictionary(_, values) => {
            kind(values).filter(|kind| matches!(kind, Kind::Text | Kind::Real | Kind::Integer))
        }
        DataType::Float16 | DataType::Float32 | DataType::Float64 => Some(Kind::Real),
        DataType::Decimal128(..) => Some(Kind::Real),
        DataType::Boolean => Some(Kind::Flag),
        DataType::List(item) | DataType::LargeList(item)
            if matches!(item.data_type(), DataType::Float32 | DataType::Float64) =>
        {
            Some(Kind::Samples)
        }
        whole if whole.is_integer() => Some(Kind::Integer),
        _ => None,
    }
}

/// Appends an array of the kind of `data`, with an error in words when a value has no place in it.
fn append(array: &dyn Array, data: &mut Data) -> Result<(), String> {
    match data {
        Data::Text(values) => values.extend(widened::texts(array)?),
        Data::Integer(values) => values.extend(widened::integers(array)?),
        Data::Real(values) => values.extend(widened::reals(array)?),
        Data::Flag(values) => values.extend(array.as_boolean().iter()),
        Data::Samples(values) => values.extend(widened::samples(array)?),
    }
    Ok(())
}
