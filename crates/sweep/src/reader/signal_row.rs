//! The recording of one window, as the table of signals has it.

use super::{Dataset, Error, texts};
use crate::dataset::CRANK_ANGLE;
use recordings::Table;

/// One accelerometer's channel of one window.
pub struct SignalRow {
    /// The file it is in, from the dataset's folder.
    pub file: String,
    /// File and row, for messages.
    pub place: String,
    /// The case.
    pub case_id: String,
    /// Mean speed of the crank.
    pub speed_rpm: f64,
    /// Samples per second; their mean where they stand at equal steps of the crank angle.
    pub sample_rate_hz: f64,
    /// The acceleration, m/s².
    pub acceleration: Vec<f64>,
    /// The crank angle at each sample, rad, where a sensor reads it.
    pub crank_angle: Option<Vec<f64>>,
}

impl Dataset {
    /// Reads what sensor number `sensor` of the dataset's has of a window.
    ///
    /// # Errors
    /// A table that is damaged, lacks the channel, or is of another dataset.
    pub fn signal(&self, window: usize, sensor: usize) -> Result<SignalRow, Error> {
        let windows = &self.windows;
        let (file, row) = windows.place[window];
        let path = windows.files[file].replacen("features/", "signals/", 1);
        let acceleration = format!("{}_m_s2", self.sensors.channels()[sensor]);
        let mut names = vec!["case_id", "speed_rpm", &acceleration];
        let over_angle = self.plan.over_angle;
        if over_angle.is_none() {
            names.push("sample_rate_hz");
        }
        let has_angle = self.has_crank_angle();
        if has_angle {
            names.push(CRANK_ANGLE);
        }
        let files = &self.files;
        let table = files.open(&path)?;
        let shown = format!("{}: row {row}", files.place(&path).display());
        let read = files.read(&path, &table, &names, row..row + 1, |table| {
            let speed_rpm = number(table, "speed_rpm")?;
            Ok(SignalRow {
                file: path.clone(),
                place: shown,
                case_id: texts(table, "case_id")?.next().unwrap_or_default(),
                speed_rpm,
                sample_rate_hz: match over_angle {
                    Some(over_angle) => {
                        f64::from(over_angle.samples_per_revolution) * speed_rpm / 60.0
                    }
                    None => number(table, "sample_rate_hz")?,
                },
                acceleration: samples(table, &acceleration)?,
                crank_angle: has_angle.then(|| samples(table, CRANK_ANGLE)).transpose()?,
            })
        })?;
        if read.case_id != windows.case_id[window] {
            return Err(Error::OtherCase {
                place: read.place,
                of: read.case_id,
                features_of: windows.case_id[window].clone(),
            });
        }
        Ok(read)
    }
}

/// The number in the first row; 0 where it is missing.
fn number(table: &Table, name: &str) -> Result<f64, recordings::Error> {
    Ok(table.values::<f64>(name)?[0].unwrap_or_default())
}

/// The samples in the first row.
fn samples(table: &Table, name: &str) -> Result<Vec<f64>, recordings::Error> {
    let values = table.values::<Vec<f32>>(name)?;
    Ok(values[0].iter().flatten().map(|x| f64::from(*x)).collect())
}
