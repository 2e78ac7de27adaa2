//! Blocks whose values are drawn.

use input::{Error, paths};
use serde_json::Value;

use super::axis::{Assignments, Axis, Frame, JointSet, Target, check_clearances, each, own};
use super::sampler::Sampler;
use crate::design::{latin_hypercube, random, sobol};
use crate::distribution::choose;
use crate::sweep_file::{self, Design, Draw, Values};

/// A block whose values are drawn.
///
/// A case is a point of the design. Its coordinates are, in this order: the set of joints, every
/// axis, and the clearance of every joint that has no axis of its own, each for itself.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    /// The sets of joints; one empty set where the block has no axis `joints`.
    sets: Vec<JointSet>,
    /// Whether the block has an axis `joints`.
    has_joints: bool,
    weights: Vec<f64>,
    axes: Vec<Axis<Sampler>>,
    /// The joints whose clearance `clearance` draws.
    joints: JointSet,
    design: Design,
    count: u64,
    seed: u64,
}

/// Cases that are tried beforehand.
const TRIED: u64 = 64;

impl Drawn {
    /// The random block at `key` of the sweep file.
    pub(super) fn new(
        block: &sweep_file::Random,
        seed: u64,
        key: &str,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let key = format!("{key}.axes");
        let joints = block.axes.joints();
        let (sets, weights) = match joints {
            None => (vec![Vec::new()], vec![1.0]),
            Some(draw) => sets(draw, frame).map_err(|e| e.under(format!("{key}.joints")))?,
        };
        let mut axes = Vec::new();
        for (name, draw) in block.axes.others() {
            let key = format!("{key}.{name}");
            let target = frame.target(name, joints.map(|_| sets.as_slice()), &key)?;
            let given = match &target {
                Target::Paths(paths) => common_value(frame, paths)?,
                _ => None,
            };
            let values = Sampler::new(draw, given).map_err(|e| e.under(&key))?;
            if let (Target::Load, Sampler::Choice { values, .. }) = (&target, &values) {
                each(values, |load| frame.check_load(load)).map_err(|e| e.under(&key))?;
            }
            axes.push(Axis {
                key,
                target,
                values,
            });
        }
        check_clearances(&sets, &axes, &key, frame)?;
        let own = own(&axes);
        let mut joints = sets.concat();
        joints.sort_unstable();
        joints.dedup();
        joints.retain(|joint| !own.contains(joint));
        let block = Self {
            sets,
            has_joints: block.axes.joints().is_some(),
            weights,
            axes,
            joints,
            design: block.design,
            count: block.count.get().into(),
            seed,
        };
        let (draws, most) = (block.dimensions(), sobol::DIMENSIONS);
        if block.design == Design::Sobol && draws > most {
            let expected = format!("at most {most} with sobol; latin_hypercube has no limit");
            return Err(Error::unexpected(
                key,
                format_args!("{draws} draws a case"),
                expected,
            ));
        }
        Ok(block)
    }

    /// Number of cases.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// What case `index` sets.
    pub(super) fn assignments(&self, index: u64, frame: &Frame) -> Assignments {
        let point = self.point(index);
        let (of_axes, of_joints) = point[1..].split_at(self.axes.len());
        let set = &self.sets[choose(&self.weights, point[0])];
        let own = own(&self.axes);
        let mut result = Vec::new();
        for (axis, unit) in self.axes.iter().zip(of_axes) {
            if axis.target != Target::Clearance {
                let value = axis.values.draw(*unit);
                frame.assign(&axis.target, &value, set, &own, &mut result);
                continue;
            }
            let drawn = self.joints.iter().zip(of_joints);
            for (joint, unit) in drawn.filter(|(joint, _)| set.contains(joint)) {
                let value = axis.values.draw(*unit);
                frame.assign(&axis.target, &value, &[*joint], &own, &mut result);
            }
        }
        result
    }

    /// Cases that are tried before anything is run.
    pub(super) fn probes(&self) -> Vec<u64> {
        (0..self.count.min(TRIED)).collect()
    }

    /// Key in the sweep file, and path in the machine file, of what a case may set.
    pub(super) fn keys(&self, frame: &Frame) -> Vec<(String, String)> {
        let mut keys = Vec::new();
        for axis in &self.axes {
            let (value, mut assigned) = (axis.values.draw(0.5), Vec::new());
            let all: JointSet = (0..frame.joints.len()).collect();
            frame.assign(&axis.target, &value, &all, &[], &mut assigned);
            keys.extend(
                assigned
                    .into_iter()
                    .map(|(path, _)| (axis.key.clone(), path)),
            );
        }
        keys
    }

    /// The set of joints that case `index` names; none where the block has no axis `joints`.
    pub(super) fn named(&self, index: u64) -> Option<&JointSet> {
        let set = || &self.sets[choose(&self.weights, self.point(index)[0])];
        self.has_joints.then(set)
    }

    /// What the axes set, each with values that show what it draws.
    pub(super) fn targets(&self) -> impl Iterator<Item = (&Target, Vec<Value>)> {
        let axes = self.axes.iter();
        axes.map(|axis| (&axis.target, axis.values.representatives()))
    }

    fn dimensions(&self) -> usize {
        1 + self.axes.len() + self.joints.len()
    }

    /// The point of the design, in the unit cube.
    fn point(&self, index: u64) -> Vec<f64> {
        let (seed, count) = (self.seed, self.count);
        let dimensions = 0..self.dimensions();
        match self.design {
            Design::Sobol => dimensions
                .map(|d| sobol::scrambled(seed, index, d))
                .collect(),
            Design::LatinHypercube => dimensions
                .map(|d| latin_hypercube::point(seed, index, count, d))
                .collect(),
            Design::Random => random::point(seed, index, dimensions.end),
        }
    }
}

/// The value of the machine file that all these paths have; none where they differ, so that nothing
/// is drawn about one joint's value for another.
fn common_value<'a>(frame: &Frame<'a>, paths: &[String]) -> Result<Option<&'a Value>, Error> {
    let mut values = paths.iter().map(|path| paths::get(frame.machine, path));
    let first = values.next().transpose()?.flatten();
    for value in values {
        if value? != first {
            return Ok(None);
        }
    }
    Ok(first)
}

/// The sets of joints that a draw chooses from, and how likely each is.
fn sets(draw: &Draw, frame: &Frame) -> Result<(Vec<JointSet>, Vec<f64>), Error> {
    let Sampler::Choice { values, weights } = Sampler::new(draw, None)? else {
        return Err(Frame::not_sets());
    };
    let sets = each(&values, |set| frame.set(set)).map_err(|e| match draw {
        Values::Rule(_) => e.under("choice.values"),
        _ => e,
    })?;
    Ok((sets, weights))
}
