//! The features that the page shows: how large the acceleration is, how peaked, how violent.

use crate::counts::FaultCount;
use crate::statistics::mean_and_deviation;
use sweep::reader::{ChannelFeatures, Dataset};

/// A feature of the table.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Its name.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
}

/// The features of one fault.
#[derive(Clone, Debug)]
pub struct FeatureRow {
    /// Label of the fault.
    pub fault: String,
    /// The sensor, as features are named after it.
    pub sensor: String,
    /// Windows that were averaged.
    pub windows: usize,
    /// Mean and standard deviation of each feature, in the order of [`DatasetPage::features`].
    pub values: Vec<(f64, f64)>,
}

/// Lower edge of the bands that count as violence: the motion without clearance hardly reaches
/// order 19 at 500 rpm.
pub const HIGH_FROM_HZ: f64 = 160.0;

/// What [`HIGH_FROM_HZ`] leaves of the root mean square.
pub(crate) fn high_name() -> String {
    format!("rms above {HIGH_FROM_HZ} Hz")
}

/// The root mean square above [`HIGH_FROM_HZ`] of each window, m/s².
pub(crate) fn high_rms(measured: &ChannelFeatures) -> Vec<f64> {
    let windows = 0..measured.rms.len();
    windows
        .map(|window| measured.rms_from(HIGH_FROM_HZ, window))
        .collect()
}

/// The features by name and unit, and their values.
fn all(measured: &ChannelFeatures) -> Vec<(Feature, Vec<f64>)> {
    let feature = |name: &str, unit: &str, values: &[f64]| {
        let (name, unit) = (name.to_owned(), unit.to_owned());
        (Feature { name, unit }, values.to_owned())
    };
    vec![
        feature("rms", "m/s²", &measured.rms),
        feature("peak", "m/s²", &measured.peak),
        feature("crest factor", "", &measured.crest_factor),
        feature("kurtosis", "", &measured.kurtosis),
        feature(&high_name(), "m/s²", &high_rms(measured)),
        feature("order 1", "m/s²", &measured.orders[0]),
        feature("order 2", "m/s²", &measured.orders[1]),
    ]
}

/// Mean and standard deviation of the features over the windows of each fault, a row for each
/// sensor that judges it.
pub fn by_fault(dataset: &Dataset, faults: &[FaultCount]) -> (Vec<Feature>, Vec<FeatureRow>) {
    let measured: Vec<_> = dataset.windows.measured.iter().map(all).collect();
    let Some(first) = measured.first() else {
        return (Vec::new(), Vec::new());
    };
    let features = first.iter().map(|(feature, _)| feature.clone());
    let row = |count: &FaultCount, sensor: usize| {
        let of_fault = |(_, values): &(Feature, Vec<f64>)| {
            let own = values.iter().zip(&dataset.windows.fault);
            let own = own.filter(|(_, fault)| **fault == count.fault);
            let finite = own.map(|(value, _)| *value).filter(|v| v.is_finite());
            mean_and_deviation(&finite.collect::<Vec<_>>())
        };
        FeatureRow {
            fault: count.fault.clone(),
            sensor: dataset.sensors.channels()[sensor].clone(),
            windows: count.windows,
            values: measured[sensor].iter().map(of_fault).collect(),
        }
    };
    let rows = faults.iter().flat_map(|count| {
        let judging = dataset.sensors.of_fault(&count.fault).into_iter();
        judging.map(|sensor| row(count, sensor)).collect::<Vec<_>>()
    });
    (features.collect(), rows.collect())
}
