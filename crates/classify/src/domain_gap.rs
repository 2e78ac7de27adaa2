//! How far simulated recordings differ from measured ones, as a classifier sees it.

use crate::folds::{folds, random};
use crate::{Boosting, Matrix, Sample, area_under_curve};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use serde::Serialize;

/// How well a classifier tells simulated windows from measured ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DomainGap {
    /// Area under the curve on held-out windows, the mean of the folds: 0.5 where nothing tells them apart, 1 where
    /// everything does.
    pub auc: f64,
    /// The same of each fold.
    pub folds: Vec<f64>,
    /// Simulated windows.
    pub simulated: usize,
    /// Measured windows.
    pub measured: usize,
    /// The features that give it away, the most telling first.
    pub features: Vec<TellingFeature>,
}

/// A feature that tells simulated windows from measured ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TellingFeature {
    /// Its column.
    pub feature: String,
    /// Area under the curve of this feature alone, whichever way it points: 0.5 tells nothing, 1 everything.
    pub auc: f64,
    /// What the classifier's area loses when this feature is shuffled, the mean of the folds.
    pub loss: f64,
    /// Median of the simulated windows; none where no window has a value.
    pub simulated: Option<f64>,
    /// Median of the measured windows.
    pub measured: Option<f64>,
}

/// Trains a classifier to tell simulated windows from measured ones, and tests it on windows that it has not seen.
///
/// `names` are those of the columns. Rows of one group are never on both sides of a fold. `None` where either side has
/// fewer groups than there are `parts`.
pub fn domain_gap(
    names: &[String],
    simulated: &Sample,
    measured: &Sample,
    parts: usize,
    seed: u64,
) -> Option<DomainGap> {
    if parts < 2 || simulated.distinct().min(measured.distinct()) < parts {
        return None;
    }
    let both = simulated.values.clone().above(&measured.values);
    let is_measured: Vec<bool> = (0..both.rows())
        .map(|row| row >= simulated.values.rows())
        .collect();
    let groups = [simulated.groups.as_slice(), &measured.groups].concat();
    let of_row = folds(&groups, &is_measured, parts, seed);
    let tested: Vec<Fold> = (0..parts)
        .map(|part| Fold::new(part, &both, &is_measured, &of_row, seed))
        .collect::<Option<_>>()?;
    let areas: Vec<f64> = tested.iter().map(|fold| fold.area).collect();
    let features = names.iter().enumerate().map(|(column, name)| {
        let losses = tested.iter().map(|fold| fold.losses[column]);
        let alone = area_under_curve(&both.columns()[column], &is_measured).unwrap_or(0.5);
        TellingFeature {
            feature: name.clone(),
            auc: alone.max(1.0 - alone),
            loss: losses.sum::<f64>() / parts as f64,
            simulated: median(&simulated.values.columns()[column]),
            measured: median(&measured.values.columns()[column]),
        }
    });
    let mut features: Vec<TellingFeature> = features.collect();
    features.sort_by(|a, b| b.loss.total_cmp(&a.loss).then(b.auc.total_cmp(&a.auc)));
    Some(DomainGap {
        auc: areas.iter().sum::<f64>() / parts as f64,
        folds: areas,
        simulated: simulated.values.rows(),
        measured: measured.values.rows(),
        features,
    })
}

/// What one part of the rows says of a classifier that the others trained.
struct Fold {
    area: f64,
    /// What the area loses with each column shuffled.
    losses: Vec<f64>,
}

impl Fold {
    fn new(
        part: usize,
        both: &Matrix,
        is_measured: &[bool],
        of_row: &[usize],
        seed: u64,
    ) -> Option<Self> {
        let (test, train): (Vec<usize>, Vec<usize>) =
            (0..both.rows()).partition(|row| of_row[*row] == part);
        let classes =
            |rows: &[usize]| -> Vec<bool> { rows.iter().map(|row| is_measured[*row]).collect() };
        let model = Boosting::fit(&both.select(&train), &classes(&train));
        let (held_out, truth) = (both.select(&test), classes(&test));
        let area = area_under_curve(&model.scores(&held_out), &truth)?;
        let used = model.columns();
        let losses = (0..both.columns().len()).into_par_iter().map(|column| {
            if !used.contains(&column) {
                return 0.0;
            }
            let number = 2 + (part * both.columns().len() + column) as u64;
            let mut order: Vec<usize> = (0..test.len()).collect();
            order.shuffle(&mut random(seed, number));
            let scores = model.scores_with_shuffled(&held_out, column, &order);
            area - area_under_curve(&scores, &truth).unwrap_or(area)
        });
        let losses = losses.collect();
        Some(Self { area, losses })
    }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut values: Vec<f64> = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    Some(match values.len() % 2 {
        0 => (values[values.len() / 2 - 1] + upper) / 2.0,
        _ => upper,
    })
}
