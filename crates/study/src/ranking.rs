//! What the features say about the class.

use crate::counts::FaultCount;
use classify::RankedFeature;
use std::collections::BTreeSet;
use sweep::reader::{Dataset, LabelledSample, Subset};

/// The values of a feature by class.
#[derive(Clone, Debug)]
pub struct FeatureByClass {
    /// Its column.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// The label of each class and the finite values of its windows.
    pub classes: Vec<(String, Vec<f64>)>,
}

impl FeatureByClass {
    /// Whether all values are above zero and the greatest is more than a hundred times the least.
    pub fn spans_decades(&self) -> bool {
        let values = || self.classes.iter().flat_map(|(_, values)| values).copied();
        let (low, high) = values().fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        low > 0.0 && high > 100.0 * low
    }
}

/// Features whose values are shown by class.
const MOST_SHOWN: usize = 4;
/// Windows that ranks are computed from: they hardly change with more.
const MOST_WINDOWS: usize = 5_000;

/// The features by what they say about the class.
pub fn ranking(features: &LabelledSample) -> Vec<RankedFeature> {
    let rows = features.labels.len();
    let every = rows.div_ceil(MOST_WINDOWS).max(1);
    let thinned = |values: &Vec<f64>| values.iter().copied().step_by(every).collect();
    let columns: Vec<Vec<f64>> = features
        .sample
        .values
        .columns()
        .iter()
        .map(thinned)
        .collect();
    let labels: Vec<String> = features.labels.iter().step_by(every).cloned().collect();
    classify::ranking(&features.names, &columns, &labels)
}

/// The values by class of the features that say most, one of each kind: of numbered ones (`order_01`, `order_02`, …) and of
/// several channels the best.
///
/// # Errors
/// A table that cannot be read.
pub fn by_class(
    dataset: &Dataset,
    faults: &[FaultCount],
    features: &LabelledSample,
    ranking: &[RankedFeature],
) -> Result<Vec<FeatureByClass>, crate::Error> {
    let columns = dataset.columns(Subset::Features)?;
    let mut kinds = BTreeSet::new();
    let kind = |name: &str| {
        let feature = name.split_once('.').map_or(name, |(_, feature)| feature);
        feature.replace(|c: char| c.is_ascii_digit(), "")
    };
    let best = ranking
        .iter()
        .filter(|ranked| kinds.insert(kind(&ranked.name)));
    let shown = best.take(MOST_SHOWN).filter_map(|ranked| {
        let column = features
            .names
            .iter()
            .position(|name| *name == ranked.name)?;
        let values = &features.sample.values.columns()[column];
        let of_class = |count: &FaultCount| {
            let own = values.iter().zip(&features.labels);
            let own = own.filter(|(value, label)| **label == count.fault && value.is_finite());
            (count.fault.clone(), own.map(|(value, _)| *value).collect())
        };
        let unit = columns.iter().find(|column| column.name == ranked.name);
        let unit = unit
            .and_then(|column| column.unit.as_deref())
            .unwrap_or_default();
        Some(FeatureByClass {
            name: ranked.name.clone(),
            unit: text::unit(unit),
            classes: faults.iter().map(of_class).collect(),
        })
    });
    Ok(shown.collect())
}
