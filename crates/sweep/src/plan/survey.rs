//! Labels and splits of the cases of a plan, before any case is run.

use std::collections::{BTreeMap, BTreeSet};

use recordings::Manifest;

use super::Plan;
use super::case::Case;
use super::census::{Census, Survey, Unnamed};
use crate::fault_words::Severities;
use crate::labels::Labels;
use crate::split::{Split, assign, stratify};

/// Points of a sweep up to which its splits are stratified by label.
///
/// Each process that makes a shard looks at all of them first, in 0.1 ms each: 2 s. In a larger sweep
/// a label of 0.5 % of the cases still has 100, of which a split of 15 % gets none with a probability
/// of 1e-7 where the draws are independent.
const MOST_STRATIFIED: u64 = 20_000;

impl Plan {
    /// Cases by label and split, computed from the plan; for a large sweep, from a sample of its cases.
    pub fn census(&self) -> &Census {
        &self.survey().census
    }

    /// The split of a group.
    pub(super) fn split(&self, group: u64) -> Split {
        let by_itself = || assign(self.shares, self.seed, group);
        if !self.is_stratified() {
            return by_itself();
        }
        let splits = self.survey().splits.as_ref();
        let known = splits.and_then(|splits| splits.get(&group).copied());
        known.unwrap_or_else(by_itself)
    }

    /// Whether the splits are stratified by label, and not drawn for each group independently.
    pub fn is_stratified(&self) -> bool {
        self.points() <= MOST_STRATIFIED
    }

    /// How severe the faults of a case are among those of the sweep: 0 for none, then 1, 2, ... from the mildest. In a
    /// sweep that is too large for stratified splits, among those of a sample of its cases.
    pub fn severity_level(&self, labels: &Labels) -> u64 {
        self.survey().severities.level(&labels.faults)
    }

    /// Points of the sweep: cases without their repeats.
    fn points(&self) -> u64 {
        self.cases() / self.repeats
    }

    fn survey(&self) -> &Survey {
        self.survey.get_or_init(|| Survey::new(self))
    }
}

impl Survey {
    fn new(plan: &Plan) -> Self {
        let points = plan.points();
        let looked_at = points.min(MOST_STRATIFIED);
        let is_whole = plan.is_stratified();
        let nth = |i: u64| (u128::from(points) * u128::from(i) / u128::from(looked_at)) as u64;
        let mut cases: Vec<(u64, String)> = Vec::new();
        let mut unnamed = BTreeMap::new();
        let mut faults = Vec::new();
        for point in (0..looked_at).map(nth) {
            // A case with an invalid machine fails later, and has neither label nor split.
            let Ok(case) = plan.case_before_splits(point * plan.repeats) else {
                continue;
            };
            note_unnamed(plan, point, &case, &mut unnamed);
            cases.push((case.group, case.labels.fault));
            faults.push(case.labels.faults);
        }
        let splits = is_whole.then(|| {
            let mut labels_of: BTreeMap<u64, BTreeSet<&str>> = BTreeMap::new();
            for (group, label) in &cases {
                labels_of.entry(*group).or_default().insert(label);
            }
            let mut strata: BTreeMap<Vec<&str>, Vec<u64>> = BTreeMap::new();
            for (group, labels) in labels_of {
                let labels = labels.into_iter().collect();
                strata.entry(labels).or_default().push(group);
            }
            let strata: Vec<Vec<u64>> = strata.into_values().collect();
            stratify(&strata, plan.shares, plan.seed)
        });
        let repeats = if is_whole { plan.repeats } else { 1 };
        let mut census = Census::new(plan.shares, [repeats * looked_at, plan.cases()]);
        census.unnamed = unnamed;
        for (group, label) in cases {
            let known = splits.as_ref().and_then(|splits| splits.get(&group));
            let split = known.copied();
            let split = split.unwrap_or_else(|| assign(plan.shares, plan.seed, group));
            census.add(split.name(), &label, repeats);
        }
        Self {
            splits,
            census,
            severities: Severities::from_cases(faults),
        }
    }
}

impl Census {
    /// The cases that the finished dataset of `plan` has; failed cases are not counted.
    pub fn from_manifest(plan: &Plan, manifest: &Manifest) -> Self {
        let windows = plan.windows.map_or(1, |windows| windows.count.get());
        let mut census = Self::new(plan.shares, [plan.cases(); 2]);
        for (split, labels) in &manifest.counts.rows {
            for (label, rows) in labels {
                census.add(split, label, rows / u64::from(windows));
            }
        }
        census
    }
}

/// Notes the joints that `case`, point `point` of the sweep, does not name although they are faulty
/// by the clearance that it states.
fn note_unnamed(plan: &Plan, point: u64, case: &Case, unnamed: &mut BTreeMap<String, Unnamed>) {
    let (block, inside) = plan.block_of(point);
    let Some(named) = plan.blocks[block].named(inside) else {
        return;
    };
    // An effect may widen a joint, and is a label itself.
    if plan.effects.iter().any(|effect| effect.is_in(&case.tree)) {
        return;
    }
    let faulty: Vec<&str> = case.labels.fault.split('+').collect();
    let joints = plan.joints.iter().enumerate();
    let joints = joints.filter(|(i, joint)| {
        let is_faulty = faulty.contains(&joint.name.as_str());
        is_faulty && !named.contains(i)
    });
    for (i, joint) in joints {
        let found = unnamed
            .entry(joint.name.clone())
            .or_insert_with(|| Unnamed {
                cases: 0,
                example: case.id.clone(),
                clearance_path: joint.clearance_path.clone(),
                clearance_m: case.labels.clearances_m[i],
            });
        found.cases += plan.repeats;
    }
}
