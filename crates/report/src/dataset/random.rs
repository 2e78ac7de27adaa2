//! Sweeps drawn at random: how parameters lie, and how features go with clearance.

use super::features::{high_name, high_rms};
use super::words;
use crate::dataset_page::{FaultCount, Histogram, RandomSweep, Scatter};
use crate::text;
use sweep::reader::{ChannelFeatures, Dataset};

pub(super) fn sweep(dataset: &Dataset, faults: &[FaultCount]) -> RandomSweep {
    RandomSweep {
        histograms: histograms(dataset),
        scatters: scatters(dataset, faults),
    }
}

/// Of every label that is not the same for all cases.
fn histograms(dataset: &Dataset) -> Vec<Histogram> {
    let histograms = dataset.windows.labels.iter().map(|label| {
        let cases = dataset.cases.iter();
        Histogram {
            name: words::name(label),
            unit: text::unit(&label.unit),
            values: cases.map(|case| label.values[case.first]).collect(),
        }
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
fn scatters(dataset: &Dataset, faults: &[FaultCount]) -> Vec<Scatter> {
    let windows = &dataset.windows;
    let clearances: Vec<f64> = (0..windows.count())
        .map(|window| windows.largest_clearance(window))
        .collect();
    let of_sensor = |(sensor, measured): (usize, &ChannelFeatures)| {
        let judged = |count: &&FaultCount| dataset.sensors.of_fault(&count.fault).contains(&sensor);
        let place = match words::sensor(dataset, sensor).as_str() {
            "" => String::new(),
            sensor => format!(", {sensor}"),
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
            scatter("rms", "m/s²", false, &measured.rms),
            scatter(&high_name(), "m/s²", true, &high_rms(measured)),
            scatter("crest factor", "", false, &measured.crest_factor),
            scatter("kurtosis", "", true, &measured.kurtosis),
        ]
    };
    let sensors = windows.measured.iter().enumerate();
    sensors.flat_map(of_sensor).collect()
}
