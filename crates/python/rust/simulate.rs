//! One run of a machine.

use crate::column::Column;
use crate::failure::{failed, raised, wrong};
use crate::interruptible::{Shared, interruptible};
use crate::machine::Machine;
use crate::table::Table;
use ::simulate::settings::TOLERANCES;
use ::simulate::{Record, Settings, Transient};
use arrow_array::cast::AsArray;
use arrow_array::types::Float32Type;
use arrow_array::{ArrayRef, Float32Array, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Metadata, Schema};
use cli::Failure;
use input::Resolved;
use input::quantity::{AboveZero, Frequency, Quantity};
use pyo3::prelude::*;
use recordings::Role;
use recordings::formats::record_batch::record_batch;
use scalar::random::{Purpose, stream};
use signal::channel::Channel;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;
use sweep::run_analysis::RunAnalysis;
use sweep::run_table::run_table;

/// What a run left behind.
#[pyclass(frozen, subclass, module = "crosshead")]
pub struct Run {
    machine: Arc<Resolved>,
    record: Record,
    batch: RecordBatch,
    /// Time that simulating and measuring took, s.
    seconds: f64,
}

/// Simulates one run: `values` are changes of the machine as JSON, `sample_rate` a text with its unit.
///
/// # Errors
/// Wrong arguments, an integration that fails, or Ctrl-C.
#[pyfunction]
#[pyo3(signature = (machine, values, revolutions, transient, sample_rate, tolerance, seed, progress))]
pub fn simulate(
    py: Python<'_>,
    machine: &Machine,
    values: &str,
    revolutions: u32,
    transient: u32,
    sample_rate: Option<&str>,
    tolerance: f64,
    seed: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Run> {
    let changed = match values {
        "{}" => None,
        values => Some(machine.with_values(values).map_err(raised)?),
    };
    let machine = changed.as_ref().unwrap_or(machine).resolved.clone();
    let default = Settings::default();
    let asked = sample_rate.map(rate).transpose()?;
    let settings = Settings {
        transient: Transient::Revolutions(transient),
        revolutions,
        sample_rate: asked.or(machine.sample_rate).unwrap_or(default.sample_rate),
        tolerance,
        ..default
    };
    if revolutions == 0 {
        return Err(wrong("revolutions: found 0, expected 1 or more"));
    }
    let [least, most] = TOLERANCES;
    if !(least..=most).contains(&tolerance) {
        let expected = format!("expected a number from {least:e} to {most:e}");
        return Err(wrong(format!("tolerance: found {tolerance}, {expected}")));
    }
    let recordable = settings.check(machine.speed);
    recordable.map_err(|error| wrong(format!("{}: {error}", machine.name)))?;
    interruptible(py, progress, |shared| run(machine, &settings, seed, shared))
}

impl Run {
    /// The recorded channels once more.
    fn channels(&self) -> Vec<Channel> {
        let schema = self.batch.schema();
        let columns = schema.fields().iter().zip(self.batch.columns());
        let channels = columns.filter_map(|(field, column)| {
            let samples = column.as_primitive_opt::<Float32Type>()?;
            Some(Channel {
                name: field.name().clone(),
                unit: field.metadata().get("unit").cloned().unwrap_or_default(),
                samples: samples.values().to_vec(),
            })
        });
        channels.collect()
    }
}

/// A sample rate with its unit, Hz.
fn rate(text: &str) -> PyResult<f64> {
    Quantity::<Frequency, AboveZero>::named("sample_rate", text).map_err(wrong)
}

fn run(
    machine: Arc<Resolved>,
    settings: &Settings,
    seed: u64,
    shared: &Shared,
) -> Result<Run, Failure> {
    shared.begin("% simulated", Some(100), 0);
    let mut watch = |done: f64| {
        shared.set((100.0 * done) as u64);
        match shared.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let started = Instant::now();
    let record =
        ::simulate::simulate_watched(&machine.machine, &machine.sensors, settings, &mut watch)
            .map_err(|error| match error.is_stopped() {
                true => Failure::interrupted("interrupted"),
                false => Failure::work(format!("{}: {error}", machine.name)),
            })?;
    let mut noise = stream(seed, 0, Purpose::Noise);
    let channels = ::simulate::measure(
        &record,
        &machine.sensors,
        &machine.machine.throw_names(),
        &mut noise,
    );
    let seconds = started.elapsed().as_secs_f64();
    Ok(Run {
        seconds,
        batch: recorded(channels, record.sample_rate).map_err(Failure::work)?,
        machine,
        record,
    })
}

/// The channels over time. Their samples move into the table; none is copied.
fn recorded(
    channels: Vec<Channel>,
    sample_rate: f64,
) -> Result<RecordBatch, arrow_schema::ArrowError> {
    let count = channels.first().map_or(0, |channel| channel.samples.len());
    let time: Float64Array = (0..count).map(|i| Some(i as f64 / sample_rate)).collect();
    let said = |unit: &str, about: &str| {
        Metadata::from([("unit", unit.to_owned()), ("description", about.to_owned())])
    };
    let about = "time since the first sample";
    let mut fields =
        vec![Field::new("t_s", DataType::Float64, false).with_metadata(said("s", about))];
    let mut arrays: Vec<ArrayRef> = vec![Arc::new(time)];
    for channel in channels {
        let mut metadata = said(&channel.unit, "as the sensor reads it");
        metadata.extend([("role", Role::Signal.name().to_owned())]);
        let field = Field::new(&channel.name, DataType::Float32, false);
        fields.push(field.with_metadata(metadata));
        arrays.push(Arc::new(Float32Array::from(channel.samples)));
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
}

#[pymethods]
impl Run {
    /// The recorded channels over time.
    #[getter]
    fn table(&self) -> Table {
        Table::of_batch(self.batch.clone())
    }

    /// The motion itself, as no sensor sees it: pin motion, pressures, journal offsets, contact forces.
    #[getter]
    fn motion(&self) -> PyResult<Table> {
        let throws = self.machine.machine.throw_names();
        let table = run_table(&self.record, &[], self.record.trace.as_ref(), &throws);
        let batch = table.and_then(|table| record_batch(&table));
        batch.map(Table::of_batch).map_err(failed)
    }

    /// Crank angle at each sample, rad, from 0 to 2π.
    #[getter]
    fn crank_angle_rad<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let trace = self.record.trace.iter();
        let angles = trace.flat_map(|trace| trace.crank_angle.iter().step_by(trace.stride.max(1)));
        let angles = Float64Array::from_iter_values(angles.copied());
        let column = Column::new(Arc::new(angles));
        let column = column.ok_or_else(|| failed("the crank angle is missing"))?;
        column.into_numpy(py)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.machine.name
    }

    #[getter]
    fn speed_rpm(&self) -> f64 {
        self.record.mean_speed.to_degrees() / 6.0
    }

    #[getter]
    fn sample_rate_hz(&self) -> f64 {
        self.record.sample_rate
    }

    #[getter]
    fn energy_residual(&self) -> Option<f64> {
        self.record.energy_residual
    }

    /// Time that simulating and measuring took, s.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Names of the throws; one empty name in a machine of one.
    #[getter]
    fn throws(&self) -> Vec<String> {
        let throws = self.machine.machine.throw_names();
        throws.into_iter().map(str::to_owned).collect()
    }

    /// Radial clearance of each joint that has one, by its name and throw, m.
    #[getter]
    fn clearances_m(&self) -> Vec<(String, f64)> {
        let mut clearances = Vec::new();
        if let Some(trace) = &self.record.trace {
            let main = trace
                .main
                .iter()
                .map(|joint| ("main".to_owned(), joint.clearance));
            clearances.extend(main);
            for (throw, name) in trace.throws.iter().zip(self.machine.machine.throw_names()) {
                for (joint, of) in [("big_end", &throw.big_end), ("small_end", &throw.small_end)] {
                    let place = match name {
                        "" => joint.to_owned(),
                        throw => format!("{throw}.{joint}"),
                    };
                    clearances.extend(of.iter().map(|joint| (place.clone(), joint.clearance)));
                }
            }
        }
        clearances
    }

    /// The numbers of the analysis, as JSON.
    #[getter]
    fn _summary(&self) -> PyResult<String> {
        let analysis = RunAnalysis::new(&self.machine.machine, &self.record, &self.channels());
        let analysis = analysis.map_err(failed)?;
        let numbers = analysis.summary(&self.machine.name, self.record.mean_speed);
        serde_json::to_string(&numbers).map_err(failed)
    }

    /// What looks wrong: joints whose surfaces penetrate each other too deeply, sensors whose range is too small.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        ::simulate::doubts(&self.record, &self.machine.sensors, &self.channels())
    }
}
