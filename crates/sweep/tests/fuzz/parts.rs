//! Files of recordings are broken by their parts: chunks, elements, records, lines, each with the field that says how
//! long it is. After a change the field says the new length, most times, so that a trial gets past the heading.

use crate::mutate::byte;
use crate::random::Random;
use crate::trial::Mutate;
use std::ops::Range;

/// Bytes of a file at most.
const LONGEST: usize = 1 << 14;

/// Bytes of a number at the end of something, little-endian.
const NUMBERS: [u64; 12] = [
    0,
    1,
    2,
    7,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    u64::MAX >> 1,
    u64::MAX,
];

/// A part of a file.
#[derive(Clone, Debug)]
pub struct Part {
    /// All of it, its heading included.
    whole: Range<usize>,
    /// What the field counts.
    body: Range<usize>,
    length: Option<Field>,
}

/// A number that says how long a part is.
#[derive(Clone, Debug)]
struct Field {
    at: usize,
    bytes: usize,
    big_endian: bool,
}

/// The parts of a file, parts within parts included; none where it is too broken.
pub type Split = fn(&[u8]) -> Vec<Part>;

impl Field {
    /// The field after a change behind `from` of a file of `before` bytes, which now has `after`.
    fn moved(&self, from: usize, before: usize, after: usize) -> Self {
        let at = match self.at < from {
            true => self.at,
            false => (self.at + after).saturating_sub(before),
        };
        Self { at, ..self.clone() }
    }

    fn write(&self, file: &mut [u8], value: u64) {
        let mut bytes = value.to_le_bytes();
        let bytes = &mut bytes[..self.bytes];
        if self.big_endian {
            bytes.reverse();
        }
        if let Some(place) = file.get_mut(self.at..self.at + self.bytes) {
            place.copy_from_slice(bytes);
        }
    }
}

/// Breaks files that are split so.
pub struct Parts(pub Split);

impl Mutate for Parts {
    fn mutate(&self, file: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
        let mut file = file.to_vec();
        loop {
            self.once(&mut file, other, random);
            file.truncate(LONGEST);
            if random.below(2) == 0 {
                return file;
            }
        }
    }
}

impl Parts {
    fn once(&self, file: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        let parts = (self.0)(file);
        let others = (self.0)(other);
        if parts.is_empty() || others.is_empty() || random.below(8) == 0 {
            return bytes(file, 0..file.len(), random);
        }
        let part = random.pick(&parts).clone();
        match random.below(6) {
            0 => drop(file.splice(part.whole, [])),
            1 => {
                let at = random.pick(&parts).whole.start;
                let copy = file[part.whole].to_vec();
                drop(file.splice(at..at, copy));
            }
            2 => drop(file.splice(
                part.whole,
                other[random.pick(&others).whole.clone()].to_vec(),
            )),
            3 => match &part.length {
                Some(field) => field.write(file, *random.pick(&NUMBERS)),
                None => bytes(file, part.body, random),
            },
            _ => {
                let before = file.len();
                bytes(file, part.body.clone(), random);
                if let Some(field) = part.length.filter(|_| random.below(8) > 0) {
                    let grown = (part.body.len() + file.len()).saturating_sub(before);
                    field
                        .moved(part.body.start, before, file.len())
                        .write(file, grown as u64);
                }
            }
        }
    }
}

/// Changes a few bytes within a range.
fn bytes(file: &mut Vec<u8>, range: Range<usize>, random: &mut Random) {
    let mut piece = file[range.clone()].to_vec();
    let at = random.below(piece.len());
    match random.below(5) {
        0 => byte(&mut piece, random),
        1 => {
            if let Some(byte) = piece.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
        2 => {
            let width = 1 << random.below(4);
            let mut number = random.pick(&NUMBERS).to_le_bytes()[..width].to_vec();
            if random.below(4) == 0 {
                number.reverse();
            }
            let end = piece.len().min(at + width);
            drop(piece.splice(at..end, number));
        }
        3 => {
            let end = piece.len().min(at + 1 + random.below(16));
            let copy = piece[at..end].repeat(1 << random.below(6));
            drop(piece.splice(at..end, copy));
        }
        _ => piece.truncate(at),
    }
    drop(file.splice(range, piece));
}

fn number(file: &[u8], at: usize, bytes: usize, big_endian: bool) -> Option<usize> {
    let mut word = [0; 8];
    word[..bytes].copy_from_slice(file.get(at..at + bytes)?);
    if big_endian {
        word[..bytes].reverse();
    }
    usize::try_from(u64::from_le_bytes(word)).ok()
}

/// Parts that follow each other in `range`: an identifier of so many bytes, a length, and that many bytes, up to a
/// multiple of `aligned`. One that says that it is longer than what is left ends there.
fn tagged(
    file: &[u8],
    range: Range<usize>,
    identifier: usize,
    field: (usize, bool),
    aligned: usize,
) -> Vec<Part> {
    let (width, big_endian) = field;
    let mut parts = Vec::new();
    let mut start = range.start;
    while let Some(length) = number(file, start + identifier, width, big_endian) {
        let body = start + identifier + width;
        if body > range.end {
            break;
        }
        let end = body.saturating_add(length).min(range.end);
        let whole = end.next_multiple_of(aligned).min(range.end);
        parts.push(Part {
            whole: start..whole,
            body: body..end,
            length: Some(Field {
                at: start + identifier,
                bytes: width,
                big_endian,
            }),
        });
        start = whole;
    }
    parts
}

/// The lines of a text.
pub fn lines(file: &[u8]) -> Vec<Part> {
    let mut start = 0;
    let line = |line: &[u8]| {
        let whole = start..start + line.len();
        start = whole.end;
        Part {
            body: whole.clone(),
            whole,
            length: None,
        }
    };
    file.split_inclusive(|byte| *byte == b'\n')
        .map(line)
        .collect()
}

/// The chunks of RIFF.
pub fn riff(file: &[u8]) -> Vec<Part> {
    tagged(file, 12..file.len(), 4, (4, false), 2)
}

/// The elements of a MAT file, and those within arrays that are not compressed.
pub fn mat(file: &[u8]) -> Vec<Part> {
    let big_endian = file.get(126..128) == Some(b"MI");
    let mut parts = tagged(file, 128..file.len(), 4, (4, big_endian), 8);
    let arrays: Vec<Part> = parts.clone();
    for array in arrays {
        if number(file, array.whole.start, 4, big_endian) == Some(14) {
            parts.extend(tagged(file, array.body, 4, (4, big_endian), 8));
        }
    }
    parts
}

/// The blocks of HDF5: each begins with its signature and ends at the next one.
pub fn hdf5(file: &[u8]) -> Vec<Part> {
    const SIGNATURES: [&[u8]; 14] = [
        b"OHDR", b"OCHK", b"TREE", b"SNOD", b"HEAP", b"GCOL", b"FRHP", b"FHDB", b"FHIB", b"BTHD",
        b"BTLF", b"FAHD", b"EAHD", b"EAIB",
    ];
    let begins = |at: &usize| {
        SIGNATURES
            .iter()
            .any(|signature| file[*at..].starts_with(signature))
    };
    let starts: Vec<usize> = (0..file.len()).filter(begins).collect();
    let ends = starts.iter().skip(1).copied().chain([file.len()]);
    let part = |(start, end): (&usize, usize)| Part {
        whole: *start..end,
        body: *start + 4..end,
        length: None,
    };
    starts.iter().zip(ends).map(part).collect()
}

/// The records of MCAP, and those within chunks that are not compressed.
pub fn mcap(file: &[u8]) -> Vec<Part> {
    let mut parts = tagged(file, 8..file.len(), 1, (8, false), 1);
    let chunks: Vec<Part> = parts.clone();
    for chunk in chunks {
        // Times, length and checksum of 28 bytes; name of the compression, empty where there is none; length.
        let start = chunk.body.start + 28;
        if file.get(chunk.whole.start) == Some(&6) && number(file, start, 4, false) == Some(0) {
            let start = (start + 12).min(chunk.body.end);
            parts.extend(tagged(file, start..chunk.body.end, 1, (8, false), 1));
        }
    }
    parts
}

/// The footer of Parquet, the more often, and what stands before it.
pub fn parquet(file: &[u8]) -> Vec<Part> {
    let Some(at) = file.len().checked_sub(8) else {
        return Vec::new();
    };
    let length = number(file, at, 4, false).unwrap_or(0).min(at);
    let (footer, pages) = (at - length..at, 4.min(at - length)..at - length);
    let part = |body: Range<usize>, length| Part {
        whole: body.clone(),
        body,
        length,
    };
    let field = Field {
        at,
        bytes: 4,
        big_endian: false,
    };
    let footer = part(footer, Some(field));
    vec![footer.clone(), footer, part(pages, None)]
}
