//! Long work: without the interpreter's lock, with progress, and ended by Ctrl-C.

use crate::failure::raised;
use cli::Failure;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, Builder};
use std::time::Duration;

/// How often signals are looked for, and progress is shown.
pub const TICK: Duration = Duration::from_millis(50);

/// Stack of the thread that works: that of a main thread.
const STACK: usize = 8 << 20;

/// What the thread that works and the thread that waits for it tell each other.
#[derive(Default)]
pub struct Shared {
    /// Whether the work is to end.
    pub stop: AtomicBool,
    done: AtomicU64,
    stage: Mutex<Stage>,
}

/// What is under way.
#[derive(Clone, Default)]
struct Stage {
    what: String,
    total: Option<u64>,
    message: String,
}

impl Shared {
    /// Whether the work is to end.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// So many `what` begin, `done` of which were done before.
    pub fn begin(&self, what: &str, total: Option<u64>, done: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = Stage {
            what: what.to_owned(),
            total,
            message: String::new(),
        };
        self.set(done);
    }

    /// So many are done.
    pub fn set(&self, done: u64) {
        self.done.store(done, Ordering::Relaxed);
    }

    /// So many more are done.
    pub fn add(&self, done: u64) {
        self.done.fetch_add(done, Ordering::Relaxed);
    }

    /// What is to be said beside the count.
    pub fn say(&self, message: String) {
        self.stage
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .message = message;
    }

    /// Calls `progress(what, done, total, message)`.
    fn show(&self, py: Python<'_>, progress: &Py<PyAny>) -> PyResult<()> {
        let stage = self
            .stage
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let done = self.done.load(Ordering::Relaxed);
        let shown = progress.call1(py, (stage.what, done, stage.total, stage.message));
        shown.map(drop)
    }
}

/// Does `work` on a thread of its own. After a signal whose handler raises (Ctrl-C), or a `progress` that raises, the work is
/// told to end, and the exception is raised once it has.
///
/// # Errors
/// That exception, or the failure of the work.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Shared) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let shared = Shared::default();
    let progress = progress.as_ref();
    py.detach(|| {
        thread::scope(|scope| {
            let (worker_end, ended) = mpsc::channel::<()>();
            let shared = &shared;
            let worker = Builder::new()
                .stack_size(STACK)
                .spawn_scoped(scope, move || {
                    let _until_the_end = worker_end;
                    work(shared)
                });
            let worker = worker.map_err(|error| raised(Failure::work(error)))?;
            let mut exception = None;
            while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                let looked = Python::attach(|py| {
                    py.check_signals()?;
                    progress.map_or(Ok(()), |progress| shared.show(py, progress))
                });
                if let Err(error) = looked {
                    shared.stop.store(true, Ordering::Relaxed);
                    exception.get_or_insert(error);
                }
            }
            let result = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            match exception {
                Some(exception) => Err(exception),
                None => result.map_err(raised),
            }
        })
    })
}
