//! A plan becomes a dataset: cases are run in parallel and written in order, shard by shard.

mod attempts;
mod case_rows;
mod commit;
mod delta;
mod diagrams;
mod finalize;
mod judged;
mod kept;
mod log;
mod output;
mod parts;
mod shard;
mod status;
mod store;
mod tables;

pub use commit::Commit;
pub use delta::{DeltaTable, export_delta};
pub use diagrams::{run_diagrams, sample_diagram};
pub use finalize::{finalize, verify};
pub use kept::check_calibration;
pub use output::{CALIBRATION, Claim, Existing, Output};
pub use parts::run_part;
pub use status::{Status, status};
pub use tables::{Tables, feature_column};

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use recordings::Manifest;
use signal::channel::Channel;
use simulate::Motion;

use crate::in_order::in_order;
use crate::plan::MOST_CASES;
use crate::{Case, Error, Plan};
use attempts::Attempts;
use case_rows::{failed, run_cases};
use log::Pace;
use parts::scan;
use shard::ShardWriter;

/// What a simulated case gives: the channels of the machine's sensors, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// The channels, named as [`Plan::channels`] has them, from the first recorded revolution on.
    pub channels: Vec<Channel>,
    /// The motion as judged from the equations, where the case asks for that and can be disturbed.
    pub motion: Option<Motion>,
    /// What is doubtful about it; its texts go into the manifest.
    pub warnings: Vec<String>,
}

/// Why a case failed; its text goes into the manifest.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Simulates cases, one result for each. Called on several threads at once; a result must depend on
/// its case alone.
pub type Runner<'a> = dyn Fn(&[Case]) -> Vec<Result<Recording, Failure>> + Sync + 'a;

/// Most cases that are simulated together: enough to keep lanes busy, and few enough not to be waited
/// for where a sweep is stopped.
const TOGETHER: u64 = 32;

/// Is told how a sweep gets on. Called on the thread that writes.
pub trait Progress {
    /// Cases of the sweep, and how many of them were finished before.
    fn begins(&mut self, _cases: u64, _finished: u64) {}
    /// A case is done.
    fn case_done(&mut self, _case: u64, _failed: bool) {}
    /// Values of all bifurcation diagrams, and how many of them were finished before.
    fn diagrams_begin(&mut self, _values: u64, _finished: u64) {}
    /// So many more values are done.
    fn values_done(&mut self, _values: u64) {}
}

/// Nobody is told.
impl Progress for () {}

/// How a sweep is run.
pub struct Options<'a> {
    /// What to do with an output folder that has something in it.
    pub existing: Existing,
    /// Threads that simulate; at least one.
    pub threads: usize,
    /// Once true, nothing new is started and [`Error::Cancelled`] is handed back.
    pub cancel: &'a AtomicBool,
}

/// Runs the sweep and writes its dataset to the folder `root`.
///
/// The bytes depend on the plan alone: not on the threads, nor on interruptions.
///
/// # Errors
/// Where the sweep is too large, the folder cannot be used, or the disk is full. Cases that fail
/// are no error: they stand in the manifest.
pub fn generate(
    plan: &Plan,
    root: &Path,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<Manifest, Error> {
    plan.check_size()?;
    let claim = Claim::new(root, options.existing)?;
    generate_in(claim, plan, options, runner, progress)
}

/// As [`generate`], in a folder that is locked already.
///
/// # Errors
/// As [`generate`].
pub fn generate_in(
    claim: Claim,
    plan: &Plan,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<Manifest, Error> {
    plan.check_size()?;
    let output = claim.open(plan)?;
    let mut pending = Vec::new();
    scan(plan, &output, 0..plan.shards(), |shard, made| {
        pending.extend(made.is_none().then_some(shard));
        Ok(())
    })?;
    let unfinished = cases_of(plan, &pending);
    progress.begins(plan.cases(), plan.cases() - unfinished);
    output.logged("gen-dataset", || {
        run_shards(plan, &output, &pending, options, runner, progress)?;
        run_diagrams(plan, &output, options, progress)?;
        finalize(&output, plan)
    })
}

/// Runs the shards `pending` of a sweep. Those that several processes ended in come first, case by
/// case.
///
/// # Errors
/// Where a file cannot be written, or a shard comes out differently than it did before.
pub fn run_shards(
    plan: &Plan,
    output: &Output,
    pending: &[u64],
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<(), Error> {
    let mut shards = Shards {
        plan,
        output,
        options,
        runner,
        progress,
        tables: Tables::new(plan)?,
        sweep_yaml: input::yaml::to_string(plan.sweep())?,
        done: plan.shards() - pending.len() as u64,
        pace: Pace::new(cases_of(plan, pending)),
    };
    if !pending.is_empty() {
        let (id, threads) = (&plan.id[..12], options.threads);
        let (cases, shards) = (shards.pace.cases(), pending.len());
        output.say(format_args!(
            "plan {id}: {cases} cases in {shards} shards, on {threads} threads"
        ));
    }
    let counts = attempts::counts(output)?;
    let in_vain = |shard: &u64| attempts::are_too_many(counts.get(&shard.to_string()));
    let (slow, fast): (Vec<u64>, Vec<u64>) = pending.iter().partition(|shard| in_vain(shard));
    for shard in slow {
        shards.one_by_one(shard, &counts)?;
    }
    shards.side_by_side(&fast)
}

/// What running shards takes.
struct Shards<'a> {
    plan: &'a Plan,
    output: &'a Output,
    options: &'a Options<'a>,
    runner: &'a Runner<'a>,
    progress: &'a mut dyn Progress,
    tables: Tables,
    sweep_yaml: String,
    /// Finished shards.
    done: u64,
    pace: Pace,
}

impl Shards<'_> {
    fn check_cancelled(&self) -> Result<(), Error> {
        check_cancelled(self.plan, self.options, self.done)
    }

    /// Runs shards on all threads.
    fn side_by_side(&mut self, pending: &[u64]) -> Result<(), Error> {
        let Self {
            plan,
            output,
            options,
            runner,
            progress,
            tables,
            sweep_yaml,
            done,
            pace,
        } = self;
        let (plan, output, options) = (*plan, *output, *options);
        let (threads, cancel) = (options.threads, options.cancel);
        let together = plan.together(cases_of(plan, pending), threads);
        let attempts = Attempts::new(output);
        let inputs = pending.iter().flat_map(|&shard| {
            let begun = attempts.begin(&shard.to_string()).err().map(Err);
            output.say(format_args!("shard {shard} begun"));
            let pieces = pieces(plan.shard(shard), together);
            begun
                .into_iter()
                .chain(pieces.map(move |cases| Ok((shard, cases))))
        });
        let mut writer: Option<ShardWriter> = None;
        in_order(
            &pool(threads)?,
            2 * threads.max(1),
            inputs.take_while(|_| !cancel.load(Ordering::Relaxed)),
            |piece| match piece {
                Ok((_, cases)) => run_cases(plan, cases.clone(), *runner, sweep_yaml),
                Err(_) => Vec::new(),
            },
            |piece, rows| {
                let (shard, cases) = piece?;
                check_cancelled(plan, options, *done)?;
                let mut open = match writer.take() {
                    Some(open) => open,
                    None => ShardWriter::new(output, plan, tables, shard)?,
                };
                let end = cases.end;
                for (case, rows) in cases.zip(rows) {
                    progress.case_done(case, rows.is_err());
                    pace.add();
                    open.write(rows)?;
                }
                if end < plan.shard(shard).end {
                    writer = Some(open);
                    return Ok(());
                }
                open.commit(plan)?;
                output.say(format_args!("shard {shard} made; {pace}"));
                *done += 1;
                attempts.end(&shard.to_string());
                Ok::<(), Error>(())
            },
        )?;
        // Cancelled before the first case, or between two shards.
        match self.done < plan.shards() {
            true => self.check_cancelled(),
            false => Ok(()),
        }
    }

    /// Runs a shard that processes ended in, so that the next one to end tells which case it is.
    fn one_by_one(&mut self, shard: u64, counts: &BTreeMap<String, u64>) -> Result<(), Error> {
        let plan = self.plan;
        let attempts = Attempts::new(self.output);
        attempts.begin(&shard.to_string())?;
        self.output.say(format_args!(
            "shard {shard} begun case by case, because processes ended in it without a word"
        ));
        let mut open = ShardWriter::new(self.output, plan, &self.tables, shard)?;
        for case in plan.shard(shard) {
            self.check_cancelled()?;
            let marker = format!("{shard}.{}", plan.case_id(case));
            let rows = if attempts::are_too_many(counts.get(&marker)) {
                vec![Err(failed(plan, case, &attempts::REASON.into()))]
            } else {
                attempts.begin(&marker)?;
                let rows = run_cases(plan, case..case + 1, self.runner, &self.sweep_yaml);
                attempts.end(&marker);
                rows
            };
            for rows in rows {
                self.progress.case_done(case, rows.is_err());
                self.pace.add();
                open.write(rows)?;
            }
        }
        open.commit(plan)?;
        self.output
            .say(format_args!("shard {shard} made; {}", self.pace));
        self.done += 1;
        attempts.end(&shard.to_string());
        Ok(())
    }
}

fn check_cancelled(plan: &Plan, options: &Options, done: u64) -> Result<(), Error> {
    let shards = plan.shards();
    match options.cancel.load(Ordering::Relaxed) {
        true => Err(Error::Cancelled { done, shards }),
        false => Ok(()),
    }
}

/// Cases in `shards`.
fn cases_of(plan: &Plan, shards: &[u64]) -> u64 {
    let cases = |&shard| plan.shard(shard).count() as u64;
    shards.iter().map(cases).sum()
}

/// A range in pieces of at most `size`.
fn pieces(range: Range<u64>, size: u64) -> impl Iterator<Item = Range<u64>> {
    let end = range.end;
    let starts = range.step_by(size as usize);
    starts.map(move |start| start..end.min(start + size))
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, Error> {
    let threads = threads.max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::Threads {
        threads,
        reason: e.to_string(),
    })
}

impl Plan {
    /// How many of `cases` are simulated together, so that no thread of so many is without any for long.
    /// Judging a motion takes as long as many simulations and gains nothing by it.
    fn together(&self, cases: u64, threads: usize) -> u64 {
        if self.judgement.is_some() {
            return 1;
        }
        let share = cases.div_ceil(4 * threads.max(1) as u64);
        share.clamp(1, TOGETHER)
    }

    /// Checks that the sweep is not too large to be run.
    ///
    /// # Errors
    /// Where it is.
    pub fn check_size(&self) -> Result<(), Error> {
        let (cases, most) = (self.cases(), MOST_CASES);
        if cases > most {
            return Err(Error::TooManyCases { cases, most });
        }
        Ok(())
    }
}
