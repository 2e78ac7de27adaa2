//! The recordings of windows, as the table of signals has them.

use super::{Dataset, Error, numbers, texts};
use crate::dataset::CRANK_ANGLE;
use recordings::Table;
use std::ops::Range;

/// Rows that are read at once: some megabytes of usual recordings.
const ROWS_AT_ONCE: usize = 32;

/// Some channels of one window.
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
    /// The samples of each channel that was asked for, SI.
    pub channels: Vec<Vec<f64>>,
    /// The crank angle at each sample, rad, where a sensor reads it.
    pub crank_angle: Option<Vec<f64>>,
}

impl SignalRow {
    /// The row with the channel at this place of [`Self::channels`] alone.
    pub fn with_channel(&self, place: usize) -> Self {
        Self {
            file: self.file.clone(),
            place: self.place.clone(),
            case_id: self.case_id.clone(),
            channels: vec![self.channels[place].clone()],
            crank_angle: self.crank_angle.clone(),
            ..*self
        }
    }
}

impl Dataset {
    /// Reads what sensor number `sensor` of the dataset's has of a window, m/s².
    ///
    /// # Errors
    /// A table that is damaged, lacks the channel, or is of another dataset.
    pub fn signal(&self, window: usize, sensor: usize) -> Result<SignalRow, Error> {
        let channel = format!("{}_m_s2", self.sensors.channels()[sensor]);
        let (file, row) = self.windows.place[window];
        let mut rows = self.signal_rows(file, row..row + 1, &[channel])?;
        self.checked(window, rows.remove(0))
    }

    /// Reads these channels of these windows, and gives each with its place among `windows` to `take`, in the order of
    /// the files.
    ///
    /// # Errors
    /// Those of [`Self::signal`], and those of `take`.
    pub fn each_signal<E: From<Error>>(
        &self,
        windows: &[usize],
        channels: &[String],
        mut take: impl FnMut(usize, SignalRow) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut wanted: Vec<usize> = (0..windows.len()).collect();
        let place = |at: usize| self.windows.place[windows[at]];
        wanted.sort_by_key(|&at| place(at));
        let near = |a: &usize, b: &usize| {
            let [(file_a, row_a), (file_b, row_b)] = [place(*a), place(*b)];
            file_a == file_b && row_a / ROWS_AT_ONCE == row_b / ROWS_AT_ONCE
        };
        for together in wanted.chunk_by(near) {
            let (file, first) = place(together[0]);
            let (_, last) = place(together[together.len() - 1]);
            let rows = self.signal_rows(file, first..last + 1, channels)?;
            let mut rows: Vec<Option<SignalRow>> = rows.into_iter().map(Some).collect();
            for &at in together {
                if let Some(row) = rows[place(at).1 - first].take() {
                    take(at, self.checked(windows[at], row)?)?;
                }
            }
        }
        Ok(())
    }

    fn checked(&self, window: usize, row: SignalRow) -> Result<SignalRow, Error> {
        if row.case_id == self.windows.case_id[window] {
            return Ok(row);
        }
        Err(Error::OtherCase {
            place: row.place,
            of: row.case_id,
            features_of: self.windows.case_id[window].clone(),
        })
    }

    fn signal_rows(
        &self,
        file: usize,
        rows: Range<usize>,
        channels: &[String],
    ) -> Result<Vec<SignalRow>, Error> {
        let path = self.windows.files[file].replacen("features/", "signals/", 1);
        let mut names = vec!["case_id", "speed_rpm"];
        names.extend(channels.iter().map(String::as_str));
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
        let first = rows.start;
        files.read(&path, &table, &names, rows, |table| {
            let cases = texts(table, "case_id")?;
            let speeds: Vec<f64> = numbers(table, "speed_rpm")?.collect();
            let rates: Vec<f64> = match over_angle {
                Some(over_angle) => {
                    let samples = f64::from(over_angle.samples_per_revolution);
                    speeds.iter().map(|speed| samples * speed / 60.0).collect()
                }
                None => numbers(table, "sample_rate_hz")?.collect(),
            };
            let rows = cases.enumerate().map(|(i, case_id)| {
                let channels = channels.iter().map(|channel| samples(table, channel, i));
                Ok(SignalRow {
                    file: path.clone(),
                    place: format!("{}: row {}", files.place(&path).display(), first + i),
                    case_id,
                    speed_rpm: speeds[i],
                    sample_rate_hz: rates[i],
                    channels: channels.collect::<Result<_, recordings::Error>>()?,
                    crank_angle: has_angle
                        .then(|| samples(table, CRANK_ANGLE, i))
                        .transpose()?,
                })
            });
            rows.collect()
        })
    }
}

/// The samples in a row.
fn samples(table: &Table, name: &str, row: usize) -> Result<Vec<f64>, recordings::Error> {
    let values = table.values::<Vec<f32>>(name)?;
    Ok(values[row]
        .iter()
        .flatten()
        .map(|x| f64::from(*x))
        .collect())
}
