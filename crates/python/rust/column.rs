//! A column of numbers as NumPy sees it: its memory, not a copy.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef};
use arrow_schema::DataType;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Numbers without gaps in the memory of Rust. `numpy.asarray(column)` reads them where they are, and keeps them alive.
#[pyclass(frozen, module = "crosshead")]
pub struct Column(ArrayRef);

impl Column {
    /// The column of this array; none of one that is not plain numbers, or has gaps.
    pub fn new(array: ArrayRef) -> Option<Self> {
        let numbers = matches!(
            array.data_type(),
            DataType::Float32 | DataType::Float64 | DataType::Int64
        );
        (numbers && array.null_count() == 0).then_some(Self(array))
    }

    /// The address of the first number, and the type of all of them as NumPy writes it.
    fn memory(&self) -> (usize, &'static str) {
        let array = &self.0;
        match array.data_type() {
            DataType::Float32 => {
                let values = array.as_primitive::<Float32Type>().values();
                (values.as_ptr() as usize, "<f4")
            }
            DataType::Float64 => {
                let values = array.as_primitive::<Float64Type>().values();
                (values.as_ptr() as usize, "<f8")
            }
            _ => {
                let values = array.as_primitive::<Int64Type>().values();
                (values.as_ptr() as usize, "<i8")
            }
        }
    }

    /// As a NumPy array that reads this memory, and cannot write to it.
    ///
    /// # Errors
    /// Where NumPy is not installed.
    pub fn into_numpy(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        py.import("numpy")?.call_method1("asarray", (self,))
    }
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// NumPy's array interface, version 3; read only.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (address, kind) = self.memory();
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (self.0.len(),))?;
        interface.set_item("typestr", kind)?;
        interface.set_item("data", (address, true))?;
        interface.set_item("strides", py.None())?;
        Ok(interface)
    }
}
