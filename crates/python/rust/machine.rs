//! A machine file.

use crate::failure::{raised, wrong};
use cli::Failure;
use input::bundle::Bundle;
use input::{MachineFile, Resolved, machine_file, paths};
use pyo3::prelude::*;
use recordings::WholeFile;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use sweep::calibration::machine_of;

/// A machine file and what it describes.
#[pyclass(frozen, subclass, module = "crosshead")]
pub struct Machine {
    file: MachineFile,
    /// What it describes, in SI.
    pub resolved: Arc<Resolved>,
}

impl Machine {
    fn new(file: MachineFile) -> Result<Self, input::Error> {
        let resolved = Arc::new(file.resolve()?);
        Ok(Self { file, resolved })
    }

    /// The machine file at `path`.
    pub fn read(path: &Path) -> Result<Self, input::Error> {
        Self::new(machine_file::read(path)?)
    }

    /// The content of the file.
    pub fn tree(&self) -> &Value {
        self.file.to_tree()
    }

    /// The same machine with other values, a JSON object of paths.
    ///
    /// # Errors
    /// A path that the format does not have, or a value that does not belong there.
    pub fn with_values(&self, values: &str) -> Result<Self, Failure> {
        let values: Map<String, Value> = serde_json::from_str(values).map_err(Failure::input)?;
        let values = values
            .iter()
            .map(|(path, value)| (path.as_str(), value.clone()));
        Ok(Self::new(self.file.with_values(values)?)?)
    }
}

#[pymethods]
impl Machine {
    #[new]
    fn open(path: PathBuf) -> PyResult<Self> {
        Self::read(&path).map_err(|error| raised(error.into()))
    }

    #[staticmethod]
    fn from_yaml(text: &str) -> PyResult<Self> {
        let file = MachineFile::from_yaml(text, "machine");
        file.and_then(Self::new)
            .map_err(|error| raised(error.into()))
    }

    /// The machine section of the bundle in `folder`, at the conditions of its first run.
    #[staticmethod]
    fn from_bundle(folder: PathBuf) -> PyResult<Self> {
        let tree = Bundle::read(&folder).and_then(|bundle| machine_of(&bundle));
        let machine = tree.and_then(|tree| Self::new(MachineFile::from_tree(&tree)?));
        machine.map_err(|error| raised(error.into()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.resolved.name
    }

    #[getter]
    fn speed_rpm(&self) -> f64 {
        self.resolved.speed.to_degrees() / 6.0
    }

    #[getter]
    fn sample_rate_hz(&self) -> Option<f64> {
        self.resolved.sample_rate
    }

    /// Names of the recorded channels.
    #[getter]
    fn channels(&self) -> Vec<String> {
        let throws = self.resolved.machine.throw_names();
        let sensors = self.resolved.sensors.iter();
        sensors
            .map(|sensor| sensor.measured.column(&throws))
            .collect()
    }

    /// The machine with other values, a JSON object of paths.
    fn _with(&self, values: &str) -> PyResult<Self> {
        self.with_values(values).map_err(raised)
    }

    /// The value at a path, as JSON; none where the file says nothing.
    fn _get(&self, path: &str) -> PyResult<Option<String>> {
        let value = paths::get(self.tree(), path).map_err(wrong)?;
        Ok(value.map(Value::to_string))
    }

    fn to_yaml(&self) -> PyResult<String> {
        self.file.to_yaml().map_err(wrong)
    }

    fn save(&self, path: PathBuf) -> PyResult<()> {
        let written = WholeFile::write(&path, &self.to_yaml()?);
        written
            .map(drop)
            .map_err(|error| raised(Failure::work(error)))
    }
}
