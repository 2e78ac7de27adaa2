//! Sweeps drawn at random: how parameters lie, and how features go with clearance.

use crate::counts::FaultCount;
use crate::features::{high_name, high_rms};
use crate::scatter::Scatter;
use crate::{scatter, words};
use sweep::reader::{ChannelFeatures, Dataset};

/// Parameters and features of cases drawn at random.
#[derive(Clone, Debug)]
pub struct RandomSweep {
    /// How parameters are spread over the cases.
    pub histograms: Vec<Histogram>,
    /// How features go with parameters.
    pub scatters: Vec<Scatter>,
}

/// The values of one parameter over all cases.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// What it is, as [`ParameterRange::name`].
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// One value per case.
    pub values: Vec<f64>,
}

/// How the parameters of a random sweep lie, and how features go with clearance.
pub fn sweep(dataset: &Dataset, faults: &[FaultCount]) -> RandomSweep {
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
        let against = |name: &str, unit: &str, log_y: bool, values: &[f64]| Scatter {
            sensor: words::sensor(dataset, sensor),
            x: ("largest clearance".to_owned(), "m".to_owned()),
            y: (scatter::feature(dataset, sensor, name), unit.to_owned()),
            log_y,
            classes: scatter::by_fault(dataset, faults, sensor, [&clearances, values]),
        };
        [
            against("rms", "m/s²", false, &measured.rms),
            against(&high_name(), "m/s²", true, &high_rms(measured)),
            against("crest factor", "", false, &measured.crest_factor),
            against("kurtosis", "", true, &measured.kurtosis),
        ]
    };
    let sensors = windows.measured.iter().enumerate();
    sensors.flat_map(of_sensor).collect()
}
