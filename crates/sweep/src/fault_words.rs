//! The faults of a case one by one, in words that datasets of bearings share.
//!
//! `fault_type`, `fault_location` and `fault_severity_level` are columns of the Python package `bearing-datasets`
//! (version 0.3.0, schema version 2), with its meanings:
//!
//! | column | there | here |
//! |---|---|---|
//! | `fault_type` | the faults, joined by `+`; `normal` for none | its words: `bearing`, `unbalance`, `misalignment`, `other` |
//! | `fault_location` | the part of each of them, in this order; `none` for none | joints and parts of the machine: its own words have no crank mechanism |
//! | `fault_severity_level` | 0 healthy, then 1, 2, ... from the mildest, within the dataset and the fault | the same |

use std::cmp::Ordering;
use std::collections::BTreeMap;

use mechanism::declaration::Kind;

use crate::digits::{COMPARED, rounded};

/// The type of a healthy case.
const NORMAL: &str = "normal";
/// The location of a healthy case.
const NOWHERE: &str = "none";

/// One fault of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Its word in `fault_type`.
    pub kind: &'static str,
    /// Where it is: a joint, or a part of the machine, with the throw before it in a machine of several.
    pub location: String,
    /// What distinguishes the joint or effect from all others of the machine.
    name: String,
    /// How large it is: the clearance, m, or how far the amplitudes are from those at which the effect vanishes.
    size: Vec<f64>,
}

impl Fault {
    /// A joint with this clearance, m.
    pub(crate) fn of_joint(joint: &str, clearance: f64) -> Self {
        let guide = joint == "guide" || joint.ends_with(".guide");
        Self {
            // A guide is no bearing of the vocabulary, which follows ISO 5593.
            kind: if guide { "other" } else { "bearing" },
            location: joint.to_owned(),
            name: joint.to_owned(),
            size: vec![rounded(clearance, COMPARED)],
        }
    }

    /// An effect of this name and kind, at these words of its place, of that size.
    pub(crate) fn of_effect(
        effect: &str,
        kind: Kind,
        throw: Option<&str>,
        place: &[String],
        size: impl IntoIterator<Item = f64>,
    ) -> Self {
        let part = match (place, kind) {
            ([], Kind::Gas) => "cylinder".to_owned(),
            ([], Kind::Joint) => "joints".to_owned(),
            ([], Kind::RunningGear) => "running_gear".to_owned(),
            ([], Kind::Frame) => "frame".to_owned(),
            ([], Kind::Sensor) => "sensor".to_owned(),
            (words, _) => words.join("_"),
        };
        let location = match throw {
            Some(throw) => format!("{throw}.{part}"),
            None => part,
        };
        Self {
            kind: match (effect, kind) {
                ("rotating_unbalance", _) => "unbalance",
                ("misalignment", _) => "misalignment",
                (_, Kind::Joint) => "bearing",
                _ => "other",
            },
            name: format!("{effect} {location}"),
            location,
            size: size.into_iter().map(|x| rounded(x, COMPARED)).collect(),
        }
    }
}

/// `fault_type` of a case with these faults.
pub(crate) fn fault_type(faults: &[Fault]) -> String {
    joined(faults.iter().map(|fault| fault.kind), NORMAL)
}

/// `fault_location` of a case with these faults.
pub(crate) fn fault_location(faults: &[Fault]) -> String {
    joined(faults.iter().map(|fault| fault.location.as_str()), NOWHERE)
}

fn joined<'a>(words: impl Iterator<Item = &'a str>, none: &str) -> String {
    let words: Vec<&str> = words.collect();
    match words.as_slice() {
        [] => none.to_owned(),
        words => words.join("+"),
    }
}

/// The sizes that each joint and effect has in the faulty cases of a dataset, from the smallest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Severities(BTreeMap<String, Vec<Vec<f64>>>);

impl Severities {
    /// Of cases with these faults.
    pub fn from_cases(cases: impl IntoIterator<Item = Vec<Fault>>) -> Self {
        let mut sizes: BTreeMap<String, Vec<Vec<f64>>> = BTreeMap::new();
        for fault in cases.into_iter().flatten() {
            sizes.entry(fault.name).or_default().push(fault.size);
        }
        for sizes in sizes.values_mut() {
            sizes.sort_by(|a, b| compared(a, b));
            sizes.dedup();
        }
        Self(sizes)
    }

    /// `fault_severity_level` of a case with these faults: the highest rank of one of them among the sizes that its
    /// joint or effect has in the dataset; 0 where there is none.
    pub fn level(&self, faults: &[Fault]) -> u64 {
        let rank = |fault: &Fault| {
            let sizes = self.0.get(&fault.name).map_or(&[][..], Vec::as_slice);
            let milder = sizes.partition_point(|size| compared(size, &fault.size).is_lt());
            milder as u64 + 1
        };
        faults.iter().map(rank).max().unwrap_or(0)
    }
}

/// By the first amplitude, then by the second, and so on.
fn compared(a: &[f64], b: &[f64]) -> Ordering {
    let mut each = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    each.find(|ordering| ordering.is_ne())
        .unwrap_or(Ordering::Equal)
}
