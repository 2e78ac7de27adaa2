//! The case that stands for each class of fault.

use crate::Error;
use crate::counts::FaultCount;
use crate::recording::{Recording, Response, Spectrum};
use crate::words;
use sweep::reader::{Dataset, Meaning, Side};

/// At most this many classes have an example.
pub const MOST_EXAMPLES: usize = 16;

/// A case that stands for its class.
#[derive(Clone, Debug)]
pub struct ClassExample {
    /// Label of the class.
    pub fault: String,
    /// The sensor that reads it; empty where the dataset has one.
    pub sensor: String,
    /// What sets the case apart: «clearance 0.2 mm, 500 rpm».
    pub operating_point: String,
    /// Its signal.
    pub response: Response,
    /// Amplitude over frequency in Hz, rms over stretches of two revolutions.
    pub spectrum: Spectrum,
    /// Amplitude over order of the crank's speed, rms over the revolutions.
    pub order_spectrum: Spectrum,
}

/// An example of each fault, for each sensor that judges it: the first window of the case whose
/// largest clearance is nearest to the median of its class. For the healthy machine only the first
/// sensor.
///
/// # Errors
/// A table that cannot be read.
pub fn examples(dataset: &Dataset, faults: &[FaultCount]) -> Result<Vec<ClassExample>, Error> {
    if !dataset.has_signals() {
        return Ok(Vec::new());
    }
    let of_fault = |fault: &str| {
        let own = dataset.cases.iter().map(|case| case.first);
        let own: Vec<usize> = own.filter(|&w| dataset.windows.fault[w] == fault).collect();
        nearest_median(&own, |&w| dataset.windows.largest_clearance(w)).copied()
    };
    let judged = faults.iter().flat_map(|count| {
        let mut judging = dataset.sensors.of_fault(&count.fault);
        if count.fault == "none" {
            judging.truncate(1);
        }
        judging.into_iter().map(move |sensor| (count, sensor))
    });
    judged
        .filter_map(|(count, sensor)| Some((count, sensor, of_fault(&count.fault)?)))
        .take(MOST_EXAMPLES)
        .map(|(count, sensor, window)| {
            let recording = Recording::read(dataset, window, sensor)?;
            Ok(ClassExample {
                fault: count.fault.clone(),
                sensor: words::sensor(dataset, sensor),
                operating_point: described(dataset, window),
                response: recording.response()?,
                spectrum: recording.spectrum()?,
                order_spectrum: recording.order_spectrum()?,
            })
        })
        .collect()
}

/// The first of those whose value is the (upper) median.
pub(crate) fn nearest_median<T>(all: &[T], value: impl Fn(&T) -> f64) -> Option<&T> {
    let mut values: Vec<f64> = all.iter().map(&value).collect();
    values.sort_by(f64::total_cmp);
    let median = *values.get(values.len() / 2)?;
    all.iter().find(|one| value(one).total_cmp(&median).is_eq())
}

/// What sets the window's case apart: «big end 0.2 mm, 500 rpm, discharge pressure 393 kPa».
fn described(dataset: &Dataset, window: usize) -> String {
    let windows = &dataset.windows;
    let clearances = windows.clearances(window);
    let faulty = clearances.filter(|(joint, _)| windows.faults(window).any(|name| name == *joint));
    let mut parts: Vec<String> = faulty
        .map(|(joint, clearance)| format!("{} {}", text::words(joint), text::clearance(clearance)))
        .collect();
    if parts.is_empty() {
        parts.push(match windows.largest_clearance(window) {
            0.0 => "no clearance".to_owned(),
            largest => format!("clearances up to {}", text::clearance(largest)),
        });
    }
    parts.push(operating_point(dataset, window));
    parts.join(", ")
}

/// Speed and discharge pressures of the window's case.
pub(crate) fn operating_point(dataset: &Dataset, window: usize) -> String {
    let parts = dataset.windows.labels.iter().filter_map(|label| {
        let value = || words::value(label, window);
        match label.meaning {
            Meaning::Speed => Some(value()),
            Meaning::Pressure {
                side: Side::Discharge,
                ..
            } => Some(format!("{} {}", words::name(label), value())),
            _ => None,
        }
    });
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use crate::examples::nearest_median;

    #[test]
    fn the_median_is_one_of_the_values() {
        let pick = |values: &[f64]| nearest_median(values, |v| *v).copied();
        assert_eq!(pick(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(pick(&[4.0, 1.0, 2.0, 3.0]), Some(3.0));
        assert_eq!(pick(&[]), None);
    }
}
