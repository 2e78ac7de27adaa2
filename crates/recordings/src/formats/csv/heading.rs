//! What stands before the rows of a table: names of the columns, perhaps their units in a line of their own, and
//! before those what a data logger says of itself.

use super::cells::{number, separator, texts};
use super::date::{day, nanoseconds};
use super::labview;
use super::lines::Lines;
use super::stated_rate::StatedLines;
use crate::Error;
use crate::measured::{StatedRate, is_unit};
use std::path::Path;

/// Lines within which the table begins.
const MOST_LINES: u64 = 1000;

/// A table, with the file at its first row.
pub(super) struct Heading {
    pub lines: Lines,
    pub separator: u8,
    /// Names of the columns, with the units in brackets where they have a line of their own.
    pub names: Vec<String>,
    /// The sample rate that a line before the table states.
    pub sample_rate: Option<StatedRate>,
    /// What stands there about a sample rate and is not understood.
    pub unclear_rate: Option<String>,
    /// Whether it is a LabVIEW measurement file.
    pub is_labview: bool,
}

/// Where the names stand, and the first row.
struct Found {
    names: u64,
    row: u64,
    units: Option<Vec<String>>,
    stated: StatedLines,
}

impl Heading {
    /// Reads the heading of a file; its first `skipped` lines are not looked at. The names are the last line without a number
    /// before the first row that has as many cells (but for a separator at the end) and begins with a number or a time. Where there is none such, they are the first line, or there are none.
    ///
    /// # Errors
    /// A file that cannot be read or has no rows.
    pub fn read(path: &Path, skipped: u64) -> Result<Self, Error> {
        let mut lines = after(path, skipped)?;
        let damaged = |reason| Err(Error::damaged("CSV", path, reason));
        if !lines.advance_to_text()? {
            return damaged("it has no lines of numbers");
        }
        if labview::is_one(&lines.line) {
            return labview::heading(lines);
        }
        let found = find(path, skipped)?;
        if let Some(found) = &found {
            while lines.number < found.names && lines.advance()? {}
        }
        let separator = separator(&lines.line);
        let first = texts(&lines.line, separator);
        let is_number = |cell: &String| !cell.is_empty() && number(cell.as_bytes()).is_some();
        if first.iter().all(is_number) {
            return Ok(Self {
                lines,
                separator,
                names: (1..=first.len()).map(|i| format!("column_{i}")).collect(),
                sample_rate: None,
                unclear_rate: None,
                is_labview: false,
            });
        }
        let mut names = first;
        if let Some(units) = found.as_ref().and_then(|found| found.units.as_ref()) {
            for (name, unit) in names.iter_mut().zip(units) {
                if !unit.is_empty() {
                    *name = format!("{name} [{unit}]");
                }
            }
        }
        loop {
            if !lines.advance_to_text()? {
                return damaged("it has names of columns and no rows");
            }
            if found.as_ref().is_none_or(|found| lines.number >= found.row) {
                break;
            }
        }
        let (sample_rate, unclear_rate) = found.map(|found| found.stated.rate()).unwrap_or_default();
        Ok(Self {
            lines,
            separator,
            names,
            sample_rate,
            unclear_rate,
            is_labview: false,
        })
    }
}

/// The lines of a file after its first.
fn after(path: &Path, skipped: u64) -> Result<Lines, Error> {
    let mut lines = Lines::open(path)?;
    while lines.number < skipped && lines.advance()? {}
    Ok(lines)
}

/// Where a table with names begins; none where no line without numbers stands right before one of as many cells that
/// has some.
fn find(path: &Path, skipped: u64) -> Result<Option<Found>, Error> {
    let mut lines = after(path, skipped)?;
    let mut stated = StatedLines::default();
    // The last two lines of text: their number and cells.
    let mut before: [Option<(u64, Vec<String>)>; 2] = [None, None];
    while lines.number < skipped + MOST_LINES && lines.advance()? {
        stated.add(lines.number, &lines.line);
        if lines.is_blank() {
            continue;
        }
        let separator = separator(&lines.line);
        let cells = texts(&lines.line, separator);
        let is_number = |cell: &String| !cell.is_empty() && number(cell.as_bytes()).is_some();
        let has_numbers = cells.iter().any(is_number);
        // What a logger says of itself begins with a word.
        let begins = cells.first().is_some_and(|cell| {
            let dated = |cell: &[u8]| nanoseconds(cell).or_else(|| day(cell)).is_some();
            cell.is_empty() || is_number(cell) || dated(cell.as_bytes())
        });
        if let Some((names, last)) = &before[1]
            && has_numbers
            && begins
            && go_together(last, &cells)
        {
            let row = lines.number;
            let above = before[0].as_ref().filter(|(_, above)| above.len() == last.len());
            let found = match above.filter(|_| last.iter().any(|cell| is_unit(cell))) {
                Some((names, _)) => Found {
                    names: *names,
                    row,
                    units: Some(last.iter().map(|unit| bare(unit).to_owned()).collect()),
                    stated,
                },
                None => Found {
                    names: *names,
                    row,
                    units: None,
                    stated,
                },
            };
            return Ok(Some(found));
        }
        before.swap(0, 1);
        before[1] = (!has_numbers).then_some((lines.number, cells));
    }
    Ok(None)
}

/// Whether these are names and a row of the same table: either may end in a separator more.
fn go_together(names: &[String], row: &[String]) -> bool {
    let ends_empty = |cells: &[String]| cells.last().is_some_and(String::is_empty);
    names.len() == row.len()
        || names.len() + 1 == row.len() && ends_empty(row)
        || names.len() == row.len() + 1 && ends_empty(names)
}

/// A unit without its brackets.
fn bare(unit: &str) -> &str {
    let inside = |open, close| unit.strip_prefix(open)?.strip_suffix(close);
    inside('[', ']').or_else(|| inside('(', ')')).unwrap_or(unit).trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heading(text: &str) -> (Vec<String>, u64, Option<f64>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::fs::write(&path, text).unwrap();
        let heading = Heading::read(&path, 0).unwrap();
        let rate = heading.sample_rate.map(|stated| stated.hz);
        (heading.names, heading.lines.number, rate)
    }

    #[test]
    fn what_a_logger_says_of_itself_is_no_table() {
        let logger = "Device: ABC\nDate;2026-01-01\nChannels;2\nSampling rate;2 kHz\n\nZeit;Beschl\ns;g\n0,1;2\n0,2;3\n";
        let expected = ["Zeit [s]", "Beschl [g]"].map(String::from).to_vec();
        assert_eq!(heading(logger), (expected, 8, Some(2000.0)));
        let plain = "a,b\n1,2\n3,4\n";
        let expected = ["a", "b"].map(String::from).to_vec();
        assert_eq!(heading(plain), (expected, 2, None));
        // Columns that are called by numbers.
        let numbered = "t,1,2\n0,5,6\n1,5,6\n";
        let expected = ["t", "1", "2"].map(String::from).to_vec();
        assert_eq!(heading(numbered), (expected, 2, None));
        let bare = "1,2\n3,4\n";
        let expected = ["column_1", "column_2"].map(String::from).to_vec();
        assert_eq!(heading(bare), (expected, 1, None));
    }
}
