//! A block of cases, made ready: what its case at an index sets in the machine file.

use input::{Error, paths};
use serde_json::Value;

use super::axis::{Assignments, Axis, Frame, JointSet, Target};
use super::sampler::{Sampler, same_dimension};
use crate::design::hash::hash;
use crate::design::{full_factorial, latin_hypercube, random, sobol};
use crate::distribution::{Distribution, choose};
use crate::sweep_file::{self, Amount, Axes, Design, Draw, Levels, Spacing, Values};

/// Cases that belong together.
#[derive(Clone, Debug)]
pub(super) enum Block {
    /// Every combination. One sub-grid per set of joints, because axes that say nothing about a
    /// set (a clearance where no joint has one) count once there.
    Grid {
        sets: Vec<JointSet>,
        axes: Vec<Axis<Vec<Value>>>,
        /// Levels of every axis in each sub-grid.
        sizes: Vec<Vec<u64>>,
    },
    /// One value of each axis after the other; an axis of one value keeps it.
    Zip {
        sets: Vec<JointSet>,
        axes: Vec<Axis<Vec<Value>>>,
        count: u64,
    },
    /// Draws.
    Random {
        sets: Vec<JointSet>,
        weights: Vec<f64>,
        axes: Vec<Axis<Sampler>>,
        /// The joints that `clearance` draws for, each for itself.
        joints: JointSet,
        design: Design,
        count: u64,
        seed: u64,
    },
}

/// Levels beyond which only the ends of an axis are tried beforehand.
const TRIED: u64 = 1000;

impl Block {
    /// The block that the sweep file has at `cases.{position}`; random numbers follow from `seed`.
    pub(super) fn new(
        block: &sweep_file::Block,
        position: usize,
        seed: u64,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let key = format!("cases.{position}");
        match block {
            sweep_file::Block::Grid(axes) => Self::grid(axes, &format!("{key}.grid"), frame),
            sweep_file::Block::Zip(axes) => Self::zip(axes, &format!("{key}.zip"), frame),
            sweep_file::Block::Random(block) => {
                let seed = hash(&[seed, position as u64]);
                Self::random(block, seed, &format!("{key}.random"), frame)
            }
        }
    }

    fn grid(axes: &Axes<Levels>, key: &str, frame: &Frame) -> Result<Self, Error> {
        let (sets, axes) = levels(axes, key, frame)?;
        let sizes: Vec<Vec<u64>> = sets
            .iter()
            .map(|set| {
                let size = |axis: &Axis<Vec<Value>>| match says(&axis.target, set, &own(&axes)) {
                    true => axis.values.len() as u64,
                    false => 1,
                };
                axes.iter().map(size).collect()
            })
            .collect();
        let total = sizes.iter().try_fold(0_u64, |total, sizes| {
            total.checked_add(full_factorial::count(sizes)?)
        });
        if total.is_none() {
            let found = "more than 2^64 combinations";
            return Err(Error::found(key, found, "fewer values, or a random design"));
        }
        Ok(Block::Grid { sets, axes, sizes })
    }

    fn zip(axes: &Axes<Levels>, key: &str, frame: &Frame) -> Result<Self, Error> {
        let (sets, axes) = levels(axes, key, frame)?;
        let lengths = std::iter::once(("joints", sets.len())).chain(
            axes.iter()
                .map(|axis| (axis.key.as_str(), axis.values.len())),
        );
        let several: Vec<(&str, usize)> = lengths.filter(|(_, length)| *length != 1).collect();
        let count = several.first().map_or(1, |(_, length)| *length);
        if let Some((axis, length)) = several.iter().find(|(_, length)| *length != count) {
            let expected = format!("{count} values, as {} has, or one", several[0].0);
            return Err(Error::found(
                *axis,
                format_args!("{length} values"),
                expected,
            ));
        }
        let count = count as u64;
        Ok(Block::Zip { sets, axes, count })
    }

    fn random(
        block: &sweep_file::Random,
        seed: u64,
        key: &str,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let key = format!("{key}.axes");
        let joints = find(&block.axes, "joints");
        let (sets, weights) = match joints {
            None => (vec![Vec::new()], vec![1.0]),
            Some(draw) => drawn_sets(draw, frame).map_err(|e| e.under(format!("{key}.joints")))?,
        };
        let axes = others(&block.axes)
            .map(|(name, draw)| {
                let key = format!("{key}.{name}");
                let target = frame.target(name, joints.is_some(), &key)?;
                let given = match &target {
                    Target::Path(path) => paths::get(frame.machine, path)?,
                    _ => None,
                };
                let values = Sampler::new(draw, given).map_err(|e| e.under(&key))?;
                if let (Target::Load, Sampler::Choice { values, .. }) = (&target, &values) {
                    each(values, |load| frame.check_load(load)).map_err(|e| e.under(&key))?;
                }
                Ok(Axis {
                    key,
                    target,
                    values,
                })
            })
            .collect::<Result<Vec<_>, Error>>()?;
        let own = own(&axes);
        let mut drawn: JointSet = sets.concat();
        drawn.sort_unstable();
        drawn.dedup();
        drawn.retain(|joint| !own.contains(joint));
        check_clearances(&sets, &axes, &key, frame)?;
        let block = Block::Random {
            sets,
            weights,
            axes,
            joints: drawn,
            design: block.design,
            count: block.count.get().into(),
            seed,
        };
        let draws = block.draws();
        if block.is_sobol() && draws > sobol::DIMENSIONS {
            let expected = format!(
                "at most {} with sobol; latin_hypercube has no limit",
                sobol::DIMENSIONS
            );
            return Err(Error::found(
                key,
                format_args!("{draws} draws a case"),
                expected,
            ));
        }
        Ok(block)
    }

    fn is_sobol(&self) -> bool {
        matches!(self, Block::Random { design, .. } if *design == Design::Sobol)
    }

    /// Numbers that one case of a random block draws.
    fn draws(&self) -> usize {
        match self {
            Block::Random { axes, joints, .. } => {
                let clearances = axes.iter().any(|a| a.target == Target::Clearance);
                1 + axes.len() + if clearances { joints.len() } else { 0 }
            }
            _ => 0,
        }
    }

    /// Number of cases.
    pub(super) fn count(&self) -> u64 {
        match self {
            Block::Grid { sizes, .. } => {
                let parts = sizes
                    .iter()
                    .filter_map(|sizes| full_factorial::count(sizes));
                parts.sum()
            }
            Block::Zip { count, .. } | Block::Random { count, .. } => *count,
        }
    }

    /// What case `index` sets; `index` must be below [`Block::count`].
    pub(super) fn assignments(&self, index: u64, frame: &Frame) -> Assignments {
        let mut result = Vec::new();
        match self {
            Block::Random {
                sets,
                weights,
                axes,
                joints,
                ..
            } => {
                let units = self.units(index);
                let set = &sets[choose(weights, units[0])];
                let own = own(axes);
                for (axis, unit) in axes.iter().zip(&units[1..]) {
                    if axis.target != Target::Clearance {
                        let value = axis.values.draw(*unit);
                        frame.assign(&axis.target, &value, set, &own, &mut result);
                        continue;
                    }
                    for (joint, unit) in joints.iter().zip(&units[1 + axes.len()..]) {
                        if set.contains(joint) {
                            let value = axis.values.draw(*unit);
                            frame.assign(&axis.target, &value, &[*joint], &[], &mut result);
                        }
                    }
                }
            }
            Block::Grid { sets, axes, .. } | Block::Zip { sets, axes, .. } => {
                let (set, levels) = self.levels(index);
                let own = own(axes);
                for (axis, level) in axes.iter().zip(levels) {
                    let value = &axis.values[level];
                    frame.assign(&axis.target, value, &sets[set], &own, &mut result);
                }
            }
        }
        result
    }

    /// The point of a random block's design.
    fn units(&self, index: u64) -> Vec<f64> {
        let Block::Random {
            design,
            count,
            seed,
            ..
        } = self
        else {
            return Vec::new();
        };
        let dimensions = 0..self.draws();
        match design {
            Design::Sobol => dimensions
                .map(|d| sobol::scrambled(*seed, index, d))
                .collect(),
            Design::LatinHypercube => dimensions
                .map(|d| latin_hypercube::point(*seed, index, *count, d))
                .collect(),
            Design::Random => random::point(*seed, index, dimensions.end),
        }
    }

    /// The set of joints and the level of every axis of a grid's or zip's case.
    pub(super) fn levels(&self, index: u64) -> (usize, Vec<usize>) {
        match self {
            Block::Grid { sizes, .. } => {
                let mut rest = index;
                for (set, sizes) in sizes.iter().enumerate() {
                    let part = full_factorial::count(sizes).unwrap_or(u64::MAX);
                    if rest < part {
                        return (set, full_factorial::levels(rest, sizes));
                    }
                    rest -= part;
                }
                (0, Vec::new())
            }
            Block::Zip { sets, axes, .. } => {
                let of = |length: usize| if length == 1 { 0 } else { index as usize };
                (
                    of(sets.len()),
                    axes.iter().map(|axis| of(axis.values.len())).collect(),
                )
            }
            Block::Random { .. } => (0, Vec::new()),
        }
    }

    /// Cases between them having every value of every axis, to be tried before anything is run.
    pub(super) fn probes(&self) -> Vec<u64> {
        match self {
            Block::Grid { sizes, .. } => {
                let mut probes = Vec::new();
                let mut start = 0;
                for sizes in sizes {
                    let part = full_factorial::count(sizes).unwrap_or(u64::MAX);
                    let mut stride = part;
                    for &size in sizes {
                        stride /= size.max(1);
                        probes.extend(tried(size).map(|level| start + level * stride));
                    }
                    if sizes.is_empty() {
                        probes.push(start);
                    }
                    start += part;
                }
                probes
            }
            Block::Zip { count, .. } => tried(*count).collect(),
            Block::Random { count, .. } => (0..64.min(*count)).collect(),
        }
    }

    /// Key in the sweep file, and path in the machine file, of what case `index` sets.
    pub(super) fn keys(&self, index: u64, frame: &Frame) -> Vec<(String, String)> {
        let mut keys = Vec::new();
        let mut add =
            |key: String, target: &Target, value: &Value, set: &[usize], own: &[usize]| {
                let mut assigned = Vec::new();
                frame.assign(target, value, set, own, &mut assigned);
                keys.extend(assigned.into_iter().map(|(path, _)| (key.clone(), path)));
            };
        match self {
            Block::Random { axes, joints, .. } => {
                for axis in axes {
                    let value = axis.values.draw(0.5);
                    add(axis.key.clone(), &axis.target, &value, joints, &own(axes));
                }
            }
            Block::Grid { sets, axes, .. } | Block::Zip { sets, axes, .. } => {
                let (set, levels) = self.levels(index);
                for (axis, level) in axes.iter().zip(levels) {
                    let key = match axis.values.len() {
                        1 => axis.key.clone(),
                        _ => format!("{}.{level}", axis.key),
                    };
                    add(
                        key,
                        &axis.target,
                        &axis.values[level],
                        &sets[set],
                        &own(axes),
                    );
                }
            }
        }
        keys
    }

    /// Paths of the machine file that the block sets directly, in order.
    pub(super) fn paths(&self) -> Vec<&str> {
        let targets: Vec<&Target> = match self {
            Block::Random { axes, .. } => axes.iter().map(|a| &a.target).collect(),
            Block::Grid { axes, .. } | Block::Zip { axes, .. } => {
                axes.iter().map(|a| &a.target).collect()
            }
        };
        let path = |target| match target {
            &Target::Path(ref path) => Some(path.as_str()),
            _ => None,
        };
        targets.into_iter().filter_map(path).collect()
    }
}

/// The joints with an axis of their own.
fn own<V>(axes: &[Axis<V>]) -> JointSet {
    let joint = |axis: &Axis<V>| match axis.target {
        Target::ClearanceOf { joint } => Some(joint),
        _ => None,
    };
    axes.iter().filter_map(joint).collect()
}

/// Whether an axis changes anything in a case with the joints `set`.
fn says(target: &Target, set: &[usize], own: &[usize]) -> bool {
    match target {
        Target::Clearance => set.iter().any(|joint| !own.contains(joint)),
        Target::ClearanceOf { joint } => set.contains(joint),
        Target::Load | Target::Path(_) => true,
    }
}

fn tried(count: u64) -> Box<dyn Iterator<Item = u64>> {
    match count {
        0..=TRIED => Box::new(0..count),
        more => Box::new([0, more - 1].into_iter()),
    }
}

fn find<'a, T>(axes: &'a Axes<T>, name: &str) -> Option<&'a T> {
    axes.0
        .iter()
        .find(|(n, _)| n == name)
        .map(|(_, values)| values)
}

fn others<T>(axes: &Axes<T>) -> impl Iterator<Item = (&str, &T)> {
    let named = axes.0.iter().map(|(name, values)| (name.as_str(), values));
    named.filter(|(name, _)| *name != "joints")
}

/// Runs `check` on every value of a list, and says which one fails.
fn each<T>(values: &[Value], check: impl Fn(&Value) -> Result<T, Error>) -> Result<Vec<T>, Error> {
    let check = |(i, value)| check(value).map_err(|e| e.under(i));
    values.iter().enumerate().map(check).collect()
}

/// The sets of joints and the other axes of a grid or a zip.
#[expect(
    clippy::type_complexity,
    reason = "used once, and a name would say no more"
)]
fn levels(
    axes: &Axes<Levels>,
    key: &str,
    frame: &Frame,
) -> Result<(Vec<JointSet>, Vec<Axis<Vec<Value>>>), Error> {
    let joints = find(axes, "joints");
    let sets = match joints {
        None => vec![Vec::new()],
        Some(Values::List(sets)) => {
            each(sets, |set| frame.set(set)).map_err(|e| e.under(format!("{key}.joints")))?
        }
        Some(_) => return Err(not_sets(&format!("{key}.joints"))),
    };
    let axes = others(axes)
        .map(|(name, levels)| {
            let key = format!("{key}.{name}");
            let target = frame.target(name, joints.is_some(), &key)?;
            let values = expand(levels).map_err(|e| e.under(&key))?;
            if target == Target::Load {
                each(&values, |load| frame.check_load(load)).map_err(|e| e.under(&key))?;
            }
            Ok(Axis {
                key,
                target,
                values,
            })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    check_clearances(&sets, &axes, key, frame)?;
    Ok((sets, axes))
}

fn not_sets(key: &str) -> Error {
    let expected = "a list of lists of joints, e.g. [[], [big_end], [big_end, small_end]]";
    Error::found(key, "something else", expected)
}

/// The sets of joints that a draw chooses from, and how likely each is.
fn drawn_sets(draw: &Draw, frame: &Frame) -> Result<(Vec<JointSet>, Vec<f64>), Error> {
    match Sampler::new(draw, None)? {
        Sampler::Choice { values, weights } => {
            let sets = each(&values, |set| frame.set(set)).map_err(|e| match draw {
                Values::Rule(_) => e.under("choice.values"),
                _ => e,
            })?;
            Ok((sets, weights))
        }
        Sampler::Number { .. } => Err(not_sets("")),
    }
}

/// Every joint of a set must get its clearance from somewhere.
fn check_clearances<V>(
    sets: &[JointSet],
    axes: &[Axis<V>],
    key: &str,
    frame: &Frame,
) -> Result<(), Error> {
    if axes.iter().any(|axis| axis.target == Target::Clearance) {
        return Ok(());
    }
    let own = own(axes);
    match sets.iter().flatten().find(|joint| !own.contains(joint)) {
        None => Ok(()),
        Some(&joint) => {
            let path = &frame.joints[joint].clearance_path;
            let expected = format!("an axis clearance, or {path}, beside it");
            Err(Error::found(
                format!("{key}.joints"),
                "joints without clearance",
                expected,
            ))
        }
    }
}

/// The values of an axis, one by one.
fn expand(levels: &Levels) -> Result<Vec<Value>, Error> {
    let range = match levels {
        Values::One(value) => return Ok(vec![value.clone()]),
        Values::List(values) => return Ok(values.clone()),
        Values::Rule(range) => range,
    };
    same_dimension(&[range.from, range.to])?;
    let (low, high) = (range.from.si, range.to.si);
    let distribution = match range.spacing {
        Spacing::Linear => Distribution::Uniform { low, high },
        Spacing::Log if low > 0.0 && high > 0.0 => Distribution::LogUniform { low, high },
        Spacing::Log => return Err(Error::found("from", "0 or less", "more than 0")),
    };
    let steps = range.count.get() - 1;
    let value = |step: u32| match step {
        0 => range.from,
        step if step == steps => range.to,
        step => Amount {
            si: distribution.quantile(f64::from(step) / f64::from(steps)),
            ..range.from
        },
    };
    Ok((0..=steps).map(|step| value(step).to_value()).collect())
}
