//! Sweeps that compare joints and clearances, all else equal.

use super::dataset::Dataset;
use super::examples::operating_point;
use super::features::{HIGH_FROM_HZ, PEAK, RMS};
use super::recording::Recording;
use super::windows::{Case, Windows};
use crate::Failure;
use ::report::dataset_page::{CaseLevel, ClearanceGrid, JointSet, Response};
use std::collections::{BTreeMap, BTreeSet};

/// A case of a grid: clearance of one size in every faulty joint.
struct Point<'a> {
    fault: &'a str,
    clearance_m: f64,
    case: &'a Case,
}

/// The grid of the first operating point at which several sets of joints have the same several
/// clearances; none where there is no such point.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn grid(
    dataset: &Dataset,
    windows: &Windows,
    cases: &[Case],
) -> Result<Option<ClearanceGrid>, Failure> {
    let Some(points) = points(dataset, windows, cases) else {
        return Ok(None);
    };
    let response = |point: &Point| -> Result<Response, Failure> {
        Recording::read(dataset, windows, point.case.first)?.response()
    };
    let ideal = points.iter().find(|point| point.clearance_m == 0.0);
    let clear = || points.iter().filter(|point| point.clearance_m > 0.0);
    let mut joint_sets: Vec<JointSet> = Vec::new();
    if dataset.has_signals() {
        for point in clear() {
            let response = (point.clearance_m, response(point)?);
            match joint_sets.iter_mut().find(|set| set.joints == point.fault) {
                Some(set) => set.responses.push(response),
                None => joint_sets.push(JointSet {
                    joints: point.fault.to_owned(),
                    responses: vec![response],
                }),
            }
        }
    }
    let with_signals = ideal.filter(|_| dataset.has_signals());
    Ok(Some(ClearanceGrid {
        operating_point: operating_point(dataset, windows, points[0].case.first),
        ideal: with_signals.map(response).transpose()?,
        joint_sets,
        high_from_hz: HIGH_FROM_HZ,
        levels: if windows.measured.is_there() {
            let ordered = ideal.into_iter().chain(clear());
            ordered.map(|point| level(windows, point)).collect()
        } else {
            Vec::new()
        },
    }))
}

/// The cases of the grid in the order of the sweep, each joint set and clearance once.
fn points<'a>(
    dataset: &Dataset,
    windows: &'a Windows,
    cases: &'a [Case],
) -> Option<Vec<Point<'a>>> {
    let mut by_operating_point: Vec<(Vec<String>, Vec<Point>)> = Vec::new();
    let mut index: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for case in cases {
        let Some(clearance_m) = common_clearance(dataset, windows, case.first) else {
            continue;
        };
        let key = all_else(dataset, windows, case.first);
        let at = *index.entry(key.clone()).or_insert_with(|| {
            by_operating_point.push((key, Vec::new()));
            by_operating_point.len() - 1
        });
        let points = &mut by_operating_point[at].1;
        let fault = windows.fault[case.first].as_str();
        let repeated = |p: &Point| p.fault == fault && p.clearance_m == clearance_m;
        if !points.iter().any(repeated) {
            points.push(Point {
                fault,
                clearance_m,
                case,
            });
        }
    }
    let mut all = by_operating_point.into_iter().map(|(_, points)| points);
    all.find(|points| is_grid(points))
}

/// Whether two sets of joints have two clearances in common.
fn is_grid(points: &[Point]) -> bool {
    let mut sets: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
    for point in points.iter().filter(|point| point.clearance_m > 0.0) {
        let clearances = sets.entry(point.fault).or_default();
        clearances.insert(point.clearance_m.to_bits());
    }
    let sets: Vec<_> = sets.into_values().collect();
    sets.iter().enumerate().any(|(i, a)| {
        let common = |b: &BTreeSet<u64>| a.intersection(b).count();
        sets[i + 1..].iter().any(|b| common(b) >= 2)
    })
}

/// The clearance that all faulty joints of the window's case have; 0 for a machine without any.
/// None where they differ, where a machine without fault has clearance, and where the case has an
/// effect as a fault.
fn common_clearance(dataset: &Dataset, windows: &Windows, window: usize) -> Option<f64> {
    let largest = windows.largest_clearance(dataset, window);
    let mut faulty = windows.faults(window).peekable();
    if faulty.peek().is_none() {
        return (largest == 0.0).then_some(0.0);
    }
    let clearance = |joint: &str| {
        let of = dataset
            .labels
            .iter()
            .position(|l| l.joint.as_deref() == Some(joint));
        of.map(|at| windows.labels[at][window])
    };
    let alike = faulty.all(|joint| clearance(joint) == Some(largest));
    alike.then_some(largest)
}

/// Everything that is said about the case but its clearances.
pub(super) fn all_else(dataset: &Dataset, windows: &Windows, window: usize) -> Vec<String> {
    let labels = dataset.labels.iter().zip(&windows.labels);
    let numbers = labels.filter(|(label, _)| label.joint.is_none());
    let numbers = numbers.map(|(_, values)| format!("{:e}", values[window]));
    let texts = windows.texts.iter().map(|values| values[window].clone());
    numbers.chain(texts).collect()
}

/// The levels of a case over all its windows.
fn level(windows: &Windows, point: &Point) -> CaseLevel {
    let measured = &windows.measured;
    let own = || point.case.windows.iter();
    let count = own().count() as f64;
    let mean = |value: &dyn Fn(usize) -> f64| own().map(|&w| value(w)).sum::<f64>() / count;
    let high = mean(&|w| measured.high_rms[w].powi(2));
    CaseLevel {
        joints: point.fault.to_owned(),
        clearance_m: point.clearance_m,
        rms_m_s2: mean(&|w| measured.shown[RMS][w].powi(2)).sqrt(),
        peak_m_s2: own().map(|&w| measured.shown[PEAK][w]).fold(0.0, f64::max),
        high_rms_m_s2: high.sqrt(),
        high_share: high / mean(&|w| measured.variance[w]),
    }
}
