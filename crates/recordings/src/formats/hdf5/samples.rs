//! The samples of a file, a stretch at a time.

use super::contents::Array;
use super::numbers::{Number, numbers};
use super::packing::Packing;
use crate::Error;
use crate::formats::guarded::guarded;
use crate::measured::Samples;
use hdf5_reader::{Dataset, SliceInfo, SliceInfoElem};
use std::path::{Path, PathBuf};

/// What the decoder found wrong.
pub(super) fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("HDF5", path, reason)
}

/// What a file is called whose parts make the decoder panic.
pub(super) fn contradicts(path: &Path) -> Error {
    damaged(path, "its parts contradict each other")
}

/// What is read of one array.
pub(super) struct Reader {
    dataset: Dataset,
    number: Number,
    packing: Packing,
    channels: usize,
    channel_axis: Option<usize>,
    /// Which of its channels are wanted, in their order.
    wanted: Vec<usize>,
}

impl Reader {
    /// One of these channels of an array of the file at `path`.
    ///
    /// # Errors
    /// An array whose numbers stand for values in a way that is not understood.
    pub(super) fn new(path: &Path, array: &Array, wanted: Vec<usize>) -> Result<Self, Error> {
        let packing = array.packing.clone();
        let packing = packing.map_err(|reason| damaged(path, format!("`{}`: {reason}", array.path)))?;
        Ok(Self {
            dataset: array.dataset.clone(),
            number: array.number,
            packing,
            channels: array.channels,
            channel_axis: array.channel_axis,
            wanted,
        })
    }

    /// One for each array of these channels, which stand side by side.
    ///
    /// # Errors
    /// As [`Reader::new`].
    pub(super) fn of_channels<'a>(
        path: &Path,
        places: impl Iterator<Item = (&'a Array, usize)>,
    ) -> Result<Vec<Self>, Error> {
        let mut readers: Vec<(&Array, Vec<usize>)> = Vec::new();
        for (array, index) in places {
            match readers.last_mut() {
                Some((last, wanted)) if last.path == array.path => wanted.push(index),
                _ => readers.push((array, vec![index])),
            }
        }
        readers.into_iter().map(|(array, wanted)| Self::new(path, array, wanted)).collect()
    }

    /// Hands out `samples` samples of each wanted channel from sample `at` on, with the channel's place among them.
    fn read(&self, at: u64, samples: usize, mut put: impl FnMut(usize, f64)) -> hdf5_reader::error::Result<()> {
        let mut selection = SliceInfo::all(self.dataset.ndim());
        let time_axis = match self.channel_axis {
            Some(0) => 1,
            _ => 0,
        };
        selection.selections[time_axis] = SliceInfoElem::Slice {
            start: at,
            end: at + samples as u64,
            step: 1,
        };
        let numbers = numbers(&self.dataset, self.number, &selection)?;
        // Row by row: samples stand beside each other where the channels are the rows.
        let (first, step) = match self.channel_axis {
            Some(0) => (samples, 1),
            _ => (1, self.channels),
        };
        for (place, index) in self.wanted.iter().enumerate() {
            let of_channel = numbers.iter().skip(index * first).step_by(step);
            of_channel.take(samples).for_each(|x| put(place, self.packing.value(*x)));
        }
        Ok(())
    }
}

/// The samples of the channels of a file.
pub(super) struct Hdf5Samples {
    pub(super) path: PathBuf,
    pub(super) time: Option<Reader>,
    pub(super) channels: Vec<Reader>,
    /// The next sample, and how many there are.
    pub(super) at: u64,
    pub(super) length: u64,
}

impl Samples for Hdf5Samples {
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let left = self.length - self.at;
        let samples = most.min(usize::try_from(left).unwrap_or(usize::MAX));
        if samples == 0 {
            return Ok(0);
        }
        let mut read = || -> hdf5_reader::error::Result<()> {
            if let Some(time) = &self.time {
                time.read(self.at, samples, |_, t| times.push(t))?;
            }
            let mut first = 0;
            for reader in &self.channels {
                let put = |place: usize, x: f64| channels[first + place].push(x);
                reader.read(self.at, samples, put)?;
                first += reader.wanted.len();
            }
            Ok(())
        };
        guarded(|| read().map_err(|error| damaged(&self.path, error)), || contradicts(&self.path))?;
        self.at += samples as u64;
        Ok(samples)
    }
}
