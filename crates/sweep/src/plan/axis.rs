//! What an axis sets, and what that means in the machine file.

use input::{Error, paths};
use serde_json::Value;
use std::collections::BTreeSet;

use crate::labels::Joint;

/// Values at paths of the machine file.
pub(super) type Assignments = Vec<(String, Value)>;

/// Joints by index in the machine's list.
pub(super) type JointSet = Vec<usize>;

/// What an axis sets.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Target {
    /// The clearance of every joint of the set that has no axis of its own.
    Clearance,
    /// The clearance of one joint, where it is in the set.
    ClearanceOf { joint: usize },
    /// Suction and discharge pressure of every throw.
    Load,
    /// One value at each of these paths: at one, or at the same key of several joints.
    Paths(Vec<String>),
}

/// One axis of a block.
#[derive(Clone, Debug)]
pub(super) struct Axis<V> {
    /// Where the axis stands in the sweep file: `cases.0.grid.speed`.
    pub key: String,
    /// What it sets.
    pub target: Target,
    /// Its values.
    pub values: V,
}

/// What axes are read against.
pub(super) struct Frame<'a> {
    /// The machine file's tree.
    pub machine: &'a Value,
    /// Its joints.
    pub joints: &'a [Joint],
    /// Names of its throws; one empty name in a machine of one.
    pub throws: &'a [String],
}

impl Frame<'_> {
    /// What the axis `name` at `key` of the sweep file sets; `sets` are those of the axis `joints`
    /// beside it, where there is one.
    pub(super) fn target(
        &self,
        name: &str,
        sets: Option<&[JointSet]>,
        key: &str,
    ) -> Result<Target, Error> {
        match name {
            "clearance" if sets.is_some() => Ok(Target::Clearance),
            "clearance" => Err(Error::unexpected(
                key,
                "a clearance without joints",
                "an axis joints beside it, e.g. 'joints: [[], [big_end]]'",
            )),
            "load" => Ok(Target::Load),
            // A dataset has one sample rate.
            "sample_rate" => Err(Error::unexpected(
                key,
                "sample_rate",
                "one rate for all cases, as run.sample_rate, e.g. 10 kHz",
            )),
            path => {
                if let Some(paths) = self.below_joints(path, sets.unwrap_or_default()) {
                    return Ok(Target::Paths(paths.map_err(|e| e.under(key))?));
                }
                let found = paths::get(self.machine, path);
                found.map_err(|e| Error::new(key, self.with_short_names(e).problem().clone()))?;
                let joint = self.joints.iter().position(|j| j.clearance_path == path);
                Ok(match joint {
                    Some(joint) if sets.is_some() => Target::ClearanceOf { joint },
                    _ => Target::Paths(vec![path.to_owned()]),
                })
            }
        }
    }

    /// The paths of a key such as `contact.damping` in every joint that any of the sets names; none
    /// where its first part is no key of a joint. All these joints have the value in every case, so
    /// that cases with clearance in different joints stay comparable.
    fn below_joints(&self, key: &str, sets: &[JointSet]) -> Option<Result<Vec<String>, Error>> {
        let named = sets.iter().flatten().collect::<BTreeSet<_>>();
        let sections: Vec<&str> = named
            .into_iter()
            .filter_map(|&joint| self.joints[joint].clearance_path.strip_suffix("clearance"))
            .collect();
        let first = key.split('.').next().unwrap_or_default();
        let known = |section: &&str| paths::get(self.machine, &format!("{section}{first}")).is_ok();
        if sections.is_empty() || !sections.iter().all(known) {
            return None;
        }
        let paths = sections.into_iter().map(|section| {
            let path = format!("{section}{key}");
            let found = paths::get(self.machine, &path);
            found.map_err(|e| Error::new("", e.problem().clone()))?;
            Ok(path)
        });
        Some(paths.collect())
    }

    /// An unknown first part of a path may have been meant as `clearance` or `load`, too.
    fn with_short_names(&self, error: Error) -> Error {
        match error.problem() {
            input::Problem::UnknownKey { known, .. } if !error.key().contains('.') => {
                let mut names: Vec<&str> = vec!["joints", "clearance", "load"];
                let others = known.iter().map(String::as_str).filter(|k| *k != "joints");
                names.extend(others);
                Error::unknown_key(error.key(), &names)
            }
            _ => error,
        }
    }

    /// The joints that a list of names means.
    pub(super) fn set(&self, value: &Value) -> Result<JointSet, Error> {
        let Value::Array(names) = value else {
            let found = value.to_string();
            return Err(Error::unexpected(
                "",
                found,
                "a list of joints, e.g. [big_end]",
            ));
        };
        let known: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
        let mut set = names
            .iter()
            .enumerate()
            .map(|(i, name)| {
                let name = name.as_str().unwrap_or_default();
                let joint = known.iter().position(|k| *k == name);
                joint.ok_or_else(|| Error::unknown_name(i.to_string(), name, &known))
            })
            .collect::<Result<JointSet, Error>>()?;
        set.sort_unstable();
        set.dedup();
        Ok(set)
    }

    /// What is said of `joints` that are no list of sets.
    pub(super) fn not_sets() -> Error {
        let expected = "a list of lists of joints, e.g. [[], [big_end], [big_end, small_end]]";
        Error::unexpected("", "something else", expected)
    }

    /// What `target` at `value` sets in a case with the oversized joints `set`; `own` are the
    /// joints that have an axis of their own.
    pub(super) fn assign(
        &self,
        target: &Target,
        value: &Value,
        set: &[usize],
        own: &[usize],
        assignments: &mut Assignments,
    ) {
        let clearance = |joint: usize| (self.joints[joint].clearance_path.clone(), value.clone());
        match target {
            Target::Clearance => {
                let joints = set.iter().filter(|j| !own.contains(j));
                assignments.extend(joints.map(|&joint| clearance(joint)));
            }
            Target::ClearanceOf { joint } if set.contains(joint) => {
                assignments.push(clearance(*joint));
            }
            Target::ClearanceOf { .. } => {}
            Target::Load => self.assign_load(value, assignments),
            Target::Paths(paths) => {
                assignments.extend(paths.iter().map(|path| (path.clone(), value.clone())));
            }
        }
    }

    /// `{suction: .., discharge: ..}` of every throw, or a section of those by throw.
    fn assign_load(&self, value: &Value, assignments: &mut Assignments) {
        for throw in self.throws {
            let (load, section) = match throw.as_str() {
                "" => (value, String::new()),
                name => (value.get(name).unwrap_or(value), format!("throws.{name}.")),
            };
            for side in LOAD {
                if let Some(pressure) = load.get(side) {
                    let path = format!("{section}cylinder.{side}");
                    assignments.push((path, pressure.clone()));
                }
            }
        }
    }

    /// Checks the form of a load.
    pub(super) fn check_load(&self, value: &Value) -> Result<(), Error> {
        let throws: Vec<&str> = self.throws.iter().map(String::as_str).collect();
        let by_throw = value.as_object().is_some_and(|section| {
            let mut keys = section.keys();
            keys.any(|key| !key.is_empty() && throws.contains(&key.as_str()))
        });
        if !by_throw {
            return check_pressures(value);
        }
        for (throw, load) in value.as_object().into_iter().flatten() {
            if !throws.contains(&throw.as_str()) {
                return Err(Error::unknown_key(throw, &throws));
            }
            check_pressures(load).map_err(|e| e.under(throw))?;
        }
        Ok(())
    }
}

const LOAD: [&str; 2] = ["suction", "discharge"];

fn check_pressures(load: &Value) -> Result<(), Error> {
    const EXPECTED: &str = "'{suction: 0.1 MPa, discharge: 0.4 MPa}'";
    let Some(section) = load.as_object().filter(|section| !section.is_empty()) else {
        return Err(Error::unexpected("", load, EXPECTED));
    };
    match section.keys().find(|key| !LOAD.contains(&key.as_str())) {
        Some(key) => Err(Error::unknown_key(key, &LOAD)),
        None => Ok(()),
    }
}

impl Target {
    /// Whether the target is anything in a case with the joints `set`, of which `own` have an axis
    /// of their own.
    pub(super) fn says(&self, set: &[usize], own: &[usize]) -> bool {
        match self {
            Target::Clearance => set.iter().any(|joint| !own.contains(joint)),
            Target::ClearanceOf { joint } => set.contains(joint),
            Target::Load | Target::Paths(_) => true,
        }
    }
}

/// The joints with an axis of their own.
pub(super) fn own<V>(axes: &[Axis<V>]) -> JointSet {
    let joint = |axis: &Axis<V>| match axis.target {
        Target::ClearanceOf { joint } => Some(joint),
        _ => None,
    };
    axes.iter().filter_map(joint).collect()
}

/// Checks that every joint of the sets of the block at `key` gets its clearance from somewhere.
pub(super) fn check_clearances<V>(
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
            let key = format!("{key}.joints");
            Err(Error::unexpected(key, "joints without clearance", expected))
        }
    }
}

/// Reads every value of a list, and says which one is wrong.
pub(super) fn each<T>(
    values: &[Value],
    read: impl Fn(&Value) -> Result<T, Error>,
) -> Result<Vec<T>, Error> {
    let read = |(i, value)| read(value).map_err(|e| e.under(i));
    values.iter().enumerate().map(read).collect()
}
