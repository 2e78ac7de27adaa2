//! Tables as Arrow record batches.

use crate::{Column, Data, Error, Kind, Schema, Table};
use arrow_array::{
    ArrayRef, BooleanArray, Float32Array, Float64Array, Int64Array, ListArray, RecordBatch,
    StringArray,
};
use arrow_buffer::{NullBuffer, OffsetBuffer};
use arrow_schema::{DataType, Field, Metadata, Schema as ArrowSchema, SchemaRef};
use std::sync::Arc;

/// Name of the values within a list, as the Parquet standard has it.
pub(super) const ELEMENT: &str = "element";

/// A table as one record batch. Units, descriptions and roles stand with each field.
///
/// # Errors
/// More samples in a column than Arrow can count.
pub fn record_batch(table: &Table) -> Result<RecordBatch, Error> {
    let metadata = table.schema().metadata().clone();
    let schema = ArrowSchema::new_with_metadata(fields(table.schema()), metadata);
    with_schema(&Arc::new(schema), table)
}

/// The columns as Arrow has them.
pub(super) fn fields(schema: &Schema) -> Vec<Field> {
    schema.columns().iter().map(arrow_field).collect()
}

/// A column as Arrow has it.
pub fn arrow_field(column: &Column) -> Field {
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

/// A table as a record batch with this schema.
pub(super) fn with_schema(schema: &SchemaRef, table: &Table) -> Result<RecordBatch, Error> {
    let arrays = table
        .columns()
        .iter()
        .map(array)
        .collect::<Result<_, _>>()?;
    RecordBatch::try_new(schema.clone(), arrays).map_err(|error| Error::encode("Arrow", error))
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
        offsets.push(i32::try_from(samples.len()).map_err(|error| Error::encode("Arrow", error))?);
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
