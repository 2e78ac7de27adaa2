//! The case that stands for each class of fault.

use super::dataset::Dataset;
use super::recording::Recording;
use super::windows::{Case, Windows};
use crate::Failure;
use ::report::dataset_page::{ClassExample, FaultCount};
use ::report::text;

/// At most this many classes have an example: as many as the page shows.
const MOST: usize = 16;

/// The first window of the case of each fault whose largest clearance is nearest to the median of
/// its class, once for each sensor that judges the fault; of the healthy as the first sensor reads it.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn examples(
    dataset: &Dataset,
    windows: &Windows,
    cases: &[Case],
    faults: &[FaultCount],
) -> Result<Vec<ClassExample>, Failure> {
    if !dataset.has_signals() {
        return Ok(Vec::new());
    }
    let of_fault = |fault: &str| {
        let own = cases.iter().map(|case| case.first);
        let own: Vec<usize> = own.filter(|&w| windows.fault[w] == fault).collect();
        nearest_median(&own, |&w| windows.largest_clearance(dataset, w)).copied()
    };
    let several = dataset.sensors.channels().len() > 1;
    let judged = faults.iter().flat_map(|count| {
        let mut judging = dataset.sensors.of_fault(&count.fault);
        if count.fault == "none" {
            judging.truncate(1);
        }
        judging.into_iter().map(move |sensor| (count, sensor))
    });
    judged
        .filter_map(|(count, sensor)| Some((count, sensor, of_fault(&count.fault)?)))
        .take(MOST)
        .map(|(count, sensor, window)| {
            let recording = Recording::read(dataset, windows, window, sensor)?;
            Ok(ClassExample {
                fault: count.fault.clone(),
                sensor: match several {
                    true => text::words(&dataset.sensors.channels()[sensor]),
                    false => String::new(),
                },
                operating_point: described(dataset, windows, window),
                response: recording.response()?,
                spectrum: recording.spectrum()?,
                order_spectrum: recording.order_spectrum()?,
            })
        })
        .collect()
}

/// The first of those whose value is the (upper) median.
pub(super) fn nearest_median<T>(all: &[T], value: impl Fn(&T) -> f64) -> Option<&T> {
    let mut values: Vec<f64> = all.iter().map(&value).collect();
    values.sort_by(f64::total_cmp);
    let median = *values.get(values.len() / 2)?;
    all.iter().find(|one| value(one).total_cmp(&median).is_eq())
}

/// What sets the window's case apart: «big end 0.2 mm, 500 rpm, discharge pressure 393 kPa».
fn described(dataset: &Dataset, windows: &Windows, window: usize) -> String {
    let clearances = dataset.labels.iter().zip(&windows.labels);
    let clearances = clearances.filter_map(|(label, values)| {
        let joint = label.joint.as_deref()?;
        let faulty = windows.faults(window).any(|faulty| faulty == joint);
        faulty.then(|| format!("{} {}", text::words(joint), text::clearance(values[window])))
    });
    let mut parts: Vec<String> = clearances.collect();
    if parts.is_empty() {
        parts.push(match windows.largest_clearance(dataset, window) {
            0.0 => "no clearance".to_owned(),
            largest => format!("clearances up to {}", text::clearance(largest)),
        });
    }
    parts.push(operating_point(dataset, windows, window));
    parts.join(", ")
}

/// Speed and discharge pressures of the window's case.
pub(super) fn operating_point(dataset: &Dataset, windows: &Windows, window: usize) -> String {
    let labels = dataset.labels.iter().zip(&windows.labels);
    let parts = labels.filter_map(|(label, values)| {
        let (factor, unit) = text::readable_unit(values[window], &label.unit);
        let value = text::quantity(values[window] * factor, unit);
        if label.column == "speed_rpm" {
            Some(value)
        } else if label.column.ends_with("discharge_pressure_pa") {
            Some(format!("{} {value}", label.name))
        } else {
            None
        }
    });
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::nearest_median;

    #[test]
    fn the_median_is_one_of_the_values() {
        let pick = |values: &[f64]| nearest_median(values, |v| *v).copied();
        assert_eq!(pick(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(pick(&[4.0, 1.0, 2.0, 3.0]), Some(3.0));
        assert_eq!(pick(&[]), None);
    }
}
