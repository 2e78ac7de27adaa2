//! Values of a sensor's windows against each other, by fault.

use crate::counts::FaultCount;
use crate::words;
use sweep::reader::Dataset;

/// A feature against a parameter, by fault.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// Name and unit of the parameter.
    pub x: (String, String),
    /// Name and unit of the feature.
    pub y: (String, String),
    /// True for a logarithmic axis of the feature.
    pub log_y: bool,
    /// Label of a fault, and the points (parameter, feature) with it.
    pub classes: Vec<(String, Vec<[f64; 2]>)>,
}

/// The label of each fault that the sensor judges, and a point (x, y) for each window with it; `x` and `y` have a value for
/// each window of the dataset.
pub(crate) fn by_fault(
    dataset: &Dataset,
    faults: &[FaultCount],
    sensor: usize,
    [x, y]: [&[f64]; 2],
) -> Vec<(String, Vec<[f64; 2]>)> {
    let windows = &dataset.windows;
    let judged = |count: &&FaultCount| dataset.sensors.of_fault(&count.fault).contains(&sensor);
    let points = |count: &FaultCount| {
        let own = (0..windows.count()).filter(|&w| windows.fault[w] == count.fault);
        (count.fault.clone(), own.map(|w| [x[w], y[w]]).collect())
    };
    faults.iter().filter(judged).map(points).collect()
}

/// The name of a feature of a sensor, which is said where the dataset has several.
pub fn feature(dataset: &Dataset, sensor: usize, name: &str) -> String {
    match words::sensor(dataset, sensor).as_str() {
        "" => name.to_owned(),
        sensor => format!("{name}, {sensor}"),
    }
}
