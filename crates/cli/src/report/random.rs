//! Sweeps drawn at random: how parameters lie, and how features go with clearance.

use super::dataset::Dataset;
use super::features::{CREST, KURTOSIS, Measured, RMS, high_name};
use super::windows::{Case, Windows};
use ::report::dataset_page::{FaultCount, Histogram, RandomSweep, Scatter};
use ::report::text;

pub(super) fn sweep(
    dataset: &Dataset,
    windows: &Windows,
    cases: &[Case],
    faults: &[FaultCount],
) -> RandomSweep {
    RandomSweep {
        histograms: histograms(dataset, windows, cases),
        scatters: scatters(dataset, windows, faults),
    }
}

/// Of every label that is not the same for all cases.
fn histograms(dataset: &Dataset, windows: &Windows, cases: &[Case]) -> Vec<Histogram> {
    let all = dataset.labels.iter().zip(&windows.labels);
    let histograms = all.map(|(label, values)| Histogram {
        name: label.name.clone(),
        unit: label.unit.clone(),
        values: cases.iter().map(|case| values[case.first]).collect(),
    });
    histograms
        .filter(|histogram| {
            let finite = histogram.values.iter().filter(|value| value.is_finite());
            let mut values = finite.copied();
            values
                .next()
                .is_some_and(|first| values.any(|value| value != first))
        })
        .collect()
}

/// Features against the largest clearance as each sensor reads them, a point for each window whose
/// fault the sensor judges.
fn scatters(dataset: &Dataset, windows: &Windows, faults: &[FaultCount]) -> Vec<Scatter> {
    let clearances: Vec<f64> = (0..windows.count())
        .map(|window| windows.largest_clearance(dataset, window))
        .collect();
    let several = dataset.sensors.channels().len() > 1;
    let of_sensor = |(sensor, measured): (usize, &Measured)| {
        let judged = |count: &&FaultCount| dataset.sensors.of_fault(&count.fault).contains(&sensor);
        let place = match several {
            true => format!(", {}", text::words(&dataset.sensors.channels()[sensor])),
            false => String::new(),
        };
        let scatter = |name: &str, unit: &str, log_y: bool, values: &[f64]| Scatter {
            x: ("largest clearance".to_owned(), "m".to_owned()),
            y: (format!("{name}{place}"), unit.to_owned()),
            log_y,
            classes: faults
                .iter()
                .filter(judged)
                .map(|count| {
                    let own = (0..windows.count()).filter(|&w| windows.fault[w] == count.fault);
                    let points = own.map(|w| [clearances[w], values[w]]);
                    (count.fault.clone(), points.collect())
                })
                .collect(),
        };
        [
            scatter("rms", "m/s²", false, &measured.shown[RMS]),
            scatter(&high_name(), "m/s²", true, &measured.high_rms),
            scatter("crest factor", "", false, &measured.shown[CREST]),
            scatter("kurtosis", "", true, &measured.shown[KURTOSIS]),
        ]
    };
    let sensors = windows.measured.iter().enumerate();
    sensors.flat_map(of_sensor).collect()
}
