//! Tables to Parquet, row group by row group.

use crate::formats::record_batch::{ELEMENT, fields, with_schema};
use crate::{Error, Kind, Schema, Table, Value};
use arrow_schema::{Schema as ArrowSchema, SchemaRef};
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
        let arrow_schema = ArrowSchema::new_with_metadata(fields(schema), key_values.clone());
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
        let batch = with_schema(&self.arrow_schema, &self.pending)?;
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
    let batch = with_schema(&writer.arrow_schema, table)?;
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
