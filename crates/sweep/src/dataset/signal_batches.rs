//! The recordings of a sweep batch by batch, without a folder.

use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use recordings::{CaseWarning, FailedCase, Schema, Table};

use super::case_rows::{CaseRows, Dead, Signals, Wanted, run_cases};
use super::recording::{Failure, Recording};
use super::run_shards::pieces;
use super::shard::rows_per_group;
use super::tables::Tables;
use crate::in_order::{in_order, pool};
use crate::{Case, Error, Plan};

/// Batches that wait to be taken.
const WAITING: usize = 1;

/// Some rows of the table `signals`, in the order of cases.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalBatch {
    /// The rows; none of the last batch where its cases failed.
    pub table: Table,
    /// Cases that are done with this batch, failed ones included.
    pub cases: u64,
    /// Those that failed since the batch before.
    pub failed: Vec<FailedCase>,
    /// What is doubtful about cases since the batch before.
    pub warnings: Vec<CaseWarning>,
}

/// What came of waiting for a batch.
#[derive(Debug)]
pub enum Waited {
    /// It is there, or the work failed.
    Batch(Result<SignalBatch, Error>),
    /// There are no more.
    End,
    /// It is not there yet.
    NotYet,
}

/// Simulates the cases of a sweep on threads of its own and hands out their recordings, in the order of
/// the cases: the rows that the table `signals` of its dataset has. Nothing is written.
///
/// 1. Who does not take batches holds up the simulation: the memory is that of two batches and of the
///    cases under way, at most 64 for each thread.
/// 2. Batches have as many rows as row groups of the dataset have. Neither they nor their bytes depend on the
///    threads.
/// 3. The simulation ends when this is dropped, which waits for the cases under way.
/// 4. Bifurcation diagrams are no recordings and are left out.
pub struct SignalBatches {
    schema: Schema,
    stop: Arc<AtomicBool>,
    /// None once it has ended.
    batches: Option<Receiver<Result<SignalBatch, Error>>>,
    worker: Option<JoinHandle<()>>,
}

impl SignalBatches {
    /// Begins to simulate the cases of `plan` with `runner`.
    ///
    /// # Errors
    /// Two columns of one name, or threads that cannot be started.
    pub fn new(
        plan: Plan,
        threads: usize,
        runner: impl Fn(&[Case]) -> Vec<Result<Recording, Failure>> + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        let schema = Tables::new(&plan)?.signals;
        let pool = pool(threads)?;
        let (sender, batches) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        let writer = Writer {
            rows: rows_per_group(&schema, plan.samples_per_window()),
            batch: empty(&schema, 0),
            sender,
        };
        let stopped = stop.clone();
        let worker = Builder::new().spawn(move || {
            run(&plan, threads, &pool, &runner, &stopped, writer);
        });
        let worker = worker.map_err(|error| Error::Threads {
            threads: 1,
            reason: error.to_string(),
        })?;
        Ok(Self {
            schema,
            stop,
            batches: Some(batches),
            worker: Some(worker),
        })
    }

    /// The columns of every batch.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// The next batch, if it comes within `patience`.
    pub fn wait(&mut self, patience: Duration) -> Waited {
        let Some(batches) = &self.batches else {
            return Waited::End;
        };
        match batches.recv_timeout(patience) {
            Ok(Ok(batch)) => Waited::Batch(Ok(batch)),
            Ok(Err(error)) => {
                self.close();
                Waited::Batch(Err(error))
            }
            Err(RecvTimeoutError::Timeout) => Waited::NotYet,
            Err(RecvTimeoutError::Disconnected) => {
                self.close();
                Waited::End
            }
        }
    }

    /// Ends the simulation and waits for the cases under way. There are no more batches.
    ///
    /// # Panics
    /// Where the simulation did.
    pub fn close(&mut self) {
        if let Some(Err(panic)) = self.join() {
            resume_unwind(panic);
        }
    }

    fn join(&mut self) -> Option<std::thread::Result<()>> {
        self.stop.store(true, Ordering::Relaxed);
        // Who is about to hand over a batch learns that nobody takes it.
        self.batches = None;
        self.worker.take().map(JoinHandle::join)
    }
}

impl Drop for SignalBatches {
    fn drop(&mut self) {
        self.join();
    }
}

impl Iterator for SignalBatches {
    type Item = Result<SignalBatch, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.wait(Duration::MAX) {
                Waited::Batch(batch) => return Some(batch),
                Waited::End => return None,
                Waited::NotYet => {}
            }
        }
    }
}

/// Why the work ends early.
enum End {
    /// Nobody takes batches any more.
    Abandoned,
    Failed(Error),
}

/// Runs all cases, until `stop`.
fn run(
    plan: &Plan,
    threads: usize,
    pool: &rayon::ThreadPool,
    runner: &(impl Fn(&[Case]) -> Vec<Result<Recording, Failure>> + Sync),
    stop: &AtomicBool,
    mut writer: Writer,
) {
    let stopped = || stop.load(Ordering::Relaxed);
    let together = plan.together(plan.cases(), threads);
    let dead = Dead::new();
    let done = in_order(
        pool,
        2 * threads.max(1),
        pieces(0..plan.cases(), together).take_while(|_| !stopped()),
        |cases| match stopped() {
            true => VecDeque::new(),
            false => run_cases(plan, cases.clone(), &dead, runner, Wanted::Signals).into(),
        },
        |cases, mut rows| {
            for _ in cases {
                writer.case(rows.pop_front().ok_or(End::Abandoned)?)?;
            }
            Ok(())
        },
    );
    let ended = done.and_then(|()| writer.send());
    if let Err(End::Failed(error)) = ended {
        // Nobody listens any more: nobody needs it.
        let _ = writer.sender.send(Err(error));
    }
}

/// Collects rows into batches.
struct Writer {
    /// Rows of a batch.
    rows: usize,
    batch: SignalBatch,
    sender: SyncSender<Result<SignalBatch, Error>>,
}

fn empty(schema: &Schema, cases: u64) -> SignalBatch {
    SignalBatch {
        table: Table::new(schema.clone()),
        cases,
        failed: Vec::new(),
        warnings: Vec::new(),
    }
}

impl Writer {
    /// Appends a case.
    fn case(&mut self, case: Result<CaseRows, FailedCase>) -> Result<(), End> {
        self.batch.cases += 1;
        let case = match case {
            Ok(case) => case,
            Err(failed) => {
                self.batch.failed.push(failed);
                return Ok(());
            }
        };
        let case_id = &case.case_id;
        let warnings = case.warnings.into_iter().map(|warning| CaseWarning {
            case_id: case_id.clone(),
            warning,
        });
        self.batch.warnings.extend(warnings);
        let Signals::Rows(rows) = case.signals else {
            return Ok(());
        };
        for row in rows {
            let pushed = self.batch.table.push(row);
            pushed.map_err(|error| End::Failed(error.into()))?;
            if self.batch.table.rows() >= self.rows {
                self.hand_over()?;
            }
        }
        Ok(())
    }

    /// Hands over what is left.
    fn send(&mut self) -> Result<(), End> {
        let SignalBatch {
            table,
            failed,
            warnings,
            ..
        } = &self.batch;
        match table.rows() == 0 && failed.is_empty() && warnings.is_empty() {
            true => Ok(()),
            false => self.hand_over(),
        }
    }

    fn hand_over(&mut self) -> Result<(), End> {
        let next = empty(self.batch.table.schema(), self.batch.cases);
        let batch = std::mem::replace(&mut self.batch, next);
        self.sender.send(Ok(batch)).map_err(|_| End::Abandoned)
    }
}
