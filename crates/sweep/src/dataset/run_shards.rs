//! Runs shards: their cases in parallel, their rows in order.

use std::collections::BTreeMap;
use std::ops::Range;

use super::attempts::{self, Attempts};
use super::case_rows::{Dead, Wanted, run_cases};
use super::check::Check;
use super::commit::Commit;
use super::log::Pace;
use super::options::Options;
use super::output::Output;
use super::progress::Progress;
use super::recording::Runner;
use super::shard::ShardWriter;
use super::tables::Tables;
use super::trial::try_cases;
use crate::in_order::{in_order, pool};
use crate::{Error, Plan};

/// Most cases that are simulated together: enough to keep lanes busy, and few enough not to be waited
/// for where a sweep is stopped.
const TOGETHER: u64 = 32;

/// Runs the shards `pending` of a sweep, in ascending order. Suspect shards come first, one at a time:
/// their cases are tried before they are run.
///
/// # Errors
/// [`Error::Cancelled`] if it is stopped, [`Error::NotDeterministic`] if a shard has other bytes than
/// before, and errors of files that cannot be read or written.
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
    /// one at a time, so that they take the least memory.
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
                Ok((_, cases)) => {
                    let wanted = Wanted::Dataset { sweep_yaml };
                    run_cases(plan, cases.clone(), dead, *runner, wanted)
                }
                Err(_) => Vec::new(),
            },
            |piece, rows| {
                let (shard, cases) = piece?;
                options.check_cancelled(plan, *done)?;
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
            true => self.options.check_cancelled(self.plan, self.done),
            false => Ok(()),
        }
    }
}

/// Cases in `shards`.
pub(super) fn cases_of(plan: &Plan, shards: &[u64]) -> u64 {
    let cases = |&shard| plan.shard(shard).count() as u64;
    shards.iter().map(cases).sum()
}

/// A range in pieces of at most `size`.
pub(super) fn pieces(range: Range<u64>, size: u64) -> impl Iterator<Item = Range<u64>> {
    let end = range.end;
    let starts = range.step_by(size as usize);
    starts.map(move |start| start..end.min(start + size))
}

impl Plan {
    /// How many of `cases` are simulated together, so that no thread of so many is without any for long.
    /// Judging a motion takes as long as many simulations and gains nothing by it.
    pub(super) fn together(&self, cases: u64, threads: usize) -> u64 {
        if self.judgement.is_some() {
            return 1;
        }
        let share = cases.div_ceil(4 * threads.max(1) as u64);
        share.clamp(1, TOGETHER)
    }
}
