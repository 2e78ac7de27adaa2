//! The recordings of a sweep batch by batch, nothing on disk.

use crate::failure::{failed, raised};
use crate::generate::{Asked, cores};
use crate::interruptible::{TICK, interruptible};
use crate::machine::Machine;
use crate::stream::capsule;
use crate::table::Table;
use arrow_array::{RecordBatch, RecordBatchReader};
use arrow_schema::ArrowError;
use arrow_schema::SchemaRef;
use cli::Failure;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use recordings::formats::record_batch::record_batch;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use sweep::dataset::{SignalBatches as Simulated, Waited};
use sweep::simulate_cases;

/// The recordings of a sweep as they are simulated, in the order of cases.
#[pyclass(frozen, module = "crosshead")]
pub struct SignalBatches {
    name: String,
    cases: u64,
    mistakes: Vec<String>,
    schema: SchemaRef,
    state: Arc<Mutex<State>>,
}

/// Shared with a library that has taken the stream.
struct State {
    /// None once it is closed.
    simulated: Option<Simulated>,
    /// Cases that are done, failed ones included.
    done: u64,
    /// Names of failed cases, with the reason.
    failed: Vec<(String, String)>,
    /// Names of cases with something doubtful about them.
    warnings: Vec<(String, String)>,
}

/// Begins to simulate the sweep file `sweep`; the arguments are those of `generate`.
///
/// # Errors
/// Wrong input, a sweep that calibrates its machine itself, or threads that cannot be started.
#[pyfunction]
#[pyo3(signature = (sweep, machine, calibration, uncertainty, undetermined, channels, threads))]
pub fn signal_batches(
    py: Python<'_>,
    sweep: PathBuf,
    machine: Option<&Machine>,
    calibration: Option<PathBuf>,
    uncertainty: &str,
    undetermined: &str,
    channels: Option<Vec<String>>,
    threads: Option<usize>,
) -> PyResult<SignalBatches> {
    let asked = Asked::new(machine, calibration, uncertainty, undetermined, channels)?;
    interruptible(py, None, |_| {
        let (file, plan) = asked.planned(&sweep)?;
        if asked.calibrates(&file) {
            return Err(Failure::input(format!(
                "{}: calibrate: the sweep calibrates its machine, which needs a folder: give out, or \
                 machine=crosshead.calibrate(...)",
                sweep.display()
            )));
        }
        let plan = asked.with_channels(plan)?;
        let (name, cases) = (plan.name.clone(), plan.cases());
        let mut mistakes = plan.census().mistakes();
        if !plan.diagrams.is_empty() {
            let left_out =
                "bifurcations: diagrams are left out, because they need a folder: give out";
            mistakes.push(left_out.to_owned());
        }
        let threads = threads.unwrap_or_else(cores).max(1);
        let simulated = Simulated::new(plan, threads, simulate_cases)?;
        let none = recordings::Table::new(simulated.schema().clone());
        let none = record_batch(&none).map_err(Failure::work)?;
        Ok(SignalBatches {
            name,
            cases,
            mistakes,
            schema: none.schema(),
            state: Arc::new(Mutex::new(State {
                simulated: Some(simulated),
                done: 0,
                failed: Vec::new(),
                warnings: Vec::new(),
            })),
        })
    })
}

fn locked(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl State {
    /// The next batch, none at the end; goes on where there is none yet.
    fn wait(&mut self) -> ControlFlow<Result<Option<RecordBatch>, Failure>> {
        let Some(simulated) = &mut self.simulated else {
            return ControlFlow::Break(Ok(None));
        };
        let batch = match simulated.wait(TICK) {
            Waited::NotYet => return ControlFlow::Continue(()),
            Waited::End => {
                self.simulated = None;
                return ControlFlow::Break(Ok(None));
            }
            Waited::Batch(batch) => batch,
        };
        ControlFlow::Break(batch.map_err(Failure::from).and_then(|batch| {
            self.done = batch.cases;
            let failed = batch.failed.into_iter();
            self.failed
                .extend(failed.map(|case| (case.case_id, case.reason)));
            let warnings = batch.warnings.into_iter();
            self.warnings
                .extend(warnings.map(|case| (case.case_id, case.warning)));
            record_batch(&batch.table).map(Some).map_err(Failure::work)
        }))
    }
}

/// Ends the simulation; waits for the cases under way.
fn close(state: &Mutex<State>) {
    let simulated = locked(state).simulated.take();
    drop(simulated);
}

#[pymethods]
impl SignalBatches {
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Cases of the sweep.
    #[getter]
    fn cases(&self) -> u64 {
        self.cases
    }

    /// What is wrong with the sweep's labels and splits.
    #[getter]
    fn mistakes(&self) -> Vec<String> {
        self.mistakes.clone()
    }

    #[getter]
    fn done(&self) -> u64 {
        locked(&self.state).done
    }

    #[getter]
    fn failed(&self) -> Vec<(String, String)> {
        locked(&self.state).failed.clone()
    }

    #[getter]
    fn warnings(&self) -> Vec<(String, String)> {
        locked(&self.state).warnings.clone()
    }

    /// A table without rows, which has the columns.
    #[getter]
    fn columns(&self) -> Table {
        Table::new(self.schema.clone(), Vec::new())
    }

    /// The next batch; none at the end. Ctrl-C ends the simulation.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        loop {
            let waited = py.detach(|| locked(&self.state).wait());
            if let ControlFlow::Break(batch) = waited {
                return Ok(batch.map_err(raised)?.map(Table::of_batch));
            }
            if let Err(exception) = py.check_signals() {
                self.close(py);
                return Err(exception);
            }
        }
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| close(&self.state));
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore what it cannot give without a copy.
        let _ = requested_schema;
        if locked(&self.state).simulated.is_none() {
            return Err(failed("the batches are at their end or closed"));
        }
        let reader = Reader {
            schema: self.schema.clone(),
            state: self.state.clone(),
        };
        capsule(py, Box::new(reader))
    }
}

impl Drop for SignalBatches {
    fn drop(&mut self) {
        // Where a library reads on, it ends the simulation itself.
        if let Some(state) = Arc::get_mut(&mut self.state) {
            Python::try_attach(|py| py.detach(|| close(state)));
        }
    }
}

/// The batches for a library that reads Arrow's streams, on any thread and without the interpreter.
struct Reader {
    schema: SchemaRef,
    state: Arc<Mutex<State>>,
}

impl Iterator for Reader {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let waited = locked(&self.state).wait();
            if let ControlFlow::Break(batch) = waited {
                let batch = batch.map_err(|error| ArrowError::ComputeError(error.message().into()));
                return batch.transpose();
            }
        }
    }
}

impl RecordBatchReader for Reader {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        close(&self.state);
    }
}
