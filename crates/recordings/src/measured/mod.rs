//! Recordings of any origin, read a stretch at a time: CSV, WAV, MAT, HDF5, Parquet, MCAP.
//!
//! [`MeasuredFile::open`] reads the heading of a file: its channels with their units, and the
//! columns of its labels. The recordings follow one after the other. Most files have one; a table with lists of
//! samples has one per row. A [`Recording`] hands out
//! its samples in blocks, and [`Windows`] cuts these into windows. Memory is that of a block and of
//! a window, for a file of any length.
//!
//! A cell without a number, and one beyond the range of float32, becomes NaN, which the caller has to handle:
//! [`Windows::bridging`] bridges short gaps and splits at long ones.

mod blanks;
mod clock;
pub(crate) mod expansion;
mod format;
mod heading;
mod names;
mod open;
mod stated;
mod windows;

pub use blanks::{Bridge, LONGEST_BRIDGED};
pub use heading::{Heading, headings};
pub use names::stem;
pub use windows::{Length, Window, Windows};

pub(crate) use clock::TimeColumn;
pub(crate) use names::{TimeUnit, is_unit, name_and_unit, seconds_of_unit, time_unit};
pub(crate) use stated::{
    CLEAR_FROM_HZ, PERIODS, RATES, StatedRate, agree, is_sample_rate, is_speed, only_rate,
    speed_label, unclear_number,
};

use crate::{Column, Error, Value};
use clock::Clock;
use expansion::Expansion;
use std::path::{Path, PathBuf};

/// Samples from which the rate is determined where there is a column of time.
const FIRST_SAMPLES: usize = 1 << 12;

/// Samples of each channel that are decoded at a time.
const BLOCK_SAMPLES: usize = 1 << 15;

/// What is known about a file beside what stands in it.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Columns to read, by name; all columns of numbers where it is empty. A crank angle and a
    /// column of time are read in any case.
    pub columns: Vec<String>,
    /// Samples per second.
    pub sample_rate_hz: Option<f64>,
    /// Lines of a text file before its table, where they would be taken for it.
    pub skipped_lines: u64,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeasuredChannel {
    /// Name of the column as the file has it.
    pub column: String,
    /// Name without a unit in brackets: `acc` of `acc [m/s^2]`.
    pub name: String,
    /// The unit as the file has it, if it says one.
    pub unit: Option<String>,
}

impl MeasuredChannel {
    /// Whether this is its column, or its name without the unit.
    pub fn is_called(&self, name: &str) -> bool {
        self.column == name || self.name == name
    }
}

/// A file of recordings: its heading, and its recordings one after the other.
pub struct MeasuredFile {
    channels: Vec<MeasuredChannel>,
    labels: Vec<Column>,
    table: bool,
    recordings: Box<dyn Iterator<Item = Result<Recording, Error>> + Send>,
}

/// A recording whose samples are read from the first to the last.
pub struct Recording {
    path: PathBuf,
    labels: Vec<Value>,
    sample_rate_hz: Option<f64>,
    unclear_rate: Option<String>,
    start_s: Option<f64>,
    clock: Option<Clock>,
    samples: Box<dyn Samples>,
    expansion: Expansion,
    /// Samples that are decoded and not handed out, from `next` on.
    times: Vec<f64>,
    block: Vec<Vec<f64>>,
    next: usize,
    gap_s: Option<f64>,
}

/// What was read at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Samples of every channel; 0 at the end.
    pub samples: usize,
    /// Time that is missing before the first of them, s; a block never has a gap within.
    pub gap_s: Option<f64>,
}

/// The samples of a format, one block after the other.
pub(crate) trait Samples: Send {
    /// Appends at most `most` samples to every channel, and their times where there is a column of
    /// time; how many, 0 at the end.
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error>;

    /// The time from which times count once some were read, s since 1970 or since midnight; 0 where they are numbers.
    fn origin_s(&self) -> f64 {
        0.0
    }

    /// The line of the file in which a sample stands that was read last, where the format has lines.
    fn line(&self, _sample: u64) -> Option<u64> {
        None
    }
}

impl MeasuredFile {
    /// A file of one recording.
    pub(crate) fn of_one(
        channels: Vec<MeasuredChannel>,
        labels: Vec<(Column, Value)>,
        make: impl FnOnce(Vec<Value>) -> Result<Recording, Error>,
    ) -> Result<Self, Error> {
        let (labels, values) = labels.into_iter().unzip();
        let recording = make(values)?;
        Ok(Self {
            channels,
            labels,
            table: false,
            recordings: Box::new(std::iter::once(Ok(recording))),
        })
    }

    /// A table with one recording per row.
    pub(crate) fn of_rows(
        channels: Vec<MeasuredChannel>,
        labels: Vec<Column>,
        recordings: impl Iterator<Item = Result<Recording, Error>> + Send + 'static,
    ) -> Self {
        Self {
            channels,
            labels,
            table: true,
            recordings: Box::new(recordings),
        }
    }

    /// The channels; every recording has them all.
    pub fn channels(&self) -> &[MeasuredChannel] {
        &self.channels
    }

    /// What the file says about its recordings: a case's name, its labels, the speed.
    pub fn labels(&self) -> &[Column] {
        &self.labels
    }

    /// Whether it is a table with one recording per row.
    pub fn is_table(&self) -> bool {
        self.table
    }
}

impl Iterator for MeasuredFile {
    type Item = Result<Recording, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.recordings.next()
    }
}

impl Recording {
    /// Where there is a column of time, the first samples are read to determine the rate.
    pub(crate) fn new(
        path: &Path,
        labels: Vec<Value>,
        channels: usize,
        stated: Option<StatedRate>,
        time: Option<TimeColumn>,
        samples: impl Samples + 'static,
    ) -> Result<Self, Error> {
        let stated_hz = stated.as_ref().map(|stated| stated.hz);
        if let Some(rate) = stated_hz
            && !(rate.is_finite() && rate > 0.0)
        {
            return Err(Error::SampleRate(rate));
        }
        let mut recording = Self {
            path: path.to_owned(),
            labels,
            sample_rate_hz: stated_hz,
            unclear_rate: None,
            start_s: None,
            clock: None,
            samples: Box::new(samples),
            expansion: Expansion::new(path),
            times: Vec::new(),
            block: vec![Vec::new(); channels],
            next: 0,
            gap_s: None,
        };
        if let Some(time) = time {
            while recording.times.len() < FIRST_SAMPLES {
                let most = FIRST_SAMPLES - recording.times.len();
                if recording.decode(most)? == 0 {
                    break;
                }
            }
            if recording.times.is_empty() {
                return Err(Error::damaged("a recording", path, "it has no samples"));
            }
            let place = |sample| place(&*recording.samples, sample);
            let clock = Clock::new(path, time, &recording.times, stated.as_ref(), &place)?;
            let start_s = clock.seconds(recording.times[0]);
            recording.start_s = Some(recording.samples.origin_s() + start_s);
            recording.sample_rate_hz = Some(clock.sample_rate_hz());
            recording.clock = Some(clock);
        }
        Ok(recording)
    }

    /// The values of the file's [`MeasuredFile::labels`].
    pub fn labels(&self) -> &[Value] {
        &self.labels
    }

    /// Samples per second, if the file or its reader knows it.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        self.sample_rate_hz
    }

    /// The same, with what stands in the file about a sample rate and is not understood.
    pub(crate) fn with_unclear_rate(self, unclear_rate: Option<String>) -> Self {
        Self {
            unclear_rate,
            ..self
        }
    }

    /// What stands in the file about a sample rate and is not understood: its place, and why.
    pub fn unclear_rate(&self) -> Option<&str> {
        self.unclear_rate.as_deref()
    }

    /// Time of the first sample by the file's column of time, s: since 1970 where it holds dates, since midnight where
    /// it holds times of day.
    pub fn start_s(&self) -> Option<f64> {
        self.start_s
    }

    /// Some of the next samples of every channel, at least one where there is one; they are still to
    /// be read.
    ///
    /// # Errors
    /// When the file is damaged or ends too early.
    pub fn peek(&mut self) -> Result<Vec<&[f64]>, Error> {
        if self.next == self.decoded() {
            self.refill()?;
        }
        Ok(self.block.iter().map(|c| &c[self.next..]).collect())
    }

    /// Appends at most `most` samples to every channel of `into`, up to the next gap in time.
    ///
    /// # Errors
    /// When the file is damaged or ends too early, or its times run backwards.
    pub fn read(&mut self, most: usize, into: &mut [Vec<f64>]) -> Result<Block, Error> {
        if self.next == self.decoded() && !self.refill()? {
            return Ok(Block {
                samples: 0,
                gap_s: None,
            });
        }
        let end = self.decoded().min(self.next.saturating_add(most));
        let (stop, gap_before, gap_after) = self.stretch(end)?;
        for (to, from) in into.iter_mut().zip(&self.block) {
            to.extend_from_slice(&from[self.next..stop]);
        }
        let samples = stop - self.next;
        self.next = stop;
        self.gap_s = gap_after;
        Ok(Block {
            samples,
            gap_s: gap_before,
        })
    }

    fn decoded(&self) -> usize {
        self.block.first().map_or(0, Vec::len)
    }

    fn refill(&mut self) -> Result<bool, Error> {
        self.times.clear();
        self.block.iter_mut().for_each(Vec::clear);
        self.next = 0;
        Ok(self.decode(BLOCK_SAMPLES)? > 0)
    }

    /// Decodes at most `most` samples, and says how many there were.
    fn decode(&mut self, most: usize) -> Result<usize, Error> {
        let before = self.decoded();
        let read = self.samples.read(most, &mut self.times, &mut self.block)?;
        for channel in &mut self.block {
            missing_where_infinite(&mut channel[before..]);
        }
        let numbers = read.saturating_mul(self.block.len().max(1));
        let taken = self.expansion.take(numbers);
        taken.map_err(|reason| Error::damaged("a recording", &self.path, reason))?;
        Ok(read)
    }

    /// From the next sample to `end` or the first gap before it. Returns where it stops, the gap before
    /// it, and the gap at its end, which the clock has then passed.
    fn stretch(&mut self, end: usize) -> Result<(usize, Option<f64>, Option<f64>), Error> {
        let passed = self.gap_s.take();
        let Some(clock) = &mut self.clock else {
            return Ok((end, None, None));
        };
        let place = |sample| place(&*self.samples, sample);
        let mut before = passed;
        let first = self.next + usize::from(passed.is_some());
        for i in first..end {
            if let Some(gap) = clock.tick(&self.path, self.times[i], &place)? {
                if i == self.next {
                    before = Some(gap);
                } else {
                    return Ok((i, before, Some(gap)));
                }
            }
        }
        Ok((end, before, None))
    }
}

/// Where a sample stands in its file.
fn place(samples: &dyn Samples, sample: u64) -> String {
    match samples.line(sample) {
        Some(line) => format!("line {line}"),
        None => format!("sample {sample}"),
    }
}

/// Samples beyond all numbers of float32 are no measurements: they become NaN, missing ones.
fn missing_where_infinite(samples: &mut [f64]) {
    let most = f64::from(f32::MAX);
    for sample in samples.iter_mut().filter(|sample| sample.abs() > most) {
        *sample = f64::NAN;
    }
}

/// The channels to read, of all that a file has: those asked for, by their column or
/// their name, with the crank angle; all channels by default.
pub(crate) fn selected(all: &[MeasuredChannel], options: &Options) -> Result<Vec<usize>, Error> {
    if let Some(name) = options
        .columns
        .iter()
        .find(|name| !all.iter().any(|c| c.is_called(name)))
    {
        return Err(Error::NoColumn {
            name: name.clone(),
            among: all.iter().map(|c| c.column.clone()).collect(),
        });
    }
    let wanted = |channel: &MeasuredChannel| {
        options.columns.is_empty()
            || stem(&channel.name) == "crank_angle"
            || options.columns.iter().any(|name| channel.is_called(name))
    };
    Ok((0..all.len()).filter(|&i| wanted(&all[i])).collect())
}

/// The rate that a file states and the one that its reader states, which must not contradict.
pub(crate) fn one_rate(
    path: &Path,
    of_file: Option<f64>,
    options: &Options,
) -> Result<Option<StatedRate>, Error> {
    match (of_file, options.sample_rate_hz) {
        (Some(file), Some(stated)) if !agree(file, stated) => Err(Error::RateContradicts {
            path: path.to_owned(),
            file_hz: file,
            stated_hz: stated,
        }),
        (file, stated) => Ok(stated.or(file).map(StatedRate::number)),
    }
}

/// The length that all channels have.
pub(crate) fn one_length(
    format: &'static str,
    path: &Path,
    channels: &[MeasuredChannel],
    lengths: impl Iterator<Item = u64> + Clone,
) -> Result<u64, Error> {
    let first = lengths.clone().next().unwrap_or(0);
    if lengths.clone().all(|length| length == first) {
        return Ok(first);
    }
    let shown: Vec<String> = channels
        .iter()
        .zip(lengths)
        .take(20)
        .map(|(channel, length)| format!("{} ({length})", channel.column))
        .collect();
    let shown = shown.join(", ");
    let reason =
        format!("its channels differ in length, so that they cannot be read together: {shown}");
    Err(Error::damaged(format, path, reason))
}
