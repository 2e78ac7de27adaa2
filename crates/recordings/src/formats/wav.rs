//! WAV: RIFF, and RF64 for files above 4 GiB (EBU Tech 3306), with samples as whole numbers of 8 to
//! 32 bits or as floating-point numbers.
//!
//! Whole numbers are scaled so that full scale is 1, as players do; channels are called
//! `channel_1`, `channel_2`, ... and have no unit.

use super::recording_format::{RecordingFormat, has};
use crate::Error;
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, one_rate, selected,
};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// More channels than any recorder has.
const MOST_CHANNELS: u16 = 1024;

/// A size that a program leaves behind which writes to a pipe, or whose true value is in `ds64`.
const UNKNOWN: u32 = u32::MAX;

/// How a sample is stored, in little-endian bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    U8,
    I16,
    I24,
    I32,
    F32,
    F64,
}

#[derive(Clone, Copy, Debug)]
struct Format {
    encoding: Encoding,
    channels: u16,
    sample_rate_hz: u32,
}

struct WavSamples {
    path: PathBuf,
    file: BufReader<File>,
    format: Format,
    /// Which channels are wanted.
    wanted: Vec<usize>,
    frames_left: u64,
    bytes: Vec<u8>,
}

/// WAV as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "WAV",
    endings: &["wav"],
    signature_at: Some(0),
    recognise: |head| {
        let mut containers = [b"RIFF", b"RF64", b"BW64"].into_iter();
        let is_wav = containers.any(|name| has(head, 0, name)) && has(head, 8, b"WAVE");
        is_wav.then_some("a WAV file")
    },
    open,
};

/// Opens a file.
fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let file = files::open(path).map_err(Error::io("open", path))?;
    let length = file.metadata().map_err(Error::io("read", path))?.len();
    let mut file = BufReader::new(file);
    let (format, frames) = heading(path, &mut file, length)?;
    let all: Vec<MeasuredChannel> = (1..=format.channels)
        .map(|i| MeasuredChannel {
            column: format!("channel_{i}"),
            name: format!("channel_{i}"),
            unit: None,
        })
        .collect();
    let wanted = selected(&all, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| all[i].clone()).collect();
    let rate = one_rate(path, Some(f64::from(format.sample_rate_hz)), options)?;
    let samples = WavSamples {
        path: path.to_owned(),
        file,
        format,
        wanted,
        frames_left: frames,
        bytes: Vec::new(),
    };
    let count = channels.len();
    MeasuredFile::of_one(channels, Vec::new(), |labels| {
        Recording::new(path, labels, count, rate, None, samples)
    })
}

fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("WAV", path, reason)
}

/// Reads up to the first sample: the format, and how many frames (a sample per channel) follow.
fn heading(path: &Path, file: &mut BufReader<File>, length: u64) -> Result<(Format, u64), Error> {
    let short = |error: std::io::Error| match error.kind() {
        ErrorKind::UnexpectedEof => damaged(path, "it ends before its samples begin"),
        _ => Error::io("read", path)(error),
    };
    let mut riff = [0; 12];
    file.read_exact(&mut riff).map_err(short)?;
    if &riff[8..] != b"WAVE"
        || ![b"RIFF", b"RF64", b"BW64"].contains(&&[riff[0], riff[1], riff[2], riff[3]])
    {
        return Err(damaged(path, "it does not begin as a WAV file does"));
    }
    let mut format = None;
    let mut long_data = None;
    loop {
        let mut head = [0; 8];
        file.read_exact(&mut head).map_err(short)?;
        let size = word(&head, 4);
        match &head[..4] {
            b"data" => {
                let format: Format =
                    format.ok_or_else(|| damaged(path, "its samples come before their format"))?;
                let begin = file.stream_position().map_err(Error::io("read", path))?;
                let there = length.saturating_sub(begin);
                let announced = match (size, long_data) {
                    (UNKNOWN, Some(long)) => long,
                    (UNKNOWN, None) => there,
                    (size, _) => u64::from(size),
                };
                if announced > there {
                    return Err(damaged(
                        path,
                        format!(
                            "it announces {announced} bytes of samples and has {there}: it is cut off"
                        ),
                    ));
                }
                let frames = announced / format.frame_bytes() as u64;
                if frames == 0 {
                    return Err(damaged(path, "it has no samples"));
                }
                return Ok((format, frames));
            }
            b"fmt " => {
                let body = body(file, size, 40).map_err(short)?;
                format = Some(Format::read(&body).map_err(|reason| damaged(path, reason))?);
            }
            b"ds64" => {
                let body = body(file, size, 28).map_err(short)?;
                let long =
                    |at: usize| u64::from(word(&body, at)) | u64::from(word(&body, at + 4)) << 32;
                long_data = (body.len() >= 16).then(|| long(8));
            }
            _ => {
                // Chunks are padded to an even length.
                let skip = i64::from(size) + i64::from(size % 2);
                file.seek_relative(skip).map_err(short)?;
            }
        }
    }
}

/// The first `most` bytes of a chunk, or all; the file then stands behind the chunk.
fn body(file: &mut BufReader<File>, size: u32, most: u32) -> std::io::Result<Vec<u8>> {
    let mut body = vec![0; size.min(most) as usize];
    file.read_exact(&mut body)?;
    let rest = i64::from(size) + i64::from(size % 2) - body.len() as i64;
    file.seek(SeekFrom::Current(rest))?;
    Ok(body)
}

fn word(bytes: &[u8], at: usize) -> u32 {
    let byte = |i: usize| u32::from(bytes.get(at + i).copied().unwrap_or(0));
    byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24
}

impl Format {
    fn read(body: &[u8]) -> Result<Self, String> {
        if body.len() < 16 {
            return Err(format!(
                "its format has {} bytes where 16 belong",
                body.len()
            ));
        }
        let half = |at: usize| (word(body, at) & 0xffff) as u16;
        // The extensible form has the true code at the start of a GUID.
        let code = match half(0) {
            0xfffe if body.len() >= 26 => half(24),
            code => code,
        };
        let bits = half(14);
        let encoding = match (code, bits) {
            (1, 8) => Encoding::U8,
            (1, 16) => Encoding::I16,
            (1, 24) => Encoding::I24,
            (1, 32) => Encoding::I32,
            (3, 32) => Encoding::F32,
            (3, 64) => Encoding::F64,
            _ => {
                return Err(format!(
                    "its samples are compressed or of an unusual kind (code {code}, {bits} bits)"
                ));
            }
        };
        let format = Self {
            encoding,
            channels: half(2),
            sample_rate_hz: word(body, 4),
        };
        if !(1..=MOST_CHANNELS).contains(&format.channels) {
            return Err(format!("it has {} channels", format.channels));
        }
        if format.sample_rate_hz == 0 {
            return Err("its sample rate is 0 Hz".into());
        }
        Ok(format)
    }

    fn frame_bytes(&self) -> usize {
        self.encoding.bytes() * usize::from(self.channels)
    }
}

impl Encoding {
    fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::I16 => 2,
            Self::I24 => 3,
            Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn decode(self, b: &[u8]) -> f64 {
        match (self, b) {
            (Self::U8, &[a]) => (f64::from(a) - 128.0) / 128.0,
            (Self::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])) / 32_768.0,
            (Self::I24, &[a, b, c]) => f64::from(i32::from_le_bytes([0, a, b, c]) >> 8) / 8_388_608.0,
            (Self::I32, &[a, b, c, d]) => {
                f64::from(i32::from_le_bytes([a, b, c, d])) / 2_147_483_648.0
            }
            (Self::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Self::F64, &[a, b, c, d, e, f, g, h]) => {
                f64::from_le_bytes([a, b, c, d, e, f, g, h])
            }
            _ => f64::NAN,
        }
    }
}

impl Samples for WavSamples {
    fn read(
        &mut self,
        most: usize,
        _times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let frames = most.min(usize::try_from(self.frames_left).unwrap_or(usize::MAX));
        let frame = self.format.frame_bytes();
        self.bytes.resize(frames * frame, 0);
        self.file
            .read_exact(&mut self.bytes)
            .map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => damaged(&self.path, "it is cut off"),
                _ => Error::io("read", &self.path)(error),
            })?;
        self.frames_left -= frames as u64;
        let (encoding, width) = (self.format.encoding, self.format.encoding.bytes());
        for (channel, &index) in channels.iter_mut().zip(&self.wanted) {
            let at = index * width..(index + 1) * width;
            let frames = self.bytes.chunks_exact(frame);
            channel.extend(frames.map(|frame| encoding.decode(&frame[at.clone()])));
        }
        Ok(frames)
    }
}
