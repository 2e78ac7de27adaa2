//! A table in memory.

use crate::column::Column;
use crate::failure::{failed, wrong};
use crate::stream::capsule;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::{DataType, SchemaRef};
use arrow_select::concat::concat;
use arrow_select::filter::filter_record_batch;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};

/// Columns of numbers, texts and recordings, with units, descriptions and roles.
///
/// Every library that knows Arrow's PyCapsule interface reads it without a copy: `polars.DataFrame(table)`,
/// `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`, `duckdb.sql("from table")`.
#[pyclass(frozen, module = "crosshead")]
pub struct Table {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

impl Table {
    /// The table of these batches of one schema.
    pub fn new(schema: SchemaRef, batches: Vec<RecordBatch>) -> Self {
        Self { schema, batches }
    }

    /// The table of one batch.
    pub fn of_batch(batch: RecordBatch) -> Self {
        Self::new(batch.schema(), vec![batch])
    }

    /// Its rows, batch by batch.
    pub fn batches(&self) -> &[RecordBatch] {
        &self.batches
    }

    /// The column `index` in one piece: its own memory where the table is one.
    fn array(&self, index: usize) -> PyResult<ArrayRef> {
        let pieces: Vec<&dyn Array> = self
            .batches
            .iter()
            .map(|b| b.column(index).as_ref())
            .collect();
        match self.batches.as_slice() {
            [batch] => Ok(batch.column(index).clone()),
            [] => Ok(arrow_array::new_empty_array(
                self.schema.field(index).data_type(),
            )),
            _ => concat(&pieces).map_err(failed),
        }
    }

    /// What the fields say under `key`.
    fn said<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyDict>> {
        let said = PyDict::new(py);
        for field in self.schema.fields() {
            if let Some(value) = field.metadata().get(key) {
                said.set_item(field.name(), value)?;
            }
        }
        Ok(said)
    }
}

#[pymethods]
impl Table {
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore what it cannot give without a copy.
        let _ = requested_schema;
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, self.schema.clone());
        capsule(py, Box::new(reader))
    }

    /// Names of the columns, in order.
    #[getter]
    fn names(&self) -> Vec<String> {
        let fields = self.schema.fields().iter();
        fields.map(|field| field.name().clone()).collect()
    }

    /// Unit of each column that has one.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.said(py, "unit")
    }

    /// What each column means.
    #[getter]
    fn descriptions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.said(py, "description")
    }

    /// Role of each column that has one: `identifier`, `label`, `condition`, `unknown`, `feature` or `signal`.
    #[getter]
    fn roles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.said(py, "role")
    }

    /// Rows.
    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    fn __repr__(&self) -> String {
        let columns = self.schema.fields().len();
        format!(
            "<crosshead.Table: {} rows, {columns} columns>",
            self.__len__()
        )
    }

    fn __contains__(&self, name: &str) -> bool {
        self.schema.index_of(name).is_ok()
    }

    /// A column as a NumPy array: numbers without gaps are not copied. A number that is missing is NaN. Texts are an
    /// array of objects, recordings an array of float32 arrays.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let index = self.schema.index_of(name).map_err(|_| {
            let names = self.names();
            let nearest = input::nearest(name, names.iter().map(String::as_str));
            let hint = nearest.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            PyKeyError::new_err(format!("no column `{name}`{hint}"))
        })?;
        numpy_of(py, self.array(index)?)
    }

    /// The rows for which `keep`, a sequence of bools, is true.
    fn filter(&self, keep: Vec<bool>) -> PyResult<Self> {
        if keep.len() != self.__len__() {
            let (found, rows) = (keep.len(), self.__len__());
            return Err(wrong(format!(
                "keep: found {found} values, expected {rows}, one for each row"
            )));
        }
        let mut from = 0;
        let mut batches = Vec::new();
        for batch in &self.batches {
            let mask = keep[from..from + batch.num_rows()].to_vec();
            from += batch.num_rows();
            let kept = filter_record_batch(batch, &mask.into());
            batches.push(kept.map_err(failed)?);
        }
        Ok(Self::new(self.schema.clone(), batches))
    }

    /// The table with these columns alone, in this order.
    fn select(&self, names: Vec<String>) -> PyResult<Self> {
        let indices: Result<Vec<usize>, _> = names
            .iter()
            .map(|name| self.schema.index_of(name))
            .collect();
        let indices = indices.map_err(|error| PyKeyError::new_err(error.to_string()))?;
        let schema = self.schema.project(&indices).map_err(failed)?;
        let batches: Result<Vec<_>, _> = self.batches.iter().map(|b| b.project(&indices)).collect();
        Ok(Self::new(schema.into(), batches.map_err(failed)?))
    }
}

/// An array as NumPy has it.
fn numpy_of(py: Python<'_>, array: ArrayRef) -> PyResult<Bound<'_, PyAny>> {
    let array = match array.data_type() {
        DataType::Float32 | DataType::Float64 | DataType::Int64 if array.null_count() > 0 => {
            with_nan(&array)
        }
        _ => array,
    };
    if let Some(column) = Column::new(array.clone()) {
        return column.into_numpy(py);
    }
    let numpy = py.import("numpy")?;
    let objects = numpy.call_method1("empty", (array.len(), "object"))?;
    match array.data_type() {
        DataType::Utf8 => {
            let texts: Vec<Option<&str>> = array.as_string::<i32>().iter().collect();
            objects.set_item(py.Ellipsis(), PyList::new(py, texts)?)?;
        }
        DataType::Boolean if array.null_count() == 0 => {
            let flags: Vec<bool> = array.as_boolean().iter().flatten().collect();
            return numpy.call_method1("array", (flags,));
        }
        DataType::List(_) => {
            for (row, samples) in array.as_list::<i32>().iter().enumerate() {
                let samples = samples.map(|samples| numpy_of(py, samples)).transpose()?;
                objects.set_item(row, samples)?;
            }
        }
        other => return Err(failed(format!("no NumPy array holds {other}"))),
    }
    Ok(objects)
}

/// Numbers with NaN where one is missing.
fn with_nan(array: &ArrayRef) -> ArrayRef {
    let numbers: Vec<Option<f64>> = match array.data_type() {
        DataType::Float32 => {
            let numbers = array.as_primitive::<Float32Type>().iter();
            numbers.map(|number| number.map(f64::from)).collect()
        }
        DataType::Float64 => array.as_primitive::<Float64Type>().iter().collect(),
        _ => {
            let numbers = array.as_primitive::<Int64Type>().iter();
            numbers.map(|number| number.map(|n| n as f64)).collect()
        }
    };
    let numbers = numbers.into_iter().map(|n| n.unwrap_or(f64::NAN));
    std::sync::Arc::new(Float64Array::from_iter_values(numbers))
}
