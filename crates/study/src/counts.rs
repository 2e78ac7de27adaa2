//! How many cases and windows there are, what varies over them, and which failed.

use crate::words;
use recordings::FailedCase;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;
use sweep::reader::{Dataset, Meaning};

/// Cases and windows of one fault.
#[derive(Clone, Debug)]
pub struct FaultCount {
    /// Label, for instance `big_end+small_end`.
    pub fault: String,
    /// Cases in each split.
    pub cases: Vec<usize>,
    /// Windows in all splits.
    pub windows: usize,
}

/// A parameter that varies over the cases.
#[derive(Clone, Debug)]
pub struct ParameterRange {
    /// What it is: «speed», «clearance of the big end».
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// How many values differ from one another.
    pub distinct: usize,
}

/// Cases and windows by fault: the healthy first, then by the number of faults.
pub fn faults(dataset: &Dataset) -> Vec<FaultCount> {
    let windows = &dataset.windows;
    let splits = dataset.splits();
    let mut counts: BTreeMap<(usize, String), FaultCount> = BTreeMap::new();
    for case in &dataset.cases {
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
pub fn ranges(dataset: &Dataset) -> Vec<ParameterRange> {
    let ranges = dataset.windows.labels.iter().filter_map(|label| {
        let cases = dataset.cases.iter();
        let mut values: Vec<f64> = cases.map(|case| label.values[case.first]).collect();
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        values.dedup();
        let (&low, &high) = (values.first()?, values.last()?);
        (low < high).then(|| ParameterRange {
            name: words::name(label),
            unit: text::unit(&label.unit),
            low,
            high,
            distinct: values.len(),
        })
    });
    ranges.collect()
}

/// The failed cases, with commands that are made from their names.
pub fn failed(dataset: &Dataset) -> Vec<FailedCase> {
    let failed = dataset.manifest().failed.iter().cloned();
    let with_command = failed.map(|case| FailedCase {
        command: FailedCase::command_of(Path::new("sweep.yaml"), &case.case_id),
        ..case
    });
    with_command.collect()
}

/// Fewest and most samples that the revolutions of a window take, at the highest and the lowest
/// speed.
pub fn samples_per_window(dataset: &Dataset) -> (usize, usize) {
    let labels = dataset.windows.labels.iter();
    let speeds = labels.filter(|label| label.meaning == Meaning::Speed);
    let speeds = speeds.flat_map(|label| &label.values).copied();
    let samples = |rpm: f64| {
        let of_turn = dataset.plan.samples_per_revolution(rpm * TAU / 60.0);
        (f64::from(dataset.revolutions_per_window()) * of_turn).round() as usize
    };
    let turning = speeds.filter(|rpm| *rpm > 0.0);
    let (low, high) = turning.fold((f64::INFINITY, 0.0_f64), |(low, high), rpm| {
        (low.min(rpm), high.max(rpm))
    });
    if high == 0.0 {
        return (0, 0);
    }
    (samples(high), samples(low))
}
