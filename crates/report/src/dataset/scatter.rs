//! Values of a sensor's windows against each other, by fault.

use super::words;
use crate::dataset_page::FaultCount;
use sweep::reader::Dataset;

/// The label of each fault that the sensor judges, and a point (x, y) for each window with it; `x` and `y` have a value for
/// each window of the dataset.
pub(super) fn by_fault(
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
pub(super) fn feature(dataset: &Dataset, sensor: usize, name: &str) -> String {
    match words::sensor(dataset, sensor).as_str() {
        "" => name.to_owned(),
        sensor => format!("{name}, {sensor}"),
    }
}
