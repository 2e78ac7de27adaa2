//! A plan becomes a dataset: cases are run in parallel and written in order, shard by shard.

mod adopt;
mod attempts;
mod case_rows;
mod clear;
mod commit;
mod delta;
mod diagrams;
mod finalize;
mod judged;
mod kept;
mod lock;
mod log;
mod output;
mod parts;
mod shard;
mod status;
mod store;
mod tables;
mod trial;
mod verify;

pub use attempts::Attended;
pub use commit::{Commit, Damage};
pub use delta::{DeltaTable, export_delta};
pub use diagrams::run_diagrams;
pub(crate) use diagrams::sample_diagram;
pub use finalize::{finalize, finalize_verified};
pub use kept::check_calibration;
pub use output::{CALIBRATION, Claim, Existing, Output};
pub use parts::run_part;
pub use status::{Status, status};
pub use tables::Tables;
pub(crate) use tables::prefixed;
pub use trial::{Trial, try_here};
pub use verify::{Fault, Verified, damage, verify};

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
use case_rows::{Dead, run_cases};
use commit::Check;
use log::Pace;
use parts::scan;
use shard::ShardWriter;
use trial::try_cases;

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
    /// Something is wrong with what was there before.
    fn warning(&mut self, _text: &str) {}
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
    /// Whether finished shards with failed cases, for whatever reason they failed, are made again.
    pub retry_failed: bool,
    /// Tries a case in a process of its own, where several processes ended without a result; without
    /// it, such a case is not found.
    pub trial: Option<&'a Trial<'a>>,
}

impl Options<'_> {
    fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
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
    scan(
        plan,
        &output,
        0..plan.shards(),
        Check::Resume,
        |shard, made| {
            let finished = made.is_some_and(|made| made.is_finished(options));
            pending.extend((!finished).then_some(shard));
            Ok(())
        },
    )?;
    output
        .take_warnings()
        .iter()
        .for_each(|text| progress.warning(text));
    let unfinished = cases_of(plan, &pending);
    progress.begins(plan.cases(), plan.cases() - unfinished);
    output.logged("gen-dataset", || {
        run_shards(plan, &output, &pending, options, runner, progress)?;
        run_diagrams(plan, &output, options, progress)?;
        finalize(&output, plan)
    })
}

/// Runs the shards `pending` of a sweep, in ascending order. Suspect ones come first, each by itself:
/// their cases are tried before they are run.
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
    let attempts = Attempts::new(output);
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
        attempts: &attempts,
    };
    if !pending.is_empty() {
        let (id, threads) = (&plan.id[..12], options.threads);
        let (cases, shards) = (shards.pace.cases(), pending.len());
        output.say(format_args!(
            "plan {id}: {cases} cases in {shards} shards, on {threads} threads"
        ));
    }
    attempts.kept_alive(|| {
        let suspects = shards.suspects(pending)?;
        for (shard, cases) in &suspects {
            shards.with_care(*shard, cases)?;
        }
        let others = pending.iter().filter(|shard| !suspects.contains_key(shard));
        let others: Vec<u64> = others.copied().collect();
        shards.side_by_side(&others, TOGETHER, &Dead::new())
    })
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
    attempts: &'a Attempts<'a>,
}

impl Shards<'_> {
    fn check_cancelled(&self) -> Result<(), Error> {
        check_cancelled(self.plan, self.options, self.done)
    }

    /// The cases that are tried before they are run, by shard: all those of a suspect shard, and those
    /// that died before and are made again.
    fn suspects(&self, pending: &[u64]) -> Result<BTreeMap<u64, Vec<u64>>, Error> {
        let plan = self.plan;
        let is_pending = |shard| pending.binary_search(&shard).is_ok();
        let counts = attempts::counts(self.output, is_pending)?;
        let suspect = counts.iter().filter(|(_, count)| count.is_suspect());
        let mut suspects: BTreeMap<u64, Vec<u64>> = suspect
            .map(|(&shard, _)| (shard, plan.shard(shard).collect()))
            .collect();
        if !self.options.retry_failed {
            return Ok(suspects);
        }
        for &shard in pending {
            let before = Commit::read(self.output, plan, shard, Check::Lengths)?;
            let failed = before.map_or_else(Vec::new, |commit| commit.failed);
            let died = |case: &u64| {
                let id = plan.case_id(*case);
                failed.iter().any(|case| case.died && case.case_id == id)
            };
            let died: Vec<u64> = plan.shard(shard).filter(died).collect();
            if !died.is_empty() {
                suspects.entry(shard).or_insert(died);
            }
        }
        Ok(suspects)
    }

    /// Tries `cases` of a shard one by one, and then runs all of them that do not end their processes,
    /// each by itself, so that they take the least memory.
    fn with_care(&mut self, shard: u64, cases: &[u64]) -> Result<(), Error> {
        let (plan, output) = (self.plan, self.output);
        self.attempts.begin(shard)?;
        output.say(format_args!(
            "shard {shard}: trying {} cases in processes of their own, because processes ended in it \
             without a result",
            cases.len()
        ));
        let dead = try_cases(plan, output, shard, cases, self.options, self.done)?;
        self.side_by_side(&[shard], 1, &dead)
    }

    /// Runs shards on all threads, at most `most` cases together, but for the cases of `dead`.
    fn side_by_side(&mut self, pending: &[u64], most: u64, dead: &Dead) -> Result<(), Error> {
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
            attempts,
        } = self;
        let (plan, output, options, attempts) = (*plan, *output, *options, *attempts);
        let threads = options.threads;
        let together = plan.together(cases_of(plan, pending), threads).min(most);
        let inputs = pending.iter().flat_map(|&shard| {
            let begun = attempts.begin(shard).err().map(Err);
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
            inputs.take_while(|_| !options.is_cancelled()),
            |piece| match piece {
                Ok((_, cases)) => run_cases(plan, cases.clone(), dead, *runner, sweep_yaml),
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
                open.commit(plan, options.retry_failed)?;
                output.say(format_args!("shard {shard} made; {pace}"));
                *done += 1;
                attempts.end(shard);
                attempts::forget(output, |made| made == shard)
            },
        )?;
        // Cancelled before the first case, or between two shards.
        match self.done < plan.shards() {
            true => self.check_cancelled(),
            false => Ok(()),
        }
    }
}

fn check_cancelled(plan: &Plan, options: &Options, done: u64) -> Result<(), Error> {
    let shards = plan.shards();
    match options.is_cancelled() {
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
