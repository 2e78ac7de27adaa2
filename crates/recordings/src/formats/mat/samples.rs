//! Where the samples of a channel stand within a variable, and how they are read.

use super::elements::{BUFFER, Bytes, Number, Variable, damaged, failed, numbers};
use crate::Error;
use crate::measured::Samples;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// More channels than a variable of samples has.
const MOST_CHANNELS: u64 = 256;

/// Where the samples of a channel stand within their variable, column by column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Which channel of its variable, from 0.
    index: u64,
    first: u64,
    stride: u64,
    pub(super) samples: u64,
}

impl Place {
    pub(super) fn all(path: &Path, variable: &Variable) -> Result<Vec<Self>, Error> {
        let (rows, columns) = (variable.rows, variable.columns);
        let by_column = rows >= columns;
        let channels = rows.min(columns);
        if channels > MOST_CHANNELS {
            return Err(damaged(
                path,
                format!(
                    "variable `{}` is {rows} by {columns}, which are no channels",
                    variable.name
                ),
            ));
        }
        Ok((0..channels)
            .map(|index| Self {
                index,
                first: if by_column { index * rows } else { index },
                stride: if by_column { 1 } else { rows },
                samples: rows.max(columns),
            })
            .collect())
    }

    pub(super) fn name(&self, variable: &Variable) -> String {
        if variable.rows.min(variable.columns) == 1 {
            variable.name.clone()
        } else {
            format!("{}_{}", variable.name, self.index + 1)
        }
    }
}

/// The samples of one channel.
pub(super) struct Reader {
    bytes: Bytes,
    number: Number,
    big_endian: bool,
    /// Numbers per sample, and which of them is the channel's.
    stride: usize,
    pick: usize,
    buffer: Vec<u8>,
}

impl Reader {
    pub(super) fn open(path: &Path, big_endian: bool, of: &Variable, place: &Place) -> Result<Self, Error> {
        let mut bytes = numbers(path, big_endian, of)?;
        let mut pick = place.first as usize;
        if place.stride == 1 {
            let before = place.first * of.number.bytes() as u64;
            bytes.skip(before).map_err(failed(path))?;
            pick = 0;
        }
        Ok(Self {
            bytes,
            number: of.number,
            big_endian,
            stride: place.stride as usize,
            pick,
            buffer: Vec::new(),
        })
    }

    fn read(&mut self, mut samples: usize, mut put: impl FnMut(f64)) -> io::Result<()> {
        let width = self.number.bytes();
        let sample = width * self.stride;
        let at = self.pick * width..(self.pick + 1) * width;
        while samples > 0 {
            let now = samples.min((BUFFER / sample).max(1));
            self.buffer.resize(now * sample, 0);
            self.bytes.read_exact(&mut self.buffer)?;
            for bytes in self.buffer.chunks_exact(sample) {
                put(self.number.decode(&bytes[at.clone()], self.big_endian));
            }
            samples -= now;
        }
        Ok(())
    }
}

/// The samples of the channels of a file.
pub(super) struct MatSamples {
    pub(super) path: PathBuf,
    pub(super) time: Option<Reader>,
    pub(super) channels: Vec<Reader>,
    /// Samples that are still to be read.
    pub(super) left: u64,
}

impl Samples for MatSamples {
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let samples = most.min(usize::try_from(self.left).unwrap_or(usize::MAX));
        self.left -= samples as u64;
        if let Some(time) = &mut self.time {
            time.read(samples, |t| times.push(t))
                .map_err(failed(&self.path))?;
        }
        for (reader, channel) in self.channels.iter_mut().zip(channels) {
            let put = |x| channel.push(x);
            reader.read(samples, put).map_err(failed(&self.path))?;
        }
        Ok(samples)
    }
}
