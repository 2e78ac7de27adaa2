//! What a plan says of its cases before any is run: their labels, and with them their splits.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};

use recordings::Manifest;

use super::{Case, Plan};
use crate::labels::NONE;
use crate::split::{Split, assign, stratify};

/// Points of a sweep up to which its splits are stratified by label.
///
/// Each process that makes a shard looks at all of them first, in 0.1 ms each: 2 s. In a larger sweep
/// a label of 0.5 % of the cases still has 100, of which a split of 15 % gets none with a probability
/// of 1e-7 where the draws are independent.
const MOST_STRATIFIED: u64 = 20_000;

/// Labels that a warning names.
const NAMED: usize = 5;

/// What was found.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// The split of every group; none where the sweep is too large to be stratified.
    splits: Option<BTreeMap<u64, Split>>,
    census: Census,
}

/// How many cases of each label there are in each split, and what is wrong with that.
#[derive(Clone, Debug, PartialEq)]
pub struct Census {
    /// Names of the splits that are to have cases.
    splits: Vec<String>,
    /// Cases by label, in the order of the splits.
    labels: BTreeMap<String, Vec<u64>>,
    /// Joints that are faulty in cases that do not name them.
    unnamed: BTreeMap<String, Unnamed>,
    /// Cases that were looked at, and cases of the sweep.
    looked_at: [u64; 2],
}

/// A joint that is faulty in cases that do not name it.
#[derive(Clone, Debug, PartialEq)]
struct Unnamed {
    cases: u64,
    example: String,
    clearance_path: String,
    clearance_m: f64,
}

impl Plan {
    /// Cases by label and split, told by the plan; of a large sweep, of a sample of its cases.
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

    /// Whether the splits are stratified by label, and not drawn for each group by itself.
    pub fn is_stratified(&self) -> bool {
        self.points() <= MOST_STRATIFIED
    }

    /// Points of the sweep: cases without their repeats.
    fn points(&self) -> u64 {
        self.cases() / self.repeats
    }

    fn survey(&self) -> &Survey {
        self.survey.get_or_init(|| Survey::of(self))
    }
}

impl Survey {
    fn of(plan: &Plan) -> Self {
        let points = plan.points();
        let looked_at = points.min(MOST_STRATIFIED);
        let is_whole = plan.is_stratified();
        let nth = |i: u64| (u128::from(points) * u128::from(i) / u128::from(looked_at)) as u64;
        let mut cases: Vec<(u64, String)> = Vec::new();
        let mut unnamed = BTreeMap::new();
        for point in (0..looked_at).map(nth) {
            // A case that is no machine fails later, and has neither label nor split.
            let Ok(case) = plan.case_before_splits(point * plan.repeats) else {
                continue;
            };
            note_unnamed(plan, point, &case, &mut unnamed);
            cases.push((case.group, case.labels.fault));
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
        let mut census = Census::new(plan, [repeats * looked_at, plan.cases()]);
        census.unnamed = unnamed;
        for (group, label) in cases {
            let known = splits.as_ref().and_then(|splits| splits.get(&group));
            let split = known.copied();
            let split = split.unwrap_or_else(|| assign(plan.shares, plan.seed, group));
            census.add(split.name(), &label, repeats);
        }
        Self { splits, census }
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

impl Census {
    fn new(plan: &Plan, looked_at: [u64; 2]) -> Self {
        let splits = Split::ALL.iter().zip(plan.shares);
        let splits = splits.filter(|(_, share)| *share > 0.0);
        Self {
            splits: splits.map(|(split, _)| split.name().to_owned()).collect(),
            labels: BTreeMap::new(),
            unnamed: BTreeMap::new(),
            looked_at,
        }
    }

    /// The cases that the finished dataset of `plan` has; those that failed are none of them.
    pub fn of(plan: &Plan, manifest: &Manifest) -> Self {
        let windows = plan.windows.map_or(1, |windows| windows.count.get());
        let mut census = Self::new(plan, [plan.cases(); 2]);
        for (split, labels) in &manifest.counts.rows {
            for (label, rows) in labels {
                census.add(split, label, rows / u64::from(windows));
            }
        }
        census
    }

    fn add(&mut self, split: &str, label: &str, cases: u64) {
        let Some(split) = self.splits.iter().position(|s| s == split) else {
            return;
        };
        let counts = self.labels.entry(label.to_owned());
        counts.or_insert_with(|| vec![0; self.splits.len()])[split] += cases;
    }

    /// Cases of `label` in each split that is to have some, by the split's name.
    pub fn cases(&self, label: &str) -> BTreeMap<&str, u64> {
        let counts = self.labels.get(label).into_iter().flatten();
        let splits = self.splits.iter().map(String::as_str);
        splits.zip(counts.copied()).collect()
    }

    /// What makes the labels of little use: mistakes, and splits that lack a label.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.mistakes();
        warnings.extend(self.missing());
        warnings
    }

    /// What is wrong with the labels themselves: one for all cases, or joints that are faulty in cases
    /// that do not name them.
    pub fn mistakes(&self) -> Vec<String> {
        let mut warnings: Vec<String> = self.one_label().into_iter().collect();
        warnings.extend(
            self.unnamed
                .iter()
                .map(|(joint, found)| found.warning(joint)),
        );
        warnings
    }

    fn one_label(&self) -> Option<String> {
        let [cases, _] = self.looked_at;
        let label = self.labels.keys().next()?;
        let is_one = self.labels.len() == 1 && cases > 1;
        is_one.then(|| {
            format!(
                "all {cases} cases have the label {label}: a joint is faulty above its \
                 `normal_clearance` (where that is left out, above the machine file's own \
                 clearance), and an effect where its amplitude varies"
            )
        })
    }

    /// Which splits lack which labels.
    fn missing(&self) -> Vec<String> {
        let all = self.labels.len();
        let splits = self.splits.iter().enumerate();
        let missing = splits.filter_map(|(i, split)| {
            let lacking = self.in_order().filter(|(_, counts)| counts[i] == 0);
            let lacking: Vec<&str> = lacking.map(|(label, _)| label).collect();
            let more = match lacking.len() {
                0 => return None,
                n if n > NAMED => format!(" and {} more", n - NAMED),
                _ => String::new(),
            };
            let named = lacking[..lacking.len().min(NAMED)].join(", ");
            let count = lacking.len();
            Some(format!(
                "the split {split} has no case of {count} of {all} labels ({named}{more}): more \
                 cases of a label, or a larger share of the split, give it some"
            ))
        });
        missing.collect()
    }

    /// Healthy first, then by label.
    fn in_order(&self) -> impl Iterator<Item = (&str, &Vec<u64>)> {
        let labels = self
            .labels
            .iter()
            .map(|(label, counts)| (label.as_str(), counts));
        let is_none = |(label, _): &(&str, _)| *label == NONE;
        let (healthy, others): (Vec<_>, Vec<_>) = labels.partition(is_none);
        healthy.into_iter().chain(others)
    }
}

impl Unnamed {
    fn warning(&self, joint: &str) -> String {
        let Self {
            cases,
            example,
            clearance_path: path,
            clearance_m,
        } = self;
        let normal = path.replace(".clearance", ".normal_clearance");
        format!(
            "{joint} is faulty in {cases} cases whose `joints` do not name it ({example}: a \
             clearance of {:.4} mm): {normal} in the machine file must be at least {path} where \
             the joint is healthy",
            clearance_m * 1e3
        )
    }
}

impl Display for Census {
    /// The table, with a head and a line of sums.
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let total = |i: usize| self.labels.values().map(|counts| counts[i]).sum();
        let totals: Vec<u64> = (0..self.splits.len()).map(total).collect();
        let lines = self.in_order().chain([("all", &totals)]);
        let lines: Vec<(&str, &Vec<u64>)> = lines.collect();
        let width = lines.iter().map(|(label, _)| label.len()).max();
        let width = width.unwrap_or(0).max("label".len());
        match self.looked_at {
            [some, all] if some < all => {
                writeln!(f, "cases by label and split, of {some} of {all} cases:")?;
            }
            _ => writeln!(f, "cases by label and split:")?,
        }
        write!(f, "  {:width$}", "label")?;
        for split in &self.splits {
            write!(f, "  {split:>10}")?;
        }
        write!(f, "  {:>10}", "all")?;
        for (label, counts) in lines {
            write!(f, "\n  {label:width$}")?;
            for count in counts {
                write!(f, "  {count:>10}")?;
            }
            write!(f, "  {:>10}", counts.iter().sum::<u64>())?;
        }
        Ok(())
    }
}
