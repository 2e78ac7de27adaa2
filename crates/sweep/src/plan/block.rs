//! A block of cases, made ready: what its case at an index sets in the machine file.

use input::Error;
use serde_json::Value;

use super::axis::{Assignments, Frame, JointSet, Target};
use super::drawn::Drawn;
use super::listed::Listed;
use crate::design::hash::hash;
use crate::sweep_file;

/// Cases that belong together.
#[derive(Clone, Debug)]
pub(super) enum Block {
    /// Values that the file lists.
    Listed(Listed),
    /// Values that are drawn.
    Drawn(Drawn),
}

impl Block {
    /// The block that the sweep file has at `cases.{position}`; random numbers follow from `seed`.
    pub(super) fn new(
        block: &sweep_file::Block,
        position: usize,
        seed: u64,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let key = |kind| format!("cases.{position}.{kind}");
        match block {
            sweep_file::Block::Grid(axes) => {
                Listed::grid(axes, &key("grid"), frame).map(Self::Listed)
            }
            sweep_file::Block::Zip(axes) => Listed::zip(axes, &key("zip"), frame).map(Self::Listed),
            sweep_file::Block::Random(block) => {
                let seed = hash(&[seed, position as u64]);
                Drawn::new(block, seed, &key("random"), frame).map(Self::Drawn)
            }
        }
    }

    /// Number of cases.
    pub(super) fn count(&self) -> u64 {
        match self {
            Block::Listed(block) => block.count(),
            Block::Drawn(block) => block.count(),
        }
    }

    /// What case `index`, which must be below [`Block::count`], sets.
    pub(super) fn assignments(&self, index: u64, frame: &Frame) -> Assignments {
        match self {
            Block::Listed(block) => block.assignments(index, frame),
            Block::Drawn(block) => block.assignments(index, frame),
        }
    }

    /// Cases to be tried before anything is run: they show every value that the file names.
    pub(super) fn probes(&self) -> Vec<u64> {
        match self {
            Block::Listed(block) => block.probes(),
            Block::Drawn(block) => block.probes(),
        }
    }

    /// Key in the sweep file, and path in the machine file, of what case `index` sets.
    pub(super) fn keys(&self, index: u64, frame: &Frame) -> Vec<(String, String)> {
        match self {
            Block::Listed(block) => block.keys(index, frame),
            Block::Drawn(block) => block.keys(frame),
        }
    }

    /// The joints that case `index` names as worn; none where the block has no axis `joints`.
    pub(super) fn named(&self, index: u64) -> Option<&JointSet> {
        match self {
            Block::Listed(block) => block.named(index),
            Block::Drawn(block) => block.named(index),
        }
    }

    /// Paths of the machine file that have an axis of their own, in order, each with values that
    /// show what it goes through.
    pub(super) fn paths(&self) -> Vec<(&str, Vec<Value>)> {
        fn paths(
            (target, values): (&Target, Vec<Value>),
        ) -> impl Iterator<Item = (&str, Vec<Value>)> {
            let paths = match target {
                Target::Paths(paths) => paths.as_slice(),
                _ => &[],
            };
            paths
                .iter()
                .map(move |path| (path.as_str(), values.clone()))
        }
        match self {
            Block::Listed(block) => block.targets().flat_map(paths).collect(),
            Block::Drawn(block) => block.targets().flat_map(paths).collect(),
        }
    }
}
