//! MAT files of version 5 to 7 (MathWorks, *MAT-File Format*, 2024): numeric variables, of either
//! byte order, compressed or not.
//!
//! - Every vector is a channel called as its variable. A matrix has one channel per column (or row,
//!   where those are the longer ones) called `name_1`, `name_2`, ...
//! - A variable that is one number is the sample rate when it is called `fs`, `Fs` or `sample_rate_hz`, and the speed
//!   when its name ends in `rpm`.
//! - Text, cells, structures, and complex and sparse arrays are left out.

use super::recording_format::{RecordingFormat, Seen, has};
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, TimeColumn, name_and_unit,
    one_rate, seconds_per_unit, selected,
};
use crate::{Column, Error, Kind, Value};
use flate2::read::ZlibDecoder;
use std::fs::File;
use std::io::{self, BufReader, Cursor, ErrorKind, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};

/// More channels than a variable of samples has.
const MOST_CHANNELS: u64 = 256;

/// Longest name of a variable; MATLAB's own limit is 63.
const LONGEST_NAME: u32 = 1 << 10;

/// Bytes of a channel that are decoded at a time.
const BUFFER: usize = 1 << 16;

const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

/// A variable that holds real numbers.
#[derive(Clone, Debug)]
struct Variable {
    name: String,
    rows: u64,
    columns: u64,
    /// Where its element stands in the file.
    offset: u64,
    number: Number,
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
    I64,
    U64,
}

impl Number {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            1 => Self::I8,
            2 => Self::U8,
            3 => Self::I16,
            4 => Self::U16,
            5 => Self::I32,
            6 => Self::U32,
            7 => Self::F32,
            9 => Self::F64,
            12 => Self::I64,
            13 => Self::U64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// The number in these bytes, which are as many as it has.
    fn decode(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut word = [0; 8];
        let n = bytes.len().min(8);
        word[..n].copy_from_slice(&bytes[..n]);
        if big_endian {
            word[..n].reverse();
        }
        let bits = u64::from_le_bytes(word);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
            Self::I64 => bits as i64 as f64,
            Self::U64 => bits as f64,
        }
    }
}

fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("MAT", path, reason)
}

/// An error of the operating system, or of the decoder that finds damage.
fn failed(path: &Path) -> impl Fn(io::Error) -> Error + '_ {
    move |error| match error.kind() {
        ErrorKind::UnexpectedEof => damaged(path, "it is cut off"),
        ErrorKind::InvalidInput | ErrorKind::InvalidData => {
            damaged(path, format!("a compressed variable is damaged: {error}"))
        }
        _ => Error::io("read", path)(error),
    }
}

/// MAT as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "MAT",
    endings: &["mat"],
    signature_at: Some(126),
    recognise: |head| {
        if has(head, 0, b"MATLAB 7.3") || has(head, 512, b"\x89HDF\r\n\x1a\n") {
            let words = "a MAT file of version 7.3 (HDF5); save it with `-v7`";
            return Some(Seen::Unreadable(words));
        }
        let is_mat = has(head, 126, b"IM") || has(head, 126, b"MI");
        is_mat.then_some(Seen::Readable("a MAT file"))
    },
    open,
};

/// Opens a file.
fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let (big_endian, variables) = scan(path)?;
    let (scalars, arrays): (Vec<_>, Vec<_>) =
        variables.into_iter().partition(|v| v.rows * v.columns == 1);
    let mut all = Vec::new();
    let mut places = Vec::new();
    for variable in &arrays {
        for place in Place::all(path, variable)? {
            let (name, unit) = name_and_unit(&place.name(variable));
            let column = name.clone();
            all.push(MeasuredChannel { column, name, unit });
            places.push((variable, place));
        }
    }
    let is_time = |i: &usize| seconds_per_unit(&all[*i].name, all[*i].unit.as_deref()).is_some();
    let (times, rest): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(is_time);
    let candidates: Vec<MeasuredChannel> = rest.iter().map(|&i| all[i].clone()).collect();
    if candidates.is_empty() {
        return Err(damaged(path, "it has no vector or matrix of real numbers"));
    }
    let wanted = selected(&candidates, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| candidates[i].clone()).collect();
    let wanted: Vec<usize> = wanted.iter().map(|&i| rest[i]).collect();
    let length = one_length(path, &channels, wanted.iter().map(|&i| places[i].1.samples))?;
    let time = times
        .iter()
        .copied()
        .find(|&i| places[i].1.samples == length);
    let reader = |&i: &usize| {
        let (variable, place) = &places[i];
        Reader::open(path, big_endian, variable, place)
    };
    let samples = MatSamples {
        path: path.to_owned(),
        time: time.as_ref().map(reader).transpose()?,
        channels: wanted.iter().map(reader).collect::<Result<_, _>>()?,
        left: length,
    };
    let time = time.map(|i| TimeColumn {
        name: all[i].name.clone(),
        seconds_per_unit: seconds_per_unit(&all[i].name, all[i].unit.as_deref()).unwrap_or(1.0),
        single_precision: places[i].0.number == Number::F32,
    });
    let scalar = |is: &dyn Fn(&str) -> bool| {
        let found = scalars.iter().find(|v| is(&v.name.to_ascii_lowercase()));
        found
            .map(|variable| scalar(path, big_endian, variable))
            .transpose()
    };
    let stated = scalar(&|name| ["fs", "sample_rate_hz"].contains(&name))?;
    let rate = one_rate(path, stated, options)?;
    let speed = scalar(&|name| name.ends_with("rpm"))?.filter(|s| s.is_finite() && *s > 0.0);
    let speed = speed.map(|speed| {
        let column = Column::new("speed_rpm", Kind::Real, "speed of the crank").unit("rpm");
        (column.optional(), Value::from(speed))
    });
    let count = channels.len();
    MeasuredFile::of_one(channels, speed.into_iter().collect(), |labels| {
        Recording::new(path, labels, count, rate, time, samples)
    })
}

fn one_length(
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
        .map(|(channel, length)| format!("{} ({length})", channel.name))
        .collect();
    let shown = shown.join(", ");
    Err(damaged(
        path,
        format!("its variables differ in length, so that they cannot be read together: {shown}"),
    ))
}

/// Where the samples of a channel stand within their variable, column by column.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Which channel of its variable, from 0.
    index: u64,
    first: u64,
    stride: u64,
    samples: u64,
}

impl Place {
    fn all(path: &Path, variable: &Variable) -> Result<Vec<Self>, Error> {
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

    fn name(&self, variable: &Variable) -> String {
        if variable.rows.min(variable.columns) == 1 {
            variable.name.clone()
        } else {
            format!("{}_{}", variable.name, self.index + 1)
        }
    }
}

/// A stream of the bytes of one element.
enum Bytes {
    Plain(Take<BufReader<File>>),
    /// Up to four bytes that stand in the tag itself.
    InTag(Cursor<Vec<u8>>),
    Compressed(Box<ZlibDecoder<Take<BufReader<File>>>>),
}

impl Read for Bytes {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(file) => file.read(into),
            Self::InTag(bytes) => bytes.read(into),
            Self::Compressed(file) => file.read(into),
        }
    }
}

impl Bytes {
    fn skip(&mut self, bytes: u64) -> io::Result<()> {
        if let Self::Plain(file) = self {
            let limit = file.limit();
            if bytes > limit {
                return Err(ErrorKind::UnexpectedEof.into());
            }
            file.get_mut().seek_relative(bytes as i64)?;
            file.set_limit(limit - bytes);
            return Ok(());
        }
        let skipped = io::copy(&mut self.by_ref().take(bytes), &mut io::sink())?;
        if skipped < bytes {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        Ok(())
    }
}

/// The byte order, and the numeric variables.
fn scan(path: &Path) -> Result<(bool, Vec<Variable>), Error> {
    let mut file = files::open(path).map_err(Error::io("open", path))?;
    let length = file.metadata().map_err(Error::io("read", path))?.len();
    let mut head = [0; 128];
    file.read_exact(&mut head).map_err(failed(path))?;
    let big_endian = match &head[126..] {
        b"IM" => false,
        b"MI" => true,
        _ => {
            return Err(damaged(
                path,
                "it does not begin as a MAT file of version 5 does",
            ));
        }
    };
    let mut variables = Vec::new();
    let mut offset = head.len() as u64;
    while offset + 8 <= length {
        file.seek(SeekFrom::Start(offset)).map_err(failed(path))?;
        let mut tag = [0; 8];
        file.read_exact(&mut tag).map_err(failed(path))?;
        let size = u64::from(word(&tag[4..], big_endian));
        if offset + 8 + size > length {
            return Err(damaged(
                path,
                format!("it ends within the variable at byte {offset}: it is cut off"),
            ));
        }
        if let Some(mut bytes) = element(path, big_endian, offset)? {
            let found = variable(&mut bytes, big_endian, offset).map_err(failed(path))?;
            variables.extend(found.map(|(variable, _)| variable));
        }
        offset += 8 + size;
    }
    Ok((big_endian, variables))
}

/// The bytes of the array at `offset`; none of other elements.
fn element(path: &Path, big_endian: bool, offset: u64) -> Result<Option<Bytes>, Error> {
    let mut file = files::open(path).map_err(Error::io("open", path))?;
    file.seek(SeekFrom::Start(offset)).map_err(failed(path))?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    let mut tag = [0; 8];
    file.read_exact(&mut tag).map_err(failed(path))?;
    let size = u64::from(word(&tag[4..], big_endian));
    match word(&tag, big_endian) {
        MATRIX => Ok(Some(Bytes::Plain(file.take(size)))),
        COMPRESSED => {
            let mut bytes = Bytes::Compressed(Box::new(ZlibDecoder::new(file.take(size))));
            bytes.read_exact(&mut tag).map_err(failed(path))?;
            let is_array = word(&tag, big_endian) == MATRIX;
            Ok(is_array.then_some(bytes))
        }
        _ => Ok(None),
    }
}

fn word(bytes: &[u8], big_endian: bool) -> u32 {
    let word = [bytes[0], bytes[1], bytes[2], bytes[3]];
    if big_endian {
        u32::from_be_bytes(word)
    } else {
        u32::from_le_bytes(word)
    }
}

/// The tag of an element within an array: type, length, and its bytes where they are in the tag.
fn tag(bytes: &mut Bytes, big_endian: bool) -> io::Result<(u32, u32, Option<[u8; 4]>)> {
    let mut tag = [0; 8];
    bytes.read_exact(&mut tag)?;
    let first = word(&tag, big_endian);
    if first >> 16 != 0 {
        let size = (first >> 16).min(4);
        return Ok((first & 0xffff, size, Some([tag[4], tag[5], tag[6], tag[7]])));
    }
    Ok((first, word(&tag[4..], big_endian), None))
}

/// A short element in full, with its padding.
fn short(bytes: &mut Bytes, big_endian: bool, most: u32) -> io::Result<Option<Vec<u8>>> {
    let (_, size, inside) = tag(bytes, big_endian)?;
    if let Some(inside) = inside {
        return Ok(Some(inside[..size as usize].to_vec()));
    }
    if size > most {
        return Ok(None);
    }
    let mut body = vec![0; size.next_multiple_of(8) as usize];
    bytes.read_exact(&mut body)?;
    body.truncate(size as usize);
    Ok(Some(body))
}

/// Reads an array up to its numbers: what it holds, and those that stand in their tag; none where
/// it is not two-dimensional and real.
fn variable(
    bytes: &mut Bytes,
    big_endian: bool,
    offset: u64,
) -> io::Result<Option<(Variable, Option<Vec<u8>>)>> {
    let Some(flags) = short(bytes, big_endian, 8)?.filter(|flags| flags.len() == 8) else {
        return Ok(None);
    };
    let flags = word(&flags, big_endian);
    let (class, complex) = (flags & 0xff, flags & 0x0800 != 0);
    // Double and single, and whole numbers of 8 to 64 bits.
    if !(6..=15).contains(&class) || complex {
        return Ok(None);
    }
    let Some(sizes) = short(bytes, big_endian, 64)?.filter(|sizes| sizes.len() == 8) else {
        return Ok(None);
    };
    let [rows, columns] = [0, 4].map(|at| u64::from(word(&sizes[at..], big_endian)));
    let Some(name) = short(bytes, big_endian, LONGEST_NAME)? else {
        return Ok(None);
    };
    let (code, size, in_tag) = tag(bytes, big_endian)?;
    let Some(number) = Number::from_code(code) else {
        return Ok(None);
    };
    let count = rows.checked_mul(columns).filter(|count| *count > 0);
    let expected = count.and_then(|count| count.checked_mul(number.bytes() as u64));
    if expected != Some(u64::from(size)) {
        return Ok(None);
    }
    let variable = Variable {
        name: String::from_utf8_lossy(&name).into_owned(),
        rows,
        columns,
        offset,
        number,
    };
    Ok(Some((
        variable,
        in_tag.map(|bytes| bytes[..size as usize].to_vec()),
    )))
}

/// The bytes of the numbers of a variable.
fn numbers(path: &Path, big_endian: bool, of: &Variable) -> Result<Bytes, Error> {
    let changed = || damaged(path, "it changes while it is read");
    let mut bytes = element(path, big_endian, of.offset)?.ok_or_else(changed)?;
    let found = variable(&mut bytes, big_endian, of.offset).map_err(failed(path))?;
    let (_, in_tag) = found.ok_or_else(changed)?;
    Ok(in_tag.map_or(bytes, |bytes| Bytes::InTag(Cursor::new(bytes))))
}

/// The value of a variable that is one number.
fn scalar(path: &Path, big_endian: bool, variable: &Variable) -> Result<f64, Error> {
    let mut word = vec![0; variable.number.bytes()];
    let mut bytes = numbers(path, big_endian, variable)?;
    bytes.read_exact(&mut word).map_err(failed(path))?;
    Ok(variable.number.decode(&word, big_endian))
}

/// The samples of one channel.
struct Reader {
    bytes: Bytes,
    number: Number,
    big_endian: bool,
    /// Numbers per sample, and which of them is the channel's.
    stride: usize,
    pick: usize,
    buffer: Vec<u8>,
}

impl Reader {
    fn open(path: &Path, big_endian: bool, of: &Variable, place: &Place) -> Result<Self, Error> {
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

struct MatSamples {
    path: PathBuf,
    time: Option<Reader>,
    channels: Vec<Reader>,
    left: u64,
}

impl Samples for MatSamples {
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f32>],
    ) -> Result<usize, Error> {
        let samples = most.min(usize::try_from(self.left).unwrap_or(usize::MAX));
        self.left -= samples as u64;
        if let Some(time) = &mut self.time {
            time.read(samples, |t| times.push(t))
                .map_err(failed(&self.path))?;
        }
        for (reader, channel) in self.channels.iter_mut().zip(channels) {
            let put = |x| channel.push(x as f32);
            reader.read(samples, put).map_err(failed(&self.path))?;
        }
        Ok(samples)
    }
}
