//! How many cases of each label a sweep has in each split.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};

use crate::fault_words::Severities;
use crate::labels::NONE;
use crate::split::Split;

/// Labels that a warning names.
const NAMED: usize = 5;

/// What a survey of the cases of a sweep finds.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// The split of every group; none where the sweep is too large to be stratified.
    pub(super) splits: Option<BTreeMap<u64, Split>>,
    pub(super) census: Census,
    pub(super) severities: Severities,
}

/// How many cases of each label there are in each split, and what is wrong with that.
#[derive(Clone, Debug, PartialEq)]
pub struct Census {
    /// Names of the splits that are to have cases.
    splits: Vec<String>,
    /// Cases by label, in the order of the splits.
    labels: BTreeMap<String, Vec<u64>>,
    /// Joints that are faulty in cases that do not name them.
    pub(super) unnamed: BTreeMap<String, Unnamed>,
    /// Cases that were looked at, and cases of the sweep.
    looked_at: [u64; 2],
}

/// A joint that is faulty in cases that do not name it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unnamed {
    pub(super) cases: u64,
    pub(super) example: String,
    pub(super) clearance_path: String,
    pub(super) clearance_m: f64,
}

impl Census {
    /// No case yet, for splits of these shares; `looked_at` has the cases that are looked at and those
    /// of the sweep.
    pub(super) fn new(shares: [f64; 3], looked_at: [u64; 2]) -> Self {
        let splits = Split::ALL.iter().zip(shares);
        let splits = splits.filter(|(_, share)| *share > 0.0);
        Self {
            splits: splits.map(|(split, _)| split.name().to_owned()).collect(),
            labels: BTreeMap::new(),
            unnamed: BTreeMap::new(),
            looked_at,
        }
    }

    /// Adds `cases` of `label` in `split`.
    pub(super) fn add(&mut self, split: &str, label: &str, cases: u64) {
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
