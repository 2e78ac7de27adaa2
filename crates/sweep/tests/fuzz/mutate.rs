//! Texts are broken: bytes, words, numbers, lines, and pieces of other texts.

use crate::random::Random;
use crate::trial::Mutate;
use std::ops::Range;

/// Bytes of a file at most.
const LONGEST: usize = 1 << 14;

/// Numbers at the ends of something.
const NUMBERS: &[&str] = &[
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "0.1",
    "100",
    "1000000",
    "1000001",
    "1e9",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e999",
    "nan",
    ".nan",
    "inf",
    ".inf",
    "-.inf",
    "0x10",
    "0o7",
    "1_000",
    "1e",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "12345678901234567890123456789",
    "١",
];

/// What means something to YAML and JSON.
const MARKS: &[&str] = &[
    "&a ",
    "*a",
    "<<: *a",
    "!!binary ",
    "!!str ",
    "!!int ",
    "!x ",
    "---\n",
    "...\n",
    "%YAML 1.2\n",
    "|\n",
    ">\n",
    "|-2\n",
    "? ",
    "- ",
    "{",
    "}",
    "[",
    "]",
    "[[[[[[[[",
    "{a: ",
    "~",
    "null",
    "true",
    "yes",
    "\t",
    "#",
    "''",
    "'",
    "\"",
    "\"\\u0000\"",
    "\"\\ud800\"",
    "\"\\x",
    "\u{feff}",
    "\0",
    ": ",
    ", ",
    "é",
    "\u{2028}",
    "\r\n",
    "*",
    ".",
    "..",
    "",
];

/// Units, right and wrong ones.
const UNITS: &[&str] = &[
    "mm",
    "m",
    "um",
    "rpm",
    "rad/s",
    "Hz",
    "kHz",
    "MPa",
    "Pa",
    "bar",
    "deg",
    "%",
    "kg",
    "GN/m^1.5",
    "N s/m",
    "kg m^2",
    "N m",
    "N m s",
    "s",
    "psi",
    "psig",
    "g",
    "m/s^2",
    "m^-1e9",
    "N/m^1.5^2",
    "m/m/m",
    "/",
];

/// Breaks files of one kind.
pub struct Mutator {
    /// Words that mean something there.
    words: Vec<String>,
}

impl Mutator {
    pub fn new(words: Vec<String>) -> Self {
        Self { words }
    }

    fn once(&self, bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
        match random.below(14) {
            0 => byte(bytes, random),
            1 | 2 => self.replace(bytes, token(bytes, random), random),
            3 => number(bytes, random),
            4 | 5 => {
                let piece = other[token(other, random)].to_vec();
                let at = token(bytes, random);
                bytes.splice(at, piece);
            }
            6 => {
                let at = token(bytes, random).start;
                self.replace(bytes, at..at, random);
            }
            7 => drop(bytes.splice(line(bytes, random), [])),
            8 => {
                let (from, at) = (line(bytes, random), line(bytes, random).start);
                let piece = bytes[from].to_vec();
                bytes.splice(at..at, piece);
            }
            9 => {
                let (from, at) = (lines(other, random), line(bytes, random).start);
                bytes.splice(at..at, other[from].to_vec());
            }
            10 => drop(bytes.splice(lines(bytes, random), other[lines(other, random)].to_vec())),
            11 => indent(bytes, random),
            12 => repeat(bytes, random),
            _ => bytes.truncate(random.below(bytes.len() + 1)),
        }
    }

    /// Puts something that means something in the place of `at`.
    fn replace(&self, bytes: &mut Vec<u8>, at: Range<usize>, random: &mut Random) {
        let piece = match random.below(4) {
            0 if !self.words.is_empty() => random.pick(&self.words),
            1 => *random.pick(NUMBERS),
            2 => *random.pick(MARKS),
            _ => *random.pick(UNITS),
        };
        bytes.splice(at, piece.bytes());
    }
}

impl Mutate for Mutator {
    fn mutate(&self, file: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
        let mut bytes = file.to_vec();
        loop {
            self.once(&mut bytes, other, random);
            bytes.truncate(LONGEST);
            if random.below(2) == 0 {
                return String::from_utf8_lossy(&bytes).into_owned().into_bytes();
            }
        }
    }
}

/// A byte becomes another, goes, or comes.
pub fn byte(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len());
    let new = random.below(256) as u8;
    match (random.below(3), bytes.get_mut(at)) {
        (0, Some(old)) => *old = new,
        (1, Some(_)) => drop(bytes.remove(at)),
        _ => bytes.insert(at, new),
    }
}

/// A number, if there is one after a random place, becomes another.
fn number(bytes: &mut Vec<u8>, random: &mut Random) {
    let from = random.below(bytes.len());
    let digit = bytes[from..].iter().position(u8::is_ascii_digit);
    let Some(start) = digit.map(|at| from + at) else {
        return;
    };
    let part = |byte: &u8| byte.is_ascii_digit() || b".e".contains(byte);
    let length = bytes[start..].iter().take_while(|byte| part(byte)).count();
    bytes.splice(start..start + length, random.pick(NUMBERS).bytes());
}

/// The word at a random place.
fn token(bytes: &[u8], random: &mut Random) -> Range<usize> {
    let at = random.below(bytes.len());
    let part = |byte: &&u8| byte.is_ascii_alphanumeric() || b"_.-+^/%".contains(byte);
    let before = bytes[..at].iter().rev().take_while(part).count();
    let after = bytes[at..].iter().take_while(part).count();
    at - before..at + after
}

/// The line at a random place, with its end.
fn line(bytes: &[u8], random: &mut Random) -> Range<usize> {
    let at = random.below(bytes.len());
    let before = bytes[..at]
        .iter()
        .rev()
        .take_while(|byte| **byte != b'\n')
        .count();
    let after = bytes[at..].iter().position(|byte| *byte == b'\n');
    at - before..after.map_or(bytes.len(), |after| at + after + 1)
}

/// A few lines.
fn lines(bytes: &[u8], random: &mut Random) -> Range<usize> {
    let (one, other) = (line(bytes, random), line(bytes, random));
    let (first, last) = if one.start < other.start {
        (one, other)
    } else {
        (other, one)
    };
    match last.end - first.start {
        0..=1000 => first.start..last.end,
        _ => first,
    }
}

/// A line moves to the right or to the left.
fn indent(bytes: &mut Vec<u8>, random: &mut Random) {
    let start = line(bytes, random).start;
    let spaces = bytes[start..]
        .iter()
        .take_while(|byte| **byte == b' ')
        .count();
    bytes.splice(start..start + spaces, vec![b' '; random.below(spaces + 5)]);
}

/// A piece stands there many times.
fn repeat(bytes: &mut Vec<u8>, random: &mut Random) {
    let start = random.below(bytes.len());
    let end = bytes.len().min(start + 1 + random.below(32));
    let piece = bytes[start..end].repeat(1 << random.below(9));
    bytes.splice(start..end, piece);
}
