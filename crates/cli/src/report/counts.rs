//! How many cases and windows there are, what varies over them, and which failed.

use super::dataset::Dataset;
use super::windows::{Case, Windows};
use ::report::dataset_page::{CaseWarning, FailedCase, FaultCount, ParameterRange};
use std::collections::BTreeMap;
use std::path::Path;

/// Cases and windows by fault: the healthy first, then by the number of faults.
pub(super) fn faults(dataset: &Dataset, windows: &Windows, cases: &[Case]) -> Vec<FaultCount> {
    let splits = dataset.splits();
    let mut counts: BTreeMap<(usize, String), FaultCount> = BTreeMap::new();
    for case in cases {
        let fault = &windows.fault[case.first];
        let order = (windows.faults(case.first).count(), fault.clone());
        let count = counts.entry(order).or_insert_with(|| FaultCount {
            fault: fault.clone(),
            cases: vec![0; splits.len()],
            windows: 0,
        });
        count.windows += case.windows.len();
        if let Some(split) = splits.iter().position(|s| *s == windows.split[case.first]) {
            count.cases[split] += 1;
        }
    }
    counts.into_values().collect()
}

/// The labels that are not the same for all cases.
pub(super) fn ranges(dataset: &Dataset, windows: &Windows, cases: &[Case]) -> Vec<ParameterRange> {
    let ranges = dataset.labels.iter().zip(&windows.labels);
    ranges
        .filter_map(|(label, values)| {
            let mut values: Vec<f64> = cases.iter().map(|case| values[case.first]).collect();
            values.retain(|value| value.is_finite());
            values.sort_by(f64::total_cmp);
            values.dedup();
            let (&low, &high) = (values.first()?, values.last()?);
            (low < high).then(|| ParameterRange {
                name: label.name.clone(),
                unit: label.unit.clone(),
                low,
                high,
                distinct: values.len(),
            })
        })
        .collect()
}

pub(super) fn failed(dataset: &Dataset) -> Vec<FailedCase> {
    let failed = dataset.manifest.failed.iter().cloned();
    failed
        .map(|case| FailedCase {
            command: recordings::FailedCase::command_of(Path::new("sweep.yaml"), &case.case_id),
            case_id: case.case_id,
            reason: case.reason,
        })
        .collect()
}

pub(super) fn warnings(dataset: &Dataset) -> Vec<CaseWarning> {
    let warnings = dataset.manifest.warnings.iter().cloned();
    warnings
        .map(|case| CaseWarning {
            case_id: case.case_id,
            warning: case.warning,
        })
        .collect()
}

/// Fewest and most samples that the revolutions of a window take, at the highest and the lowest
/// speed.
pub(super) fn samples_per_window(dataset: &Dataset, windows: &Windows) -> (usize, usize) {
    let speed = dataset.labels.iter().position(|l| l.column == "speed_rpm");
    let speeds = || {
        let all = speed.iter().flat_map(|&at| &windows.labels[at]);
        all.copied().filter(|rpm| *rpm > 0.0)
    };
    let samples = |rpm: f64| {
        let seconds = f64::from(dataset.revolutions_per_window()) * 60.0 / rpm;
        (seconds * dataset.plan.settings.sample_rate).round() as usize
    };
    let (low, high) = speeds().fold((f64::INFINITY, 0.0_f64), |(low, high), rpm| {
        (low.min(rpm), high.max(rpm))
    });
    if high == 0.0 {
        return (0, 0);
    }
    (samples(high), samples(low))
}
