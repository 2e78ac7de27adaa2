//! Blocks whose values are listed: a grid of every combination, or lists side by side.

use input::Error;
use serde_json::Value;

use super::axis::{Assignments, Axis, Frame, JointSet, Target, check_clearances, each, own};
use super::levels::Levels;
use crate::design::full_factorial;
use crate::sweep_file::{self, Axes, Values};

/// A block whose values are listed.
#[derive(Clone, Debug)]
pub(super) struct Listed {
    /// The sets of joints; one empty set where the block has no axis `joints`.
    sets: Vec<JointSet>,
    /// Whether the block has an axis `joints`.
    has_joints: bool,
    axes: Vec<Axis<Levels>>,
    arrangement: Arrangement,
}

/// Which values come together.
#[derive(Clone, Debug)]
enum Arrangement {
    /// Every combination: one grid per set of joints, with the number of levels of each axis. An
    /// axis without meaning for a set, such as a clearance without joints, has one level.
    Grid { sizes: Vec<Vec<u64>> },
    /// The first values, the second values, ...; an axis of one value keeps it.
    Zip { count: u64 },
}

/// Levels beyond which only the ends of an axis are tried beforehand.
const TRIED: u64 = 1000;

impl Listed {
    /// The grid at `key` of the sweep file.
    pub(super) fn grid(
        from: &Axes<sweep_file::Levels>,
        key: &str,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let (sets, axes) = read(from, key, frame)?;
        let own = own(&axes);
        let size = |axis: &Axis<Levels>, set: &JointSet| match axis.target.says(set, &own) {
            true => axis.values.len(),
            // One case, and none where the axis has no value.
            false => axis.values.len().min(1),
        };
        let sizes: Vec<Vec<u64>> = sets
            .iter()
            .map(|set| axes.iter().map(|axis| size(axis, set)).collect())
            .collect();
        let total = sizes.iter().try_fold(0_u64, |total, sizes| {
            total.checked_add(full_factorial::count(sizes)?)
        });
        if total.is_none() {
            let found = "more than 2^64 combinations";
            return Err(Error::unexpected(
                key,
                found,
                "fewer values, or a random design",
            ));
        }
        let arrangement = Arrangement::Grid { sizes };
        Ok(Self {
            sets,
            has_joints: from.joints().is_some(),
            axes,
            arrangement,
        })
    }

    /// The lists at `key` of the sweep file.
    pub(super) fn zip(
        from: &Axes<sweep_file::Levels>,
        key: &str,
        frame: &Frame,
    ) -> Result<Self, Error> {
        let (sets, axes) = read(from, key, frame)?;
        let joints = (format!("{key}.joints"), sets.len() as u64);
        let lengths = axes
            .iter()
            .map(|axis| (axis.key.clone(), axis.values.len()));
        let several = std::iter::once(joints)
            .chain(lengths)
            .filter(|(_, length)| *length != 1);
        let several: Vec<(String, u64)> = several.collect();
        let count = several.first().map_or(1, |(_, length)| *length);
        if let Some((axis, length)) = several.iter().find(|(_, length)| *length != count) {
            let expected = format!("{count} values, as {} has, or one", several[0].0);
            return Err(Error::unexpected(
                axis,
                format_args!("{length} values"),
                expected,
            ));
        }
        let arrangement = Arrangement::Zip { count };
        Ok(Self {
            sets,
            has_joints: from.joints().is_some(),
            axes,
            arrangement,
        })
    }

    /// Number of cases.
    pub(super) fn count(&self) -> u64 {
        match &self.arrangement {
            Arrangement::Grid { sizes } => sizes.iter().map(|sizes| product(sizes)).sum(),
            Arrangement::Zip { count } => *count,
        }
    }

    /// What case `index` sets.
    pub(super) fn assignments(&self, index: u64, frame: &Frame) -> Assignments {
        let (set, levels) = self.levels(index);
        let own = own(&self.axes);
        let mut result = Vec::new();
        for (axis, level) in self.axes.iter().zip(levels) {
            let value = axis.values.at(level);
            frame.assign(&axis.target, &value, &self.sets[set], &own, &mut result);
        }
        result
    }

    /// The set of joints and the level of every axis of case `index`.
    fn levels(&self, index: u64) -> (usize, Vec<usize>) {
        match &self.arrangement {
            Arrangement::Grid { sizes } => {
                let mut rest = index;
                for (set, sizes) in sizes.iter().enumerate() {
                    let part = product(sizes);
                    if rest < part {
                        return (set, full_factorial::levels(rest, sizes));
                    }
                    rest -= part;
                }
                (0, vec![0; self.axes.len()])
            }
            Arrangement::Zip { .. } => {
                let of = |length: u64| if length == 1 { 0 } else { index as usize };
                let levels = self.axes.iter().map(|axis| of(axis.values.len()));
                (of(self.sets.len() as u64), levels.collect())
            }
        }
    }

    /// Cases that between them have every value of every axis.
    pub(super) fn probes(&self) -> Vec<u64> {
        let sizes = match &self.arrangement {
            Arrangement::Grid { sizes } => sizes,
            Arrangement::Zip { count } => return tried(*count),
        };
        let mut probes = Vec::new();
        let mut start = 0;
        for sizes in sizes {
            let part = product(sizes);
            if part > 0 {
                probes.push(start);
            }
            let mut stride = part;
            for &size in sizes.iter().filter(|_| part > 0) {
                stride /= size;
                let others = tried(size).into_iter().filter(|level| *level > 0);
                probes.extend(others.map(|level| start + level * stride));
            }
            start += part;
        }
        probes
    }

    /// Key in the sweep file, and path in the machine file, of what case `index` sets.
    pub(super) fn keys(&self, index: u64, frame: &Frame) -> Vec<(String, String)> {
        let (set, levels) = self.levels(index);
        let own = own(&self.axes);
        let mut keys = Vec::new();
        for (axis, level) in self.axes.iter().zip(levels) {
            let (value, key) = (axis.values.at(level), axis.values.key(&axis.key, level));
            let mut assigned = Vec::new();
            frame.assign(&axis.target, &value, &self.sets[set], &own, &mut assigned);
            keys.extend(assigned.into_iter().map(|(path, _)| (key.clone(), path)));
        }
        keys
    }

    /// The set of joints that case `index` names; none where the block has no axis `joints`.
    pub(super) fn named(&self, index: u64) -> Option<&JointSet> {
        let (set, _) = self.levels(index);
        self.has_joints.then(|| &self.sets[set])
    }

    /// What the axes set, each with values that show what it goes through.
    pub(super) fn targets(&self) -> impl Iterator<Item = (&Target, Vec<Value>)> {
        let axes = self.axes.iter();
        axes.map(|axis| (&axis.target, axis.values.representatives()))
    }
}

/// Combinations of a grid whose total is known to fit.
fn product(sizes: &[u64]) -> u64 {
    full_factorial::count(sizes).unwrap_or(u64::MAX)
}

fn tried(count: u64) -> Vec<u64> {
    match count {
        0..=TRIED => (0..count).collect(),
        more => vec![0, more - 1],
    }
}

/// The sets of joints and the other axes.
fn read(
    axes: &Axes<sweep_file::Levels>,
    key: &str,
    frame: &Frame,
) -> Result<(Vec<JointSet>, Vec<Axis<Levels>>), Error> {
    let joints = axes.joints();
    let at = format!("{key}.joints");
    let sets = match joints {
        None => vec![Vec::new()],
        Some(Values::List(sets)) => each(sets, |set| frame.set(set)).map_err(|e| e.under(at))?,
        Some(_) => return Err(Frame::not_sets().under(at)),
    };
    let mut read = Vec::new();
    for (name, levels) in axes.others() {
        let key = format!("{key}.{name}");
        let target = frame.target(name, joints.map(|_| sets.as_slice()), &key)?;
        let values = Levels::new(levels).map_err(|e| e.under(&key))?;
        if let (Target::Load, Levels::List(loads)) = (&target, &values) {
            each(loads, |load| frame.check_load(load)).map_err(|e| e.under(&key))?;
        }
        read.push(Axis {
            key,
            target,
            values,
        });
    }
    check_clearances(&sets, &read, key, frame)?;
    Ok((sets, read))
}
