//! The elements of a MAT file: its numeric variables and the bytes of their numbers.

use crate::Error;
use flate2::read::ZlibDecoder;
use std::fs::File;
use std::io::{self, BufReader, Cursor, ErrorKind, Read, Seek, SeekFrom, Take};
use std::path::Path;

/// Longest name of a variable; MATLAB's own limit is 63.
const LONGEST_NAME: u32 = 1 << 10;

/// Bytes of a channel that are read and decoded at a time.
pub(super) const BUFFER: usize = 1 << 16;

const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

/// A variable that holds real numbers.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) columns: u64,
    /// Where its element stands in the file.
    offset: u64,
    pub(super) number: Number,
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
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

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// The number in these bytes, which are as many as it has.
    pub(super) fn decode(self, bytes: &[u8], big_endian: bool) -> f64 {
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

pub(super) fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("MAT", path, reason)
}

/// An error of the operating system, or of the decoder that finds damage.
pub(super) fn failed(path: &Path) -> impl Fn(io::Error) -> Error + '_ {
    move |error| match error.kind() {
        ErrorKind::UnexpectedEof => damaged(path, "it is cut off"),
        ErrorKind::InvalidInput | ErrorKind::InvalidData => {
            damaged(path, format!("a compressed variable is damaged: {error}"))
        }
        _ => Error::io("read", path)(error),
    }
}

/// A stream of the bytes of one element.
pub(super) enum Bytes {
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
    pub(super) fn skip(&mut self, bytes: u64) -> io::Result<()> {
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
pub(super) fn scan(path: &Path) -> Result<(bool, Vec<Variable>), Error> {
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
pub(super) fn numbers(path: &Path, big_endian: bool, of: &Variable) -> Result<Bytes, Error> {
    let changed = || damaged(path, "it changes while it is read");
    let mut bytes = element(path, big_endian, of.offset)?.ok_or_else(changed)?;
    let found = variable(&mut bytes, big_endian, of.offset).map_err(failed(path))?;
    let (_, in_tag) = found.ok_or_else(changed)?;
    Ok(in_tag.map_or(bytes, |bytes| Bytes::InTag(Cursor::new(bytes))))
}

/// The value of a variable that is one number.
pub(super) fn scalar(path: &Path, big_endian: bool, variable: &Variable) -> Result<f64, Error> {
    let mut word = vec![0; variable.number.bytes()];
    let mut bytes = numbers(path, big_endian, variable)?;
    bytes.read_exact(&mut word).map_err(failed(path))?;
    Ok(variable.number.decode(&word, big_endian))
}
