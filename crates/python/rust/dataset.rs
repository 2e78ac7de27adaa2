//! A finished dataset.

use crate::failure::{failed, wrong};
use crate::stream::capsule;
use crate::table::Table;
use arrow_array::RecordBatchReader;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use recordings::Column;
use recordings::formats::parquet::Batches;
use std::path::PathBuf;
use sweep::reader::{Dataset, Subset};

/// What a dataset says about itself.
#[pyclass(frozen, get_all, module = "crosshead")]
pub struct Description {
    name: String,
    /// `manifest.json`.
    manifest: String,
    splits: Vec<String>,
    sample_rate_hz: f64,
    /// Of signals over the crank angle.
    samples_per_revolution: Option<u32>,
    revolutions_per_window: u32,
    /// Names of the recorded channels.
    channels: Vec<String>,
    /// Columns of the table of features, and of the recordings: name, what the values are, role, unit, description.
    features: Vec<Described>,
    signals: Vec<Described>,
}

type Described = (String, String, Option<&'static str>, Option<String>, String);

fn described(column: Column) -> Described {
    let role = column.role.map(|role| role.name());
    let kind = column.kind.to_string();
    (column.name, kind, role, column.unit, column.description)
}

/// Reads what the dataset in `folder` says about itself.
///
/// # Errors
/// A folder that is no whole dataset, or a file that is not the one that was written.
#[pyfunction]
pub fn open_dataset(py: Python<'_>, folder: PathBuf) -> PyResult<Description> {
    let read = py.detach(|| {
        let dataset = Dataset::read(&folder)?;
        let features = dataset.columns(Subset::Features)?;
        let signals = dataset.columns(Subset::Signals)?;
        Ok((dataset, features, signals))
    });
    let (dataset, features, signals) = read.map_err(|error: sweep::reader::Error| wrong(error))?;
    Ok(Description {
        name: dataset.plan.name.clone(),
        manifest: dataset.manifest().to_json().map_err(failed)?,
        splits: dataset.splits(),
        sample_rate_hz: dataset.plan.settings.sample_rate,
        samples_per_revolution: (dataset.plan.over_angle).map(|of| of.samples_per_revolution),
        revolutions_per_window: dataset.revolutions_per_window(),
        channels: dataset
            .plan
            .channels()
            .into_iter()
            .map(|(name, _)| name)
            .collect(),
        features: features.into_iter().map(described).collect(),
        signals: signals.into_iter().map(described).collect(),
    })
}

/// Some columns of Parquet files with the same columns, one after the other, decoded as they are asked for.
#[pyclass(frozen, module = "crosshead")]
pub struct ParquetFiles {
    paths: Vec<PathBuf>,
    columns: Option<Vec<String>>,
    /// The rows of the first file that count, where not all do: from, to.
    rows: Option<(usize, usize)>,
}

impl ParquetFiles {
    fn open(&self) -> Result<Batches, recordings::Error> {
        match (self.paths.first(), self.rows) {
            (Some(path), Some((from, to))) => {
                Batches::of_rows(path, self.columns.clone(), from..to)
            }
            _ => Batches::new(self.paths.clone(), self.columns.clone()),
        }
    }
}

#[pymethods]
impl ParquetFiles {
    #[new]
    #[pyo3(signature = (paths, columns = None, rows = None))]
    fn new(
        paths: Vec<PathBuf>,
        columns: Option<Vec<String>>,
        rows: Option<(usize, usize)>,
    ) -> Self {
        Self {
            paths,
            columns,
            rows,
        }
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore what it cannot give without a copy.
        let _ = requested_schema;
        capsule(py, Box::new(self.open().map_err(wrong)?))
    }

    /// All of it in memory.
    fn read(&self, py: Python<'_>) -> PyResult<Table> {
        let read = py.detach(|| {
            let batches = self.open().map_err(|error| error.to_string())?;
            let schema = batches.schema();
            let all: Result<Vec<_>, _> = batches.collect();
            Ok::<_, String>((schema, all.map_err(|error| error.to_string())?))
        });
        let (schema, batches) = read.map_err(wrong)?;
        Ok(Table::new(schema, batches))
    }

    /// Its record batches, one after the other.
    fn __iter__(&self) -> PyResult<TableIterator> {
        let batches = std::sync::Mutex::new(self.open().map_err(wrong)?);
        Ok(TableIterator { batches })
    }
}

/// The record batches of files, each as a table.
#[pyclass(frozen, module = "crosshead")]
pub struct TableIterator {
    batches: std::sync::Mutex<Batches>,
}

#[pymethods]
impl TableIterator {
    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        let next = py.detach(|| {
            let mut batches = self
                .batches
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            batches.next().transpose()
        });
        Ok(next.map_err(wrong)?.map(Table::of_batch))
    }
}
