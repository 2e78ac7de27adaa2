//! What a run at clearances that no calibration saw shows under each relation that is not excluded.

use crate::error::Error;
use crate::observation::{Observation, Run};
use crate::problem::Problem;
use crate::relation::ClearJoint;
use crate::replay::{Replay, replay};
use input::paths;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Relative difference of two clearances that is one.
const OTHER: f64 = 1e-6;

/// A run that is predicted from another clearance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelationSpread {
    /// The joints whose contact is stated for another clearance, by path.
    pub joints: BTreeMap<String, CarriedOver>,
    /// What each relation shows.
    pub relations: Vec<Variant>,
    /// The least and the greatest over the relations, by column.
    pub channels: BTreeMap<String, Spread>,
}

/// A joint whose contact follows a relation from one clearance to another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CarriedOver {
    /// The clearance for which its contact is stated, m.
    pub stated_for_m: f64,
    /// Its clearance in the run, m.
    pub clearance_m: f64,
}

/// A run under a relation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Variant {
    /// The relation as a machine file has it.
    pub relation: Value,
    /// Why the run cannot be simulated; it has no channels then.
    pub failure: Option<String>,
    /// What its channels show, by column.
    pub channels: BTreeMap<String, Shown>,
}

/// What a channel shows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shown {
    /// Difference of the synchronous means, over the recording's RMS about its mean.
    pub difference: f64,
    /// RMS of the samples about their mean, SI.
    pub rms: f64,
    /// Greatest magnitude of the samples about their mean, SI.
    pub peak: f64,
    /// RMS of the difference to the samples under the machine's own relation, over the recording's RMS.
    pub apart: f64,
}

/// The least and the greatest over the relations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// As [`Shown::difference`].
    pub difference: [f64; 2],
    /// As [`Shown::rms`].
    pub rms: [f64; 2],
    /// As [`Shown::peak`].
    pub peak: [f64; 2],
    /// As [`Shown::apart`], the greatest.
    pub apart: f64,
}

/// Simulates `run` under each of `relations`. `own` is its replay as the machine file has it. `known_at` are the
/// clearances for which contacts hold whose clearance the machine file does not state.
/// None where every joint has the clearance that its contact is known at.
///
/// # Errors
/// A machine file whose joints cannot be read.
pub fn relation_spread(
    problem: &Problem,
    run: &Run,
    observation: &Observation,
    own: &Replay,
    relations: &[Value],
    known_at: &BTreeMap<String, f64>,
) -> Result<Option<RelationSpread>, Error> {
    let joints = carried_over(problem, run, known_at)?;
    if joints.is_empty() {
        return Ok(None);
    }
    let variants = relations.par_iter().map(|relation| {
        let shown = under(problem, run, observation, &joints, relation);
        match shown {
            Ok(replay) => Variant {
                relation: relation.clone(),
                failure: None,
                channels: shown_by(&replay, own),
            },
            Err(error) => Variant {
                relation: relation.clone(),
                failure: Some(error.to_string()),
                channels: BTreeMap::new(),
            },
        }
    });
    let relations: Vec<Variant> = variants.collect();
    let mut channels = BTreeMap::new();
    for (column, as_stated) in shown_by(own, own) {
        let all = relations.iter().filter_map(|v| v.channels.get(&column));
        let all: Vec<Shown> = all.copied().chain([as_stated]).collect();
        let range = |of: fn(&Shown) -> f64| {
            let ends = [f64::INFINITY, f64::NEG_INFINITY];
            all.iter()
                .map(of)
                .fold(ends, |[low, high], x| [low.min(x), high.max(x)])
        };
        let spread = Spread {
            difference: range(|s| s.difference),
            rms: range(|s| s.rms),
            peak: range(|s| s.peak),
            apart: range(|s| s.apart)[1],
        };
        channels.insert(column, spread);
    }
    Ok(Some(RelationSpread {
        joints,
        relations,
        channels,
    }))
}

/// The joints of a run whose contact is stated for another clearance.
fn carried_over(
    problem: &Problem,
    run: &Run,
    known_at: &BTreeMap<String, f64>,
) -> Result<BTreeMap<String, CarriedOver>, Error> {
    let mut joints = BTreeMap::new();
    for joint in ClearJoint::in_runs(&problem.tree, std::iter::once(&run.settings[..]))? {
        let stated = joint.at_clearance(&problem.tree)?;
        let Some(stated) = stated.or_else(|| known_at.get(&joint.path).copied()) else {
            continue;
        };
        if (joint.clearance / stated - 1.0).abs() > OTHER {
            let carried = CarriedOver {
                stated_for_m: stated,
                clearance_m: joint.clearance,
            };
            joints.insert(joint.path, carried);
        }
    }
    Ok(joints)
}

fn under(
    problem: &Problem,
    run: &Run,
    observation: &Observation,
    joints: &BTreeMap<String, CarriedOver>,
    relation: &Value,
) -> Result<Replay, Error> {
    let mut problem = problem.with_runs(|_| false);
    for (joint, carried) in joints {
        let stated = format!("{joint}.contact.at_clearance");
        let clearance = format!("{} m", carried.stated_for_m);
        paths::set(&mut problem.tree, &stated, clearance.into())?;
        let path = format!("{joint}.contact.relation");
        paths::set(&mut problem.tree, &path, relation.clone())?;
    }
    replay(&problem, run, observation, &[])
}

fn shown_by(replay: &Replay, own: &Replay) -> BTreeMap<String, Shown> {
    let channels = replay.channels.iter().zip(&own.channels);
    channels
        .map(|(channel, own)| {
            let count = channel.samples.len().max(1) as f64;
            let mean = channel.samples.iter().sum::<f64>() / count;
            let about = channel.samples.iter().map(|x| x - mean);
            let peak = about.clone().fold(0.0_f64, |most, x| most.max(x.abs()));
            let both = channel.samples.iter().zip(&own.samples);
            let apart = both.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count;
            let scale = channel.recording_rms.max(f64::MIN_POSITIVE);
            let shown = Shown {
                difference: channel.difference / scale,
                rms: (about.map(|x| x * x).sum::<f64>() / count).sqrt(),
                peak,
                apart: apart.sqrt() / scale,
            };
            (channel.column.clone(), shown)
        })
        .collect()
}
