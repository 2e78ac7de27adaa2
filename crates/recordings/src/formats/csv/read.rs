//! Columns of numbers from CSV, a line at a time.
//!
//! - The columns are separated by commas, semicolons or tabs. Where commas do not separate, or a number stands in quotation
//!   marks, they may be the decimal sign. A table whose numbers have both signs is refused, because one of them may set
//!   thousands apart.
//! - The line before the first row has their names, with the unit in brackets or at the end (`acc [m/s^2]`, `acc_m_s2`), or in
//!   a line of its own between. A file without names has the columns `column_1`, `column_2`, ... What a data logger writes
//!   before is skipped but for the sample rate.
//! - The time is the column that is called so, the first one where its unit is one of time, or the first that holds dates or
//!   times of day. A column of days may stand before one of times of day.
//! - An empty cell is a missing sample, and so are `Overload`, `OVL`, `--`, `#N/A` and the like, and an empty line within a
//!   single column.
//! - Rows may end in a separator more than the heading, or less.
//! - A LabVIEW measurement file has its own heading (`labview.rs`).
//! - A column without a name (row numbers) is left out, and one that does not begin with a number. One whose heading has a unit
//!   has to.

use super::cells::{cells, is_missing, number};
use super::date::{day, nanoseconds, time_of_day};
use super::heading::Heading;
use super::labview;
use super::lines::Lines;
use super::written_number::{Written, written_number};
use crate::Error;
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, StatedRate, TimeColumn, TimeUnit, is_unit,
    name_and_unit, seconds_of_unit, selected, time_unit,
};
use std::collections::VecDeque;
use std::path::Path;

/// More columns than a table of channels has.
const MOST_COLUMNS: usize = 1 << 12;

/// Samples with a line of their own that are remembered: those of more than a block.
const MOST_JUMPS: usize = 1 << 16;

struct CsvSamples {
    lines: Lines,
    separator: u8,
    is_labview: bool,
    columns: usize,
    /// For each column where its numbers go.
    targets: Vec<Target>,
    names: Vec<String>,
    /// Whether the line that was read last is the next row.
    held: bool,
    /// Empty lines before it that are missing samples: those within a single column.
    empty: u64,
    /// The day of the row, ns since 1970; 0 where no column has it.
    day: i64,
    /// The first of the dates, ns.
    start: Option<i64>,
    /// Samples read so far.
    read: u64,
    /// Samples that do not stand in the line after that of the one before, with their lines: the last of them.
    jumps: VecDeque<(u64, u64)>,
    /// The first number with a decimal sign.
    decimal: Option<Decimal>,
}

/// A number with a decimal sign, and where it stands.
struct Decimal {
    sign: u8,
    line: u64,
    column: usize,
    number: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Nowhere,
    Time,
    Day,
    Date,
    Channel(usize),
}

/// Opens a file.
pub(crate) fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let Heading {
        lines,
        separator,
        names,
        sample_rate,
        unclear_rate,
        is_labview,
    } = Heading::read(path, options.skipped_lines)?;
    if names.len() > MOST_COLUMNS {
        return Err(damaged(path, format!("it has {} columns", names.len())));
    }
    // A longer row is an error once it is read.
    let row: Vec<&[u8]> = cells(&lines.line, separator).take(names.len()).collect();
    let numeric: Vec<bool> = row
        .iter()
        .map(|cell| number(cell).is_some())
        .chain(std::iter::repeat(true))
        .take(names.len())
        .collect();
    let headings: Vec<(String, Option<String>)> = names.iter().map(|n| name_and_unit(n)).collect();
    let time = time_column(&headings, &numeric, &row);
    let index = time.as_ref().map(|(index, _)| *index);
    // What its heading gives a unit is numbers; where it begins with something else, reading it says so.
    let is_quantity = |i: usize| numeric[i] || headings[i].1.as_deref().is_some_and(is_unit);
    let candidates: Vec<usize> = (0..names.len())
        .filter(|&i| is_quantity(i) && Some(i) != index && !names[i].is_empty())
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
    let said = options.sample_rate_hz.map(StatedRate::number);
    let stated = said.or(sample_rate);
    let time = time.map(|(i, time)| {
        let (target, unit) = match time {
            Time::Number(unit) => (Target::Time, unit),
            Time::Date => {
                if let Some(day) = day_column(&row, i) {
                    targets[day] = Target::Day;
                }
                (Target::Date, TimeUnit::Seconds(1.0))
            }
        };
        targets[i] = target;
        TimeColumn {
            name: names[i].clone(),
            unit,
            single_precision: false,
        }
    });
    let samples = CsvSamples {
        lines,
        separator,
        is_labview,
        columns: names.len(),
        targets,
        names,
        held: true,
        empty: 0,
        day: 0,
        start: None,
        read: 0,
        jumps: VecDeque::new(),
        decimal: None,
    };
    let count = channels.len();
    MeasuredFile::of_one(channels, Vec::new(), |labels| {
        let recording = Recording::new(path, labels, count, stated, time, samples)?;
        Ok(recording.with_unclear_rate(unclear_rate))
    })
}

fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("CSV", path, reason)
}

/// What a column of time holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Time {
    /// Numbers in a unit.
    Number(TimeUnit),
    /// Dates or times of day.
    Date,
}

/// The column of time: one that is called so, the first one where its unit is one of time, or the first that holds dates or times of day. A
/// quantity that is measured has another unit.
fn time_column(
    headings: &[(String, Option<String>)],
    numeric: &[bool],
    row: &[&[u8]],
) -> Option<(usize, Time)> {
    let called = |i: usize| {
        let (name, unit) = &headings[i];
        time_unit(name, unit.as_deref()).filter(|_| numeric[i])
    };
    let named = (0..headings.len()).find_map(|i| Some((i, Time::Number(called(i)?))));
    let by_unit = || {
        let unit = headings.first()?.1.as_deref()?;
        let seconds = seconds_of_unit(unit).filter(|_| numeric[0])?;
        Some((0, Time::Number(TimeUnit::Seconds(seconds))))
    };
    let dated = || {
        let at = row.iter().position(|cell| nanoseconds(cell).is_some())?;
        Some((at, Time::Date))
    };
    named.or_else(by_unit).or_else(dated)
}

/// The column of days that stands before times of day in column `time`.
fn day_column(row: &[&[u8]], time: usize) -> Option<usize> {
    time_of_day(row[time])?;
    row[..time].iter().position(|cell| day(cell).is_some())
}

/// A cell in which something else stands than belongs there.
fn not_a(target: Target, lines: &Lines, name: &str, cell: &[u8]) -> Error {
    let text: String = String::from_utf8_lossy(cell).chars().take(40).collect();
    let expected = match target {
        Target::Day => "a day",
        Target::Date => "a time",
        _ => "a number",
    };
    let line = lines.number;
    let reason = format!("line {line}, column `{name}`: found `{text}`, expected {expected}");
    damaged(&lines.path, reason)
}

/// Seconds from the first date to that of a cell on this day.
fn seconds(day: i64, cell: &[u8], start: &mut Option<i64>) -> Option<f64> {
    let at = day.checked_add(nanoseconds(cell)?)?;
    let start = *start.get_or_insert(at);
    Some(at.checked_sub(start)? as f64 * 1e-9)
}

/// That all numbers have one decimal sign, and that the first of them shows which. Where commas separate the cells, one in
/// quotation marks may set thousands apart. `place` is the line, the column and the separator.
fn one_sign(
    first: &mut Option<Decimal>,
    cell: &[u8],
    place: (u64, usize, u8),
    names: &[String],
) -> Result<(), String> {
    let Some(sign) = cell.iter().copied().find(|byte| b".,".contains(byte)) else {
        return Ok(());
    };
    let (line, column, separator) = place;
    let number = || String::from_utf8_lossy(cell).into_owned();
    let found = || format!("line {line}, column `{}`: found `{}`", names[column], number());
    match first {
        Some(first) if first.sign != sign => Err(format!(
            "{}, but `{}` in line {}, column `{}`: one of `,` and `.` may set thousands apart; write all numbers with the same \
             decimal sign and no sign between thousands",
            found(),
            first.number,
            first.line,
            names[first.column]
        )),
        Some(_) => Ok(()),
        None if sign == separator && may_be_thousands(cell) => Err(format!(
            "{}: its comma may be the decimal sign or set thousands apart; write numbers with a decimal point and no sign \
             between thousands, or separate the columns with semicolons",
            found()
        )),
        None => {
            let number = number();
            *first = Some(Decimal {
                sign,
                line,
                column,
                number,
            });
            Ok(())
        }
    }
}

/// Whether the comma of a number may set thousands apart.
fn may_be_thousands(cell: &[u8]) -> bool {
    let written = std::str::from_utf8(cell).ok().and_then(|text| written_number(text, true));
    matches!(written, Some((Written::Ambiguous { .. }, _)))
}

impl CsvSamples {
    /// Remembers where the next sample stands.
    fn note_line(&mut self) {
        let line = self.lines.number;
        let follows = |(sample, at): &(u64, u64)| line.checked_sub(*at) == Some(self.read - sample);
        if !self.jumps.back().is_some_and(follows) {
            self.jumps.push_back((self.read, line));
        }
        if self.jumps.len() > MOST_JUMPS {
            self.jumps.pop_front();
        }
        self.read += 1;
    }

    /// The first date, s.
    fn first_date_s(&self) -> f64 {
        self.start.map_or(0.0, |ns| ns as f64 * 1e-9)
    }

    fn row(&mut self, times: &mut Vec<f64>, channels: &mut [Vec<f64>]) -> Result<(), Error> {
        let mut found = 0;
        let mut last_is_empty = false;
        for cell in cells(&self.lines.line, self.separator) {
            last_is_empty = cell.is_empty();
            let target = self.targets.get(found).copied().unwrap_or(Target::Nowhere);
            found += 1;
            if target == Target::Nowhere {
                continue;
            }
            let number = match target {
                Target::Day => day(cell).map(|day| {
                    self.day = day;
                    0.0
                }),
                Target::Date => seconds(self.day, cell, &mut self.start),
                Target::Channel(_) if is_missing(cell) => Some(f64::NAN),
                _ => number(cell),
            };
            let Some(number) = number else {
                return Err(not_a(target, &self.lines, &self.names[found - 1], cell));
            };
            if matches!(target, Target::Time | Target::Channel(_)) {
                let path = &self.lines.path;
                let place = (self.lines.number, found - 1, self.separator);
                one_sign(&mut self.decimal, cell, place, &self.names)
                    .map_err(|reason| damaged(path, reason))?;
            }
            match target {
                Target::Time | Target::Date => times.push(number),
                Target::Channel(channel) => channels[channel].push(number),
                Target::Day | Target::Nowhere => {}
            }
        }
        let more = found == self.columns + 1 && last_is_empty;
        let fewer = found + 1 == self.columns && self.names.last().is_some_and(String::is_empty);
        if found == self.columns || more || fewer {
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
    fn origin_s(&self) -> f64 {
        self.first_date_s()
    }

    fn line(&self, sample: u64) -> Option<u64> {
        let later = self.jumps.partition_point(|(first, _)| *first <= sample);
        let (first, line) = self.jumps.get(later.checked_sub(1)?)?;
        Some(line + (sample - first))
    }

    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
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
            if self.is_labview && labview::begins_another(&self.lines.line) {
                let line = self.lines.number;
                let reason = format!("a further measurement begins in line {line}: save each to a file of its own");
                return Err(damaged(&self.lines.path, reason));
            }
            if self.empty > 0 {
                self.empty -= 1;
                self.held = true;
                channels.iter_mut().for_each(|c| c.push(f64::NAN));
            } else {
                self.row(times, channels)?;
            }
            self.note_line();
            rows += 1;
        }
        Ok(rows)
    }
}
