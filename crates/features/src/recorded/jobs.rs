//! The windows of all files, one after the other.

use super::inputs::Input;
use super::table::{Job, Layout};
use super::{Error, WindowLength, shaft};
use crate::FEWEST_SAMPLES;
use recordings::Value;
use recordings::measured::{MeasuredFile, Recording, Windows};
use std::path::Path;
use std::sync::Arc;

/// The windows of all files, in order; the first error ends them.
pub struct Jobs<'a> {
    inputs: std::iter::Zip<std::slice::Iter<'a, Input>, std::vec::IntoIter<Arc<Layout>>>,
    length: WindowLength,
    columns: usize,
    file: Option<(Arc<Layout>, MeasuredFile)>,
    recording: Option<(Windows, Current)>,
    left_out_s: f64,
    failed: bool,
}

/// What holds for the windows of a recording.
struct Current {
    labels: Arc<Vec<Value>>,
    sample_rate_hz: f64,
    speed_rpm: Option<f64>,
    next: u64,
}

impl<'a> Jobs<'a> {
    pub(super) fn new(
        inputs: &'a [Input],
        layouts: Vec<Layout>,
        columns: usize,
        length: WindowLength,
    ) -> Self {
        let layouts: Vec<_> = layouts.into_iter().map(Arc::new).collect();
        Self {
            inputs: inputs.iter().zip(layouts),
            length,
            columns,
            file: None,
            recording: None,
            left_out_s: 0.0,
            failed: false,
        }
    }

    /// What was too short for a window so far, s.
    pub fn left_out_s(&self) -> f64 {
        self.left_out_s
    }

    fn advance(&mut self) -> Result<Option<Job>, Error> {
        loop {
            if let (Some((layout, _)), Some((windows, current))) = (&self.file, &mut self.recording)
            {
                match windows.next().transpose().map_err(Error::File)? {
                    Some(window) => {
                        current.next += 1;
                        return Ok(Some(Job {
                            layout: layout.clone(),
                            labels: current.labels.clone(),
                            index: current.next - 1,
                            sample_rate_hz: current.sample_rate_hz,
                            speed_rpm: current.speed_rpm,
                            window,
                            columns: self.columns,
                        }));
                    }
                    None if current.next == 0 => {
                        let left = windows.left_out() as f64 / current.sample_rate_hz;
                        return Err(layout
                            .wrong(format!("the recording has {left:.3} s, less than a window")));
                    }
                    None => {
                        self.left_out_s += windows.left_out() as f64 / current.sample_rate_hz;
                        self.recording = None;
                    }
                }
            }
            if let Some((layout, file)) = &mut self.file {
                if let Some(recording) = file.next() {
                    let path = Path::new(&layout.file);
                    let recording = recording.map_err(|e| Error::of_file(path, e))?;
                    let whole = file.is_table();
                    self.recording = Some(windows(layout, recording, self.length, whole)?);
                    continue;
                }
                self.file = None;
            }
            let Some((input, layout)) = self.inputs.next() else {
                return Ok(None);
            };
            self.file = Some((layout, input.open()?));
        }
    }
}

/// A recording cut into windows.
fn windows(
    layout: &Layout,
    mut recording: Recording,
    length: WindowLength,
    whole: bool,
) -> Result<(Windows, Current), Error> {
    let wrong = |reason: String| layout.wrong(reason);
    let rate = recording
        .sample_rate_hz()
        .ok_or_else(|| wrong(no_rate(layout, &recording)))?;
    let stated = layout.stated_speed(recording.labels())?;
    let mut speed = stated;
    if let (None, WindowLength::Revolutions(_) | WindowLength::RevolutionsOrRows(_)) =
        (stated, length)
    {
        let first = recording.peek().map_err(Error::File)?;
        let crank = layout.crank(&first).and_then(Result::ok);
        speed = crank.and_then(|crank| shaft::speed_rpm(&crank, rate).ok());
    }
    let length = length.in_samples(rate, speed, whole).map_err(wrong)?;
    let current = Current {
        labels: Arc::new(recording.labels().to_vec()),
        sample_rate_hz: rate,
        speed_rpm: stated,
        next: 0,
    };
    let windows = Windows::new(recording, layout.channels.len(), rate, length)
        .bridging(layout.bridges(), FEWEST_SAMPLES);
    Ok((windows, current))
}

/// That no sample rate is known, and what helps.
fn no_rate(layout: &Layout, recording: &Recording) -> String {
    let names: Vec<&str> = layout.channels.iter().map(|c| c.name.as_str()).collect();
    let heading = match recording.unclear_rate() {
        None => "no heading states it".to_owned(),
        Some(unclear) => format!("no heading states it that is understood ({unclear})"),
    };
    format!(
        "the sample rate is not known: there is no column of time, and {heading}. Found: {}. Give --sample-rate, or call \
         the column of time `time [s]`",
        names.join(", ")
    )
}

impl Iterator for Jobs<'_> {
    type Item = Result<Job, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let job = self.advance().transpose();
        self.failed = matches!(job, Some(Err(_)));
        job
    }
}
