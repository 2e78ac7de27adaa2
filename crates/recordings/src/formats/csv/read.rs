//! Columns of numbers from CSV, a line at a time.
//!
//! - The columns are separated by commas, semicolons or tabs. Where commas do not separate, they may be the decimal
//!   sign.
//! - The first line has their names, with the unit in brackets or at the end (`acc [m/s^2]`, `acc_m_s2`). A file
//!   without names has the columns `column_1`, `column_2`, ... Lines before it that are empty or begin with `#` are
//!   skipped.
//! - An empty cell is a missing sample, and so is an empty line within a single column.
//! - A column that does not begin with a number is left out.

use crate::Error;
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, TimeColumn, name_and_unit,
    seconds_per_unit, selected,
};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// A longer line does not belong to a table.
const LONGEST_LINE: u64 = 1 << 20;

/// More columns than a table of channels has.
const MOST_COLUMNS: usize = 1 << 12;

/// Bytes that are read at a time.
const BUFFER: usize = 1 << 18;

struct Lines {
    path: PathBuf,
    file: BufReader<File>,
    line: Vec<u8>,
    /// Number of the line, from 1.
    number: u64,
}

struct CsvSamples {
    lines: Lines,
    separator: u8,
    columns: usize,
    /// For each column where its numbers go.
    targets: Vec<Target>,
    names: Vec<String>,
    /// Whether the line that was read last is the next row.
    held: bool,
    /// Empty lines before it that are missing samples: those within a single column.
    empty: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Nowhere,
    Time,
    Channel(usize),
}

/// Opens a file.
pub(crate) fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let mut lines = Lines::open(path)?;
    let separator = loop {
        if !lines.advance()? {
            return Err(damaged(path, "it has no lines of numbers"));
        }
        if !lines.is_blank() {
            break separator(&lines.line);
        }
    };
    let first: Vec<String> = cells(&lines.line, separator)
        .map(|cell| String::from_utf8_lossy(cell).trim().to_owned())
        .collect();
    if first.len() > MOST_COLUMNS {
        return Err(damaged(path, format!("it has {} columns", first.len())));
    }
    let headless = first
        .iter()
        .all(|cell| !cell.is_empty() && number(cell.as_bytes(), separator).is_some());
    let names: Vec<String> = if headless {
        (1..=first.len()).map(|i| format!("column_{i}")).collect()
    } else {
        first
    };
    if !headless {
        loop {
            if !lines.advance()? {
                return Err(damaged(path, "it has names of columns and no rows"));
            }
            if !lines.is_blank() {
                break;
            }
        }
    }
    let numeric: Vec<bool> = cells(&lines.line, separator)
        .map(|cell| number(cell, separator).is_some())
        .chain(std::iter::repeat(true))
        .take(names.len())
        .collect();
    let headings: Vec<(String, Option<String>)> = names.iter().map(|n| name_and_unit(n)).collect();
    let scale = |(name, unit): &(String, Option<String>)| seconds_per_unit(name, unit.as_deref());
    let time = (0..names.len()).find(|&i| numeric[i] && scale(&headings[i]).is_some());
    let candidates: Vec<usize> = (0..names.len())
        .filter(|&i| numeric[i] && Some(i) != time)
        .collect();
    let all: Vec<MeasuredChannel> = candidates
        .iter()
        .map(|&i| MeasuredChannel {
            column: names[i].clone(),
            name: headings[i].0.clone(),
            unit: headings[i].1.clone(),
        })
        .collect();
    if all.is_empty() {
        return Err(damaged(path, "it has no column of numbers"));
    }
    let wanted = selected(&all, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| all[i].clone()).collect();
    let mut targets = vec![Target::Nowhere; names.len()];
    for (channel, &i) in wanted.iter().enumerate() {
        targets[candidates[i]] = Target::Channel(channel);
    }
    let time = time.map(|i| {
        targets[i] = Target::Time;
        TimeColumn {
            name: names[i].clone(),
            seconds_per_unit: scale(&headings[i]).unwrap_or(1.0),
            single_precision: false,
        }
    });
    let samples = CsvSamples {
        lines,
        separator,
        columns: names.len(),
        targets,
        names,
        held: true,
        empty: 0,
    };
    let count = channels.len();
    MeasuredFile::of_one(channels, Vec::new(), |labels| {
        Recording::new(path, labels, count, options.sample_rate_hz, time, samples)
    })
}

fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("CSV", path, reason)
}

impl Lines {
    fn open(path: &Path) -> Result<Self, Error> {
        let file = files::open(path).map_err(Error::io("open", path))?;
        let mut lines = Self {
            path: path.to_owned(),
            file: BufReader::with_capacity(BUFFER, file),
            line: Vec::new(),
            number: 0,
        };
        let start = lines.file.fill_buf().map_err(Error::io("read", path))?;
        if start.starts_with(b"\xef\xbb\xbf") {
            lines.file.consume(3);
        }
        Ok(lines)
    }

    /// Reads the next line, without its end; false at the end of the file.
    fn advance(&mut self) -> Result<bool, Error> {
        self.line.clear();
        let read = (&mut self.file)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut self.line);
        let read = read.map_err(Error::io("read", &self.path))?;
        if read == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.line.last() == Some(&b'\n') {
            self.line.pop();
            if self.line.last() == Some(&b'\r') {
                self.line.pop();
            }
        } else if read as u64 == LONGEST_LINE {
            let reason = format!("line {} is longer than {LONGEST_LINE} bytes", self.number);
            return Err(damaged(&self.path, reason));
        }
        Ok(true)
    }

    fn is_blank(&self) -> bool {
        let text = self.line.trim_ascii();
        text.is_empty() || text.starts_with(b"#")
    }
}

/// The separator that occurs most often outside quotation marks; semicolons and tabs before commas,
/// which may be decimal signs.
fn separator(line: &[u8]) -> u8 {
    let count = |separator: u8| cells(line, separator).count();
    [b';', b'\t']
        .into_iter()
        .find(|&separator| count(separator) > 1)
        .unwrap_or(b',')
}

/// The cells of a line; quotation marks around a cell are taken off.
fn cells(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    let mut quoted = false;
    let split = line.split(move |&byte| {
        if byte == b'"' {
            quoted = !quoted;
        }
        byte == separator && !quoted
    });
    split.map(|cell| {
        let cell = cell.trim_ascii();
        let inside = cell.strip_prefix(b"\"").and_then(|c| c.strip_suffix(b"\""));
        inside.unwrap_or(cell).trim_ascii()
    })
}

/// The number in a cell, NaN in an empty one; none where something else stands there.
fn number(cell: &[u8], separator: u8) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    let text = std::str::from_utf8(cell).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    if separator != b',' && text.contains(',') && !text.contains('.') {
        return text.replacen(',', ".", 1).parse().ok();
    }
    None
}

impl CsvSamples {
    fn row(&mut self, times: &mut Vec<f64>, channels: &mut [Vec<f32>]) -> Result<(), Error> {
        let mut found = 0;
        for cell in cells(&self.lines.line, self.separator) {
            let target = self.targets.get(found).copied().unwrap_or(Target::Nowhere);
            found += 1;
            if target == Target::Nowhere {
                continue;
            }
            let Some(number) = number(cell, self.separator) else {
                let text: String = String::from_utf8_lossy(cell).chars().take(40).collect();
                return Err(damaged(
                    &self.lines.path,
                    format!(
                        "line {}, column `{}`: found `{text}`, expected a number",
                        self.lines.number,
                        self.names[found - 1]
                    ),
                ));
            };
            match target {
                Target::Time => times.push(number),
                Target::Channel(channel) => channels[channel].push(number as f32),
                Target::Nowhere => {}
            }
        }
        if found == self.columns {
            return Ok(());
        }
        let reason = format!(
            "line {} has {found} cells where the first has {}",
            self.lines.number, self.columns
        );
        Err(damaged(&self.lines.path, reason))
    }
}

impl Samples for CsvSamples {
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f32>],
    ) -> Result<usize, Error> {
        let mut rows = 0;
        while rows < most {
            if !std::mem::take(&mut self.held) && !self.lines.advance()? {
                break;
            }
            if self.lines.is_blank() {
                self.empty += u64::from(self.columns == 1 && self.lines.line.is_empty());
                continue;
            }
            if self.empty > 0 {
                self.empty -= 1;
                self.held = true;
                channels.iter_mut().for_each(|c| c.push(f32::NAN));
            } else {
                self.row(times, channels)?;
            }
            rows += 1;
        }
        Ok(rows)
    }
}
