//! The parts of a sweep that processes make by themselves: its shards, and after them its
//! bifurcation diagrams, numbered from 0 throughout.

use super::commit::{Commit, DiagramCommit};
use super::diagrams::compute;
use super::output::Output;
use super::{Options, Progress, Runner, run_shards};
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

/// Makes part `index` of a sweep, and tells whether there was anything to do: a part that is
/// finished stays as it is.
///
/// # Errors
/// Where there is no such part, a file cannot be written, or the part comes out differently than
/// another process made it meanwhile.
pub fn run_part(
    plan: &Plan,
    output: &Output,
    index: u64,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<bool, Error> {
    let shards = plan.parts();
    match plan.part(index).ok_or(Error::NoShard { index, shards })? {
        Part::Shard(shard) => {
            if Commit::read(output, plan, shard)?.is_some() {
                return Ok(false);
            }
            progress.begins(plan.shard(shard).count() as u64, 0);
            run_shards(plan, output, &[shard], options, runner, progress)?;
        }
        Part::Diagram(diagram) => {
            if DiagramCommit::read(output, plan, &diagram.name)?.is_some() {
                return Ok(false);
            }
            compute(plan, output, &[diagram], options, progress)?;
        }
    }
    Ok(true)
}
