//! Recordings cut into windows.

use super::Recording;
use super::blanks::{self, Bridge};
use crate::Error;
use std::collections::VecDeque;

/// How long windows are, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// All of this length, a fraction counting over the windows; what is left over is left out.
    Equal(f64),
    /// Up to this length: a shorter recording is one window, and what is left over is another
    /// where it is at least half as long.
    UpTo(usize),
}

/// A window of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Where it begins, in seconds after the first sample.
    pub start_s: f64,
    /// Time that is missing before it, s: a window never has a gap within.
    pub gap_s: Option<f64>,
    /// The samples of each channel.
    pub channels: Vec<Vec<f64>>,
    /// Samples of each channel that were missing and are bridged by a line ([`Windows::bridging`]).
    pub bridged: Vec<usize>,
}

/// The windows of a recording, one after the other. Every stretch between gaps begins anew.
pub struct Windows {
    recording: Recording,
    sample_rate_hz: f64,
    length: Length,
    buffer: Vec<Vec<f64>>,
    /// Start of the stretch, and the first sample of the buffer within it.
    stretch_s: f64,
    first: u64,
    windows: u64,
    gap_s: Option<f64>,
    /// Gaps, and the samples behind each, that belong to the next stretches.
    ahead: VecDeque<(f64, Vec<Vec<f64>>)>,
    left_out: u64,
    ended: bool,
    blanks: Option<Blanks>,
}

/// What is made of samples without a number.
struct Blanks {
    /// Of each channel.
    bridges: Vec<Bridge>,
    /// Fewest samples of a piece beside a gap that is a window.
    shortest: usize,
    /// Whether the stretch begins or ends at such a gap.
    beside: bool,
}

impl Windows {
    /// `length` is at least one sample.
    pub fn new(recording: Recording, channels: usize, sample_rate_hz: f64, length: Length) -> Self {
        Self {
            recording,
            sample_rate_hz,
            length,
            buffer: vec![Vec::new(); channels],
            stretch_s: 0.0,
            first: 0,
            windows: 0,
            gap_s: None,
            ahead: VecDeque::new(),
            left_out: 0,
            ended: false,
            blanks: None,
        }
    }

    /// Bridges gaps of up to [`LONGEST_BRIDGED`](super::LONGEST_BRIDGED) samples without a number by
    /// lines, for each channel by its own kind. Longer ones end a stretch, as a gap in time does.
    /// Pieces of fewer than `shortest` samples beside such a gap are left out.
    pub fn bridging(mut self, bridges: Vec<Bridge>, shortest: usize) -> Self {
        self.blanks = Some(Blanks {
            bridges,
            shortest,
            beside: false,
        });
        self
    }

    /// Samples so far that were too few for a window.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// First sample of window `k` of a stretch, and how many samples it has.
    fn span(&self, k: u64) -> (u64, usize) {
        match self.length {
            Length::Equal(length) => {
                let samples = (length as usize).max(1);
                ((k as f64 * length).round() as u64, samples)
            }
            Length::UpTo(most) => (k * most as u64, most),
        }
    }

    fn buffered(&self) -> usize {
        self.buffer.first().map_or(0, Vec::len)
    }

    /// The window `samples` long at the start of the buffer.
    fn cut(&mut self, samples: usize) -> Window {
        let start_s = self.stretch_s + self.first as f64 / self.sample_rate_hz;
        let channels = self.buffer.iter_mut();
        let mut channels: Vec<Vec<f64>> = channels
            .map(|channel| {
                let rest = channel.split_off(samples);
                std::mem::replace(channel, rest)
            })
            .collect();
        let bridged = match &self.blanks {
            Some(blanks) => channels
                .iter_mut()
                .zip(&blanks.bridges)
                .map(|(channel, kind)| blanks::bridge(channel, *kind))
                .collect(),
            None => vec![0; channels.len()],
        };
        self.first += samples as u64;
        self.windows += 1;
        Window {
            start_s,
            gap_s: self.gap_s.take(),
            channels,
            bridged,
        }
    }

    /// Drops the samples before `first`, those between windows of a fractional length.
    fn skip_to(&mut self, first: u64) {
        let skipped = (first.saturating_sub(self.first) as usize).min(self.buffered());
        self.buffer.iter_mut().for_each(|channel| {
            channel.drain(..skipped);
        });
        self.first += skipped as u64;
    }

    /// What the stretch has left: a window where it is long enough.
    fn rest(&mut self) -> Option<Window> {
        let left = self.buffered();
        let enough = match self.length {
            Length::Equal(_) => false,
            Length::UpTo(most) => self.windows == 0 || 2 * left >= most,
        };
        let piece = self.blanks.as_ref().filter(|blanks| blanks.beside);
        let enough = enough && piece.is_none_or(|blanks| left >= blanks.shortest);
        if left > 0 && enough {
            return Some(self.cut(left));
        }
        self.left_out += left as u64;
        None
    }

    /// Ends the stretch at the first gap of the next `samples` that is too long to be bridged, if there
    /// is one. What follows it belongs to the next stretch.
    fn split(&mut self, samples: usize) -> bool {
        let Some(blanks) = &mut self.blanks else {
            return false;
        };
        let next: Vec<&[f64]> = self.buffer.iter().map(|c| &c[..samples]).collect();
        let Some(gap) = blanks::first_long_gap(&next, blanks.shortest) else {
            return false;
        };
        blanks.beside = true;
        let behind = self.buffer.iter_mut().map(|channel| {
            let behind = channel.split_off(gap.end);
            channel.truncate(gap.start);
            behind
        });
        let behind = behind.collect();
        let gap_s = gap.len() as f64 / self.sample_rate_hz;
        self.ahead.push_front((gap_s, behind));
        true
    }

    /// Begins the stretch after a gap.
    fn begin(&mut self, gap_s: f64, samples: Vec<Vec<f64>>) {
        let read = self.first + self.buffered() as u64;
        self.stretch_s += read as f64 / self.sample_rate_hz + gap_s;
        // Two gaps without a sample between them are one.
        let gap_s = match self.gap_s {
            Some(before) if read == 0 => before + gap_s,
            _ => gap_s,
        };
        self.buffer = samples;
        self.first = 0;
        self.windows = 0;
        self.gap_s = Some(gap_s);
    }

    fn advance(&mut self) -> Result<Option<Window>, Error> {
        loop {
            let (first, samples) = self.span(self.windows);
            self.skip_to(first);
            let whole = self.first == first && self.buffered() >= samples;
            let last = self.ended || !self.ahead.is_empty();
            let complete = if whole { samples } else { self.buffered() };
            if (whole || last) && self.split(complete) {
                continue;
            }
            if whole {
                return Ok(Some(self.cut(samples)));
            }
            if let Some((gap_s, ahead)) = self.ahead.pop_front() {
                let rest = self.rest();
                self.begin(gap_s, ahead);
                match rest {
                    Some(window) => return Ok(Some(window)),
                    None => continue,
                }
            }
            if self.ended {
                let rest = self.rest();
                self.buffer.iter_mut().for_each(Vec::clear);
                return Ok(rest);
            }
            let missing = (samples - self.buffered().min(samples)).max(1);
            let mut read = vec![Vec::new(); self.buffer.len()];
            let block = self.recording.read(missing, &mut read)?;
            if block.samples == 0 {
                self.ended = true;
            } else if let Some(gap_s) = block.gap_s {
                self.ahead.push_back((gap_s, read));
            } else {
                for (channel, mut read) in self.buffer.iter_mut().zip(read) {
                    channel.append(&mut read);
                }
            }
        }
    }
}

impl Iterator for Windows {
    type Item = Result<Window, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
