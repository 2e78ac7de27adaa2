//! How levels and spectra go with speed and load.

use crate::Error;
use crate::counts::FaultCount;
use crate::examples::nearest_median;
use crate::recording::{Recording, Spectrum};
use crate::scatter::Scatter;
use crate::{scatter, words};
use std::f64::consts::TAU;
use sweep::reader::{Dataset, Label, Meaning, Side};

/// What goes with speed and load, as far as they vary.
#[derive(Clone, Debug, Default)]
pub struct Operation {
    /// The rms over the speed and over discharge pressures, of each sensor.
    pub trends: Vec<Scatter>,
    /// Spectra over the speed, of each sensor.
    pub waterfalls: Vec<Waterfall>,
}

/// Spectra of one class over the speed, as one sensor reads them.
#[derive(Clone, Debug)]
pub struct Waterfall {
    /// Label of the class.
    pub fault: String,
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// Speed in rad/s, the lowest first, and the order spectrum there.
    pub spectra: Vec<(f64, Spectrum)>,
}

/// Most spectra of a waterfall.
const MOST_SPECTRA: usize = 16;

/// How the levels of each sensor go with speed and load, and its spectra with the speed; as far as these vary.
///
/// # Errors
/// A table that cannot be read.
pub fn operation(dataset: &Dataset, faults: &[FaultCount]) -> Result<Operation, Error> {
    let sensors = 0..dataset.windows.measured.len();
    let waterfalls = sensors
        .clone()
        .map(|sensor| waterfall(dataset, faults, sensor));
    let waterfalls = waterfalls.collect::<Result<Vec<_>, _>>()?;
    Ok(Operation {
        trends: sensors
            .flat_map(|sensor| trends(dataset, faults, sensor))
            .collect(),
        waterfalls: waterfalls.into_iter().flatten().collect(),
    })
}

/// The rms over the speed and over each discharge pressure that varies, a point for each window whose fault the sensor
/// judges.
fn trends(dataset: &Dataset, faults: &[FaultCount], sensor: usize) -> Vec<Scatter> {
    let windows = &dataset.windows;
    let condition = |label: &&Label| {
        let is_condition = matches!(
            label.meaning,
            Meaning::Speed
                | Meaning::Pressure {
                    side: Side::Discharge,
                    ..
                }
        );
        is_condition && distinct(label.values.iter().copied()).len() > 1
    };
    let rms = &windows.measured[sensor].rms;
    let trend = |label: &Label| Scatter {
        sensor: words::sensor(dataset, sensor),
        x: (words::name(label), text::unit(&label.unit)),
        y: (scatter::feature(dataset, sensor, "rms"), "m/s²".to_owned()),
        log_y: true,
        classes: scatter::by_fault(dataset, faults, sensor, [&label.values, rms]),
    };
    windows.labels.iter().filter(condition).map(trend).collect()
}

/// The order spectra of one class over the speed, of the healthy machine where there are such windows; none where the speed is
/// the same everywhere, or the recordings are not at hand.
fn waterfall(
    dataset: &Dataset,
    faults: &[FaultCount],
    sensor: usize,
) -> Result<Option<Waterfall>, Error> {
    let windows = &dataset.windows;
    let speed = windows
        .labels
        .iter()
        .find(|label| label.meaning == Meaning::Speed);
    let judged = |count: &&FaultCount| dataset.sensors.of_fault(&count.fault).contains(&sensor);
    let class = faults
        .iter()
        .filter(judged)
        .max_by_key(|count| count.fault == "none");
    let (Some(speed), Some(class), true) = (speed, class, dataset.has_signals()) else {
        return Ok(None);
    };
    let own: Vec<usize> = (0..windows.count())
        .filter(|&w| windows.fault[w] == class.fault)
        .collect();
    let speeds = distinct(own.iter().map(|&w| speed.values[w]));
    if speeds.len() < 2 {
        return Ok(None);
    }
    let last = speeds.len() - 1;
    let shown = MOST_SPECTRA.min(speeds.len());
    let mut spectra = Vec::new();
    for i in 0..shown {
        let wanted = speeds[i * last / (shown - 1)];
        let at_speed: Vec<usize> = own
            .iter()
            .copied()
            .filter(|&w| speed.values[w] == wanted)
            .collect();
        let typical = nearest_median(&at_speed, |&w| windows.measured[sensor].rms[w]);
        if let Some(&window) = typical {
            let orders = Recording::read(dataset, window, sensor)?.order_spectrum()?;
            spectra.push((wanted * TAU / 60.0, orders));
        }
    }
    Ok(Some(Waterfall {
        fault: class.fault.clone(),
        sensor: words::sensor(dataset, sensor),
        spectra,
    }))
}

/// The finite values, each once, the lowest first.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
