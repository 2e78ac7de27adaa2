//! Tables to Parquet, row group by row group.

use crate::{Column, Data, Error, Kind, Schema, Table, Value};
use arrow::array::{
    ArrayRef, BooleanArray, Float32Array, Float64Array, Int64Array, ListArray, RecordBatch,
    StringArray,
};
use arrow::buffer::{NullBuffer, OffsetBuffer};
use arrow::datatypes::{DataType, Field, Metadata, Schema as ArrowSchema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::schema::types::ColumnPath;
use std::collections::BTreeMap;
use std::io::Write;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Named in every file; the program's version stands in the dataset's manifest.
const CREATED_BY: &str = "crosshead";

/// Name of the values within a list, as the Parquet standard has it.
const ELEMENT: &str = "element";

/// Samples that are collected before they are encoded together (1 MiB of float32).
const PENDING_SAMPLES: usize = 1 << 18;

/// Rows that are collected before they are encoded together.
pub const PENDING_ROWS: usize = 1 << 12;

/// Bytes of a page before compression: a column collects as many, and so does what compresses them.
const PAGE_BYTES: usize = 1 << 18;

/// Writes a table row by row.
///
/// The memory that it takes is that of one encoded row group and of a few megabytes of rows that
/// are not encoded yet. The bytes depend on the rows and on `rows_per_group` alone.
pub struct TableWriter<W: Write + Send> {
    out: ArrowWriter<W>,
    arrow_schema: SchemaRef,
    pending: Table,
    pending_samples: usize,
    rows: u64,
}

impl<W: Write + Send> TableWriter<W> {
    /// Starts a table in groups of `rows_per_group` rows. A reader loads one group at a time, and the writer
    /// keeps a group encoded until it is complete. A few MiB of samples per group suit most.
    ///
    /// # Errors
    /// When `rows_per_group` is 0, or the writer fails.
    pub fn new(out: W, schema: &Schema, rows_per_group: usize) -> Result<Self, Error> {
        let rows_per_group = NonZeroUsize::new(rows_per_group).ok_or(Error::EmptyRowGroup)?;
        let key_values = key_values(schema)?;
        let fields: Vec<Field> = schema.columns().iter().map(arrow_field).collect();
        let arrow_schema = ArrowSchema::new_with_metadata(fields, key_values.clone());
        let arrow_schema = Arc::new(arrow_schema);
        let properties = properties(schema, key_values, rows_per_group)?;
        let out =
            ArrowWriter::try_new(out, arrow_schema.clone(), Some(properties)).map_err(encode)?;
        Ok(Self {
            out,
            arrow_schema,
            pending: Table::new(schema.clone()),
            pending_samples: 0,
            rows: 0,
        })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// When the row does not fit the schema (nothing is then appended), or the writer fails.
    pub fn write(&mut self, row: Vec<Value>) -> Result<(), Error> {
        let samples: usize = row.iter().map(samples_of).sum();
        self.pending.push(row)?;
        self.pending_samples += samples;
        self.rows += 1;
        if self.pending_samples >= PENDING_SAMPLES || self.pending.rows() >= PENDING_ROWS {
            self.encode_pending()?;
        }
        Ok(())
    }

    /// Rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Ends the table (one without rows is a valid one) and hands the writer back.
    ///
    /// # Errors
    /// When the writer fails.
    pub fn finish(mut self) -> Result<W, Error> {
        self.encode_pending()?;
        self.out.into_inner().map_err(encode)
    }

    fn encode_pending(&mut self) -> Result<(), Error> {
        let batch = record_batch(&self.arrow_schema, &self.pending)?;
        self.out.write(&batch).map_err(encode)?;
        self.pending = Table::new(self.pending.schema().clone());
        self.pending_samples = 0;
        Ok(())
    }
}

/// Writes a whole table in groups of `rows_per_group` rows, and hands the writer back.
///
/// # Errors
/// When `rows_per_group` is 0, or the writer fails.
pub fn write_table<W: Write + Send>(
    out: W,
    table: &Table,
    rows_per_group: usize,
) -> Result<W, Error> {
    let mut writer = TableWriter::new(out, table.schema(), rows_per_group)?;
    let batch = record_batch(&writer.arrow_schema, table)?;
    writer.out.write(&batch).map_err(encode)?;
    writer.finish()
}

fn samples_of(value: &Value) -> usize {
    match value {
        Value::Samples(samples) => samples.len(),
        _ => 0,
    }
}

fn encode(error: ParquetError) -> Error {
    Error::encode("Parquet", error)
}

/// The file's own keys: those of the table, `units` and `descriptions`, and what pandas looks for.
fn key_values(schema: &Schema) -> Result<BTreeMap<String, String>, Error> {
    let columns = schema.columns().iter();
    let units: BTreeMap<_, _> = columns
        .clone()
        .filter_map(|c| Some((&c.name, c.unit.as_ref()?)))
        .collect();
    let descriptions: BTreeMap<_, _> = columns.map(|c| (&c.name, &c.description)).collect();
    let json = |value: &BTreeMap<_, _>| {
        serde_json::to_string(value).map_err(|error| Error::encode("JSON", error))
    };
    let mut keys = schema.metadata().clone();
    keys.insert(
        "PANDAS_ATTRS".into(),
        format!(r#"{{"units":{}}}"#, json(&units)?),
    );
    keys.insert("units".into(), json(&units)?);
    keys.insert("descriptions".into(), json(&descriptions)?);
    Ok(keys)
}

fn arrow_field(column: &Column) -> Field {
    let data_type = match column.kind {
        Kind::Text => DataType::Utf8,
        Kind::Integer => DataType::Int64,
        Kind::Real => DataType::Float64,
        Kind::Flag => DataType::Boolean,
        Kind::Samples => DataType::List(element()),
    };
    let mut metadata = Metadata::from([("description", column.description.clone())]);
    metadata.extend(column.unit.iter().map(|unit| ("unit", unit.clone())));
    metadata.extend(column.role.map(|role| ("role", role.name().to_owned())));
    Field::new(&column.name, data_type, column.optional).with_metadata(metadata)
}

fn element() -> Arc<Field> {
    Arc::new(Field::new(ELEMENT, DataType::Float32, false))
}

fn properties(
    schema: &Schema,
    key_values: BTreeMap<String, String>,
    rows_per_group: NonZeroUsize,
) -> Result<WriterProperties, Error> {
    let keys = key_values
        .into_iter()
        .map(|(key, value)| KeyValue::new(key, value));
    let level = ZstdLevel::try_new(3).map_err(encode)?;
    let mut properties = WriterProperties::builder()
        .set_created_by(CREATED_BY.into())
        .set_key_value_metadata(Some(keys.collect()))
        .set_compression(Compression::ZSTD(level))
        .set_dictionary_enabled(false)
        .set_data_page_size_limit(PAGE_BYTES)
        .set_max_row_group_row_count(Some(rows_per_group.get()));
    for column in schema.columns() {
        let name = column.name.clone();
        properties = match column.kind {
            Kind::Text => {
                properties.set_column_dictionary_enabled(ColumnPath::new(vec![name]), true)
            }
            Kind::Real => properties
                .set_column_encoding(ColumnPath::new(vec![name]), Encoding::BYTE_STREAM_SPLIT),
            Kind::Samples => {
                let path = ColumnPath::new(vec![name, "list".into(), ELEMENT.into()]);
                properties
                    .set_column_encoding(path.clone(), Encoding::BYTE_STREAM_SPLIT)
                    .set_column_statistics_enabled(path, EnabledStatistics::None)
            }
            Kind::Integer | Kind::Flag => properties,
        };
    }
    Ok(properties.build())
}

fn record_batch(schema: &SchemaRef, table: &Table) -> Result<RecordBatch, Error> {
    let arrays = table
        .columns()
        .iter()
        .map(array)
        .collect::<Result<_, _>>()?;
    RecordBatch::try_new(schema.clone(), arrays).map_err(|error| Error::encode("Parquet", error))
}

fn array(data: &Data) -> Result<ArrayRef, Error> {
    Ok(match data {
        Data::Text(values) => {
            Arc::new(values.iter().map(Option::as_deref).collect::<StringArray>())
        }
        Data::Integer(values) => Arc::new(values.iter().collect::<Int64Array>()),
        Data::Real(values) => Arc::new(values.iter().collect::<Float64Array>()),
        Data::Flag(values) => Arc::new(values.iter().collect::<BooleanArray>()),
        Data::Samples(values) => Arc::new(list_array(values)?),
    })
}

fn list_array(values: &[Option<Vec<f32>>]) -> Result<ListArray, Error> {
    let mut offsets = vec![0];
    let mut samples = Vec::new();
    for row in values {
        samples.extend_from_slice(row.as_deref().unwrap_or_default());
        offsets
            .push(i32::try_from(samples.len()).map_err(|error| Error::encode("Parquet", error))?);
    }
    let offsets = OffsetBuffer::new(offsets.into());
    let nulls: NullBuffer = values.iter().map(Option::is_some).collect();
    Ok(ListArray::new(
        element(),
        offsets,
        Arc::new(Float32Array::from(samples)),
        Some(nulls),
    ))
}
