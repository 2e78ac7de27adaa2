//! The parts of a sweep that processes make by themselves: its shards, and after them its
//! bifurcation diagrams, numbered from 0 throughout.

use std::ops::Range;

use super::check::Check;
use super::commit::{Commit, DiagramCommit};
use super::diagrams::compute;
use super::options::Options;
use super::output::Output;
use super::progress::Progress;
use super::recording::Runner;
use super::run_shards::run_shards;
use super::store::READERS;
use crate::in_order::{in_order, pool};
use crate::plan::Diagram;
use crate::{Error, Plan};

/// A part of a sweep.
pub(super) enum Part<'a> {
    /// A shard of its cases.
    Shard(u64),
    /// A bifurcation diagram.
    Diagram(&'a Diagram),
}

impl Plan {
    /// Number of parts: shards and bifurcation diagrams.
    pub fn parts(&self) -> u64 {
        self.shards() + self.diagrams.len() as u64
    }

    /// Part number `index`.
    pub(super) fn part(&self, index: u64) -> Option<Part<'_>> {
        if index < self.shards() {
            return Some(Part::Shard(index));
        }
        let diagram = self.diagrams.get((index - self.shards()) as usize);
        diagram.map(Part::Diagram)
    }
}

impl Part<'_> {
    /// What it left, if it is finished and its files are as they were written.
    fn made(&self, plan: &Plan, output: &Output, check: Check) -> Result<Option<Made>, Error> {
        Ok(match self {
            Self::Shard(shard) => Commit::read(output, plan, *shard, check)?.map(Made::Shard),
            Self::Diagram(diagram) => {
                let found = DiagramCommit::find(output, plan, &diagram.name, check)?;
                found.made().map(Made::Diagram)
            }
        })
    }
}

/// What a finished part left.
pub(super) enum Made {
    /// A shard.
    Shard(Commit),
    /// A bifurcation diagram.
    Diagram(DiagramCommit),
}

impl Made {
    /// Whether there is nothing left to do for it.
    pub(super) fn is_finished(&self, options: &Options) -> bool {
        match self {
            Self::Shard(commit) => commit.failed.is_empty() || !options.retry_failed,
            Self::Diagram(_) => true,
        }
    }
}

/// Hands to `each`, in order, what the parts `indices` left; nothing for a part that is not
/// finished or whose record or files are damaged.
///
/// # Errors
/// The first error of `each`, or storage that cannot be read.
pub(super) fn scan(
    plan: &Plan,
    output: &Output,
    indices: Range<u64>,
    check: Check,
    mut each: impl FnMut(u64, Option<Made>) -> Result<(), Error>,
) -> Result<(), Error> {
    let read = |index: &u64| -> Result<Option<Made>, Error> {
        match plan.part(*index) {
            Some(part) => part.made(plan, output, check),
            None => Ok(None),
        }
    };
    in_order(
        &pool(READERS)?,
        4 * READERS,
        indices,
        read,
        |index, made| each(index, made?),
    )
}

/// Makes part `index` of a sweep. Returns false if the part was finished before; it then stays as it is.
///
/// # Errors
/// - [`Error::NoShard`] if there is no such part;
/// - [`Error::Cancelled`] or [`Error::DiagramsCancelled`] if it is stopped;
/// - [`Error::NotDeterministic`] if another process made the part with other bytes;
/// - errors of files that cannot be read or written.
pub fn run_part(
    plan: &Plan,
    output: &Output,
    index: u64,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<bool, Error> {
    let shards = plan.parts();
    let part = plan.part(index).ok_or(Error::NoShard { index, shards })?;
    let made = part.made(plan, output, Check::Resume)?;
    for text in output.take_warnings() {
        progress.warning(&text);
    }
    if made.is_some_and(|made| made.is_finished(options)) {
        return Ok(false);
    }
    match part {
        Part::Shard(shard) => {
            progress.begins(plan.shard(shard).count() as u64, 0);
            output.logged(&format!("shard-{shard}"), || {
                run_shards(plan, output, &[shard], options, runner, progress)
            })?;
        }
        Part::Diagram(diagram) => {
            output.logged(&format!("shard-{index}"), || {
                compute(plan, output, &[diagram], options, progress)
            })?;
        }
    }
    Ok(true)
}
