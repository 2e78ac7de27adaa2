//! The heading of a LabVIEW measurement file (`.lvm`; National Instruments, *Specification for the LabVIEW Measurement File*).
//!
//! Lines of a key with a value per column, up to the names of the columns, of which the first is `X_Value`. Understood are
//! `Y_Unit_Label`, the units, and `Delta_X`, the step in time, s. The first column has the times, or is empty; further columns
//! `X_Value` repeat them. The last column, `Comment`, is left out.

use super::cells::{number, separator, texts};
use super::heading::Heading;
use super::lines::Lines;
use crate::Error;
use crate::measured::StatedRate;

/// The name of a column of times, with which the line of names begins.
const TIMES: &str = "X_Value";

/// Whether a file begins so.
pub(super) fn is_one(first_line: &[u8]) -> bool {
    first_line.starts_with(b"LabVIEW Measurement")
}

/// Whether the heading of a further measurement begins in this line.
pub(super) fn begins_another(line: &[u8]) -> bool {
    line.starts_with(b"Channels")
}

/// Reads the heading from its first line on, up to the first row.
///
/// # Errors
/// A file that cannot be read, has no rows, or whose channels do not have the same times.
pub(super) fn heading(mut lines: Lines) -> Result<Heading, Error> {
    let path = lines.path.clone();
    let damaged = |reason: String| Error::damaged("CSV", &path, reason);
    let (mut units, mut sample_rate) = (Vec::new(), None);
    let (separator, mut names) = loop {
        if !lines.advance_to_text()? {
            return Err(damaged(format!("it has no line of names that begins with `{TIMES}`")));
        }
        let separator = separator(&lines.line);
        let cells = texts(&lines.line, separator);
        let same = || only_value(&cells).map_err(|why| damaged(format!("line {}, {why}", lines.number)));
        match cells[0].as_str() {
            TIMES => break (separator, cells),
            "Y_Unit_Label" => units = cells,
            "X_Dimension" => {
                if let Some(other) = same()?.filter(|found| *found != "Time") {
                    let line = lines.number;
                    let reason = format!("line {line}, `X_Dimension`: found `{other}`, expected `Time`");
                    return Err(damaged(reason));
                }
            }
            "X0" => {
                same()?;
            }
            "Delta_X" => {
                let step = same()?.and_then(|step| number(step.as_bytes())).filter(|step| *step > 0.0);
                let place = format!("line {}, `Delta_X`", lines.number);
                sample_rate = step.map(|step| StatedRate::heading(1.0 / step, place));
            }
            _ => {}
        }
    };
    if !lines.advance_to_text()? {
        return Err(damaged("it has names of columns and no rows".into()));
    }
    let has_times = texts(&lines.line, separator).first().is_some_and(|time| !time.is_empty());
    for (i, name) in names.iter_mut().enumerate() {
        let unit = units.get(i).filter(|unit| !unit.is_empty());
        match (name.as_str(), unit) {
            (TIMES, _) if i == 0 && has_times => *name = format!("{TIMES} [s]"),
            (TIMES | "Comment", _) => name.clear(),
            (_, Some(unit)) => *name = format!("{name} [{unit}]"),
            _ => {}
        }
    }
    Ok(Heading {
        lines,
        separator,
        names,
        sample_rate,
        unclear_rate: None,
        is_labview: true,
    })
}

/// The value that a line has for all channels; none where it has none.
fn only_value(cells: &[String]) -> Result<Option<&str>, String> {
    let mut values = cells[1..].iter().map(String::as_str).filter(|value| !value.is_empty());
    let first = values.next();
    match values.find(|value| Some(*value) != first) {
        None => Ok(first),
        Some(other) => Err(format!(
            "`{}`: found `{}` and `{other}`, expected the same value for all channels: save channels with other times to a \
             file of their own",
            cells[0],
            first.unwrap_or_default()
        )),
    }
}
