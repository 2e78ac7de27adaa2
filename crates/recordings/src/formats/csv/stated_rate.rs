//! The sample rate that lines before a table state: `Sample rate: 2000 Hz`, `Sampling frequency [kHz];25,6`, `dt = 0.5 ms`.
//!
//! A line is a name of the rate or of the period, perhaps a unit, and a number with perhaps a unit. A line of any other form is
//! not guessed at: it states no rate, and is quoted where no other one states it.

use super::written_number::{Written, written_number};
use crate::measured::{CLEAR_FROM_HZ, PERIODS, RATES, StatedRate, agree, seconds_of_unit};

/// Rates in samples per second, in small letters and without a prefix.
const PER_SECOND: [&str; 11] = [
    "hz",
    "hertz",
    "s/s",
    "sa/s",
    "sps",
    "samples/s",
    "sample/s",
    "samples/sec",
    "samples per second",
    "1/s",
    "s^-1",
];

/// Words that make another rate of one that is stated elsewhere.
const DIVIDERS: [&str; 3] = ["divi", "decimat", "teiler"];

/// What a line says of the sample rate.
#[derive(Clone, Debug, PartialEq)]
enum Line {
    /// It, Hz.
    Rate(f64),
    /// Nothing that is understood, and why.
    Unclear(String),
    /// That a rate of another line does not hold, and why.
    Vetoed(String),
}

/// What the lines before a table say of the sample rate.
#[derive(Debug, Default)]
pub(super) struct StatedLines {
    /// The lines that say something, with their places.
    lines: Vec<(String, Line)>,
}

impl StatedLines {
    /// Takes what a line says.
    pub(super) fn add(&mut self, number: u64, line: &[u8]) {
        let text = String::from_utf8_lossy(line).replace('"', "");
        if let Some(said) = said(&text) {
            let shown: String = text.trim().chars().take(80).collect();
            self.lines.push((format!("line {number}, `{shown}`"), said));
        }
    }

    /// The rate on which all lines that are understood agree, or why there is none; neither where no line is about it.
    pub(super) fn rate(self) -> (Option<StatedRate>, Option<String>) {
        let first = |of: fn(&Line) -> Option<&String>| {
            let mut found = self
                .lines
                .iter()
                .filter_map(|(place, line)| Some((place, of(line)?)));
            found.next().map(|(place, why)| format!("{place}: {why}"))
        };
        let vetoed = first(|line| match line {
            Line::Vetoed(why) => Some(why),
            _ => None,
        });
        if vetoed.is_some() {
            return (None, vetoed);
        }
        let mut rates = self.lines.iter().filter_map(|(place, line)| match line {
            Line::Rate(hz) => Some((place, *hz)),
            _ => None,
        });
        let Some((place, hz)) = rates.next() else {
            let unclear = first(|line| match line {
                Line::Unclear(why) => Some(why),
                _ => None,
            });
            return (None, unclear);
        };
        if let Some((other, another_hz)) = rates.find(|(_, another)| !agree(hz, *another)) {
            let why = format!("{place}, says {hz} Hz, but {other}, says {another_hz} Hz");
            return (None, Some(why));
        }
        (Some(StatedRate::heading(hz, place.clone())), None)
    }
}

/// What a line says of the sample rate; none where it is about something else.
fn said(line: &str) -> Option<Line> {
    let text = line.trim_start_matches(|c: char| c.is_whitespace() || "#%/*;,".contains(c));
    let lower = text.to_ascii_lowercase().replace(['_', '-'], " ");
    if let Some(axis) = lower.strip_prefix("x dimension") {
        let mut cells = axis.split([';', ',', '\t', ':', '=']).map(str::trim);
        let is_time = cells.all(|cell| cell.is_empty() || cell == "time");
        return (!is_time).then(|| Line::Vetoed("the samples do not follow in time".into()));
    }
    let begins = |label: &&&str| {
        let rest = lower.strip_prefix(**label);
        rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
    };
    let longest = |labels: &'static [&'static str]| {
        labels.iter().filter(begins).max_by_key(|label| label.len())
    };
    let of_samples = || ["s/s", "sps"].iter().any(|unit| lower.contains(unit));
    let labels = longest(&RATES).or_else(|| longest(&["rate"]).filter(|_| of_samples()));
    let label = labels.map(|label| (label, Named::Rate));
    let label = label.or_else(|| longest(&PERIODS).map(|label| (label, Named::Period)));
    let mentions = || {
        RATES
            .iter()
            .chain(&PERIODS)
            .any(|name| name.len() > 7 && lower.contains(name))
    };
    if (label.is_some() || mentions()) && DIVIDERS.iter().any(|word| lower.contains(word)) {
        return Some(Line::Vetoed(
            "whether it divides the sample rate is not understood".into(),
        ));
    }
    match label {
        Some((label, named)) => Some(match quantity(&text[label.len()..], named) {
            Ok(hz) => Line::Rate(hz),
            Err(why) => Line::Unclear(why),
        }),
        None => mentions().then(|| {
            Line::Unclear("the line does not begin with the name of a sample rate".into())
        }),
    }
}

/// What the name in a line is one of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Named {
    Rate,
    Period,
}

/// The unit of a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    /// So many samples per second.
    PerSecond(f64),
    /// A period of so many seconds.
    Seconds(f64),
}

impl Unit {
    fn parse(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if let Some(seconds) = seconds_of_unit(text) {
            return Ok(Self::Seconds(seconds));
        }
        let lower = text.to_lowercase();
        let mega = text.starts_with('M');
        let factors = [
            ("", 1.0),
            ("k", 1e3),
            ("kilo", 1e3),
            ("mega", 1e6),
            ("m", 1e6),
        ];
        let found = factors.into_iter().find(|(prefix, _)| {
            let name = lower.strip_prefix(prefix);
            (*prefix != "m" || mega) && name.is_some_and(|name| PER_SECOND.contains(&name))
        });
        match found {
            Some((_, factor)) => Ok(Self::PerSecond(factor)),
            None => Err(format!(
                "found `{text}`, expected a unit such as Hz, kHz, S/s or ms"
            )),
        }
    }
}

/// The rate that follows a name, Hz.
fn quantity(rest: &str, named: Named) -> Result<f64, String> {
    let (mut unit, rest) = unit_before(rest)?;
    let separates = |c: char| ":=;\t,".contains(c);
    let commas = !rest.trim_start().starts_with(',');
    let cells = rest.split(|c: char| ";\t:=".contains(c) || (c == ',' && !commas));
    let mut numbers: Vec<(&str, Written, Option<Unit>)> = Vec::new();
    for cell in cells.map(str::trim).filter(|cell| !cell.is_empty()) {
        let around = |c: char| c.is_whitespace() || separates(c) || "[](){}.".contains(c);
        match written_number(cell, commas) {
            Some((number, after)) => {
                let own = after.trim_matches(around);
                let own = (!own.is_empty()).then(|| Unit::parse(own)).transpose()?;
                numbers.push((&cell[..cell.len() - after.len()], number, own));
            }
            None if unit.is_none()
                && !cell.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c)) =>
            {
                unit = Some(
                    Unit::parse(cell.trim_matches(around)).map_err(|_| expected_number(cell))?,
                );
            }
            None => return Err(expected_number(cell)),
        }
    }
    let mut rates = Vec::new();
    for (text, number, own) in numbers {
        if let (Some(unit), Some(own)) = (unit, own)
            && unit != own
        {
            return Err("found two units".into());
        }
        rates.push(rate(text, number, own.or(unit), named)?);
    }
    let first = rates
        .first()
        .ok_or("found no number, expected a sample rate with its unit")?;
    match rates.iter().all(|rate| rate == first) {
        true => Ok(*first),
        false => Err(format!("found {} numbers, expected one", rates.len())),
    }
}

fn expected_number(found: &str) -> String {
    format!("found `{found}`, expected a positive number with its unit")
}

/// The unit that stands behind a name, in brackets, after `/` or `in`, or as the end of a word, and what follows.
fn unit_before(rest: &str) -> Result<(Option<Unit>, &str), String> {
    let abbreviated = rest
        .strip_prefix('.')
        .filter(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()));
    let rest = abbreviated.unwrap_or(rest).trim_start_matches(' ');
    let starts = |c: char| ":=;\t,+-.".contains(c) || c.is_ascii_digit();
    let unknown = || "what follows the name of the sample rate is not understood".to_owned();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((inside, after)) = rest
            .strip_prefix(open)
            .and_then(|rest| rest.split_once(close))
        else {
            continue;
        };
        let after = after.trim_start_matches(' ');
        if !after.starts_with(starts) {
            return Err(unknown());
        }
        return Ok((Some(Unit::parse(inside)?), after));
    }
    let (head, after) = rest.split_at(rest.find(starts).unwrap_or(rest.len()));
    let head = head.trim_matches([' ', '_']);
    let unit = head
        .strip_prefix('/')
        .or_else(|| head.strip_prefix("in "))
        .unwrap_or(head);
    match unit.is_empty() {
        true => Ok((None, after)),
        false => Ok((Some(Unit::parse(unit).map_err(|_| unknown())?), after)),
    }
}

/// The rate that a number with this unit is, Hz.
fn rate(text: &str, number: Written, unit: Option<Unit>, named: Named) -> Result<f64, String> {
    let number = match (number, unit) {
        (Written::Number(number), _) => number,
        // Thousands of kilohertz would be in MHz.
        (Written::Ambiguous { decimal, .. }, Some(Unit::PerSecond(factor))) if factor > 1.0 => {
            decimal
        }
        (Written::Ambiguous { decimal, thousands }, _) => {
            return Err(format!(
                "found `{text}`, which may be {decimal} or {thousands}"
            ));
        }
    };
    if !(number.is_finite() && number > 0.0) {
        return Err(expected_number(text));
    }
    let without_unit = || Err(format!("found `{text}`, expected a unit"));
    let hz = match (unit, named) {
        (Some(Unit::PerSecond(_)), Named::Period) => {
            return Err("found a period in samples per second".into());
        }
        (Some(Unit::PerSecond(factor)), Named::Rate) => number * factor,
        (Some(Unit::Seconds(seconds)), _) => 1.0 / (number * seconds),
        (None, Named::Rate) if number.fract() != 0.0 => return without_unit(),
        (None, Named::Rate) => number,
        (None, Named::Period) if 1.0 / number < CLEAR_FROM_HZ => return without_unit(),
        (None, Named::Period) => 1.0 / number,
    };
    let rounded = (hz * 1e6).round() / 1e6;
    let near = if rounded > 0.0 && (rounded - hz).abs() < 1e-9 * hz {
        rounded
    } else {
        hz
    };
    near.is_finite()
        .then_some(near)
        .ok_or_else(|| expected_number(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_read_with_its_unit() {
        for (line, rate) in [
            ("Sample rate: 2000 Hz", 2000.0),
            ("Sampling Frequency;25,6 kHz", 25_600.0),
            ("Abtastrate=1000", 1000.0),
            ("# sampling_rate_hz, 12800", 12_800.0),
            ("Sample rate [kHz];25.6", 25_600.0),
            ("Sample rate (kHz): 25.6", 25_600.0),
            ("Sample rate / kHz;25.6", 25_600.0),
            ("Sample rate in kHz: 25.6", 25_600.0),
            ("Sample rate;kHz;25.6", 25_600.0),
            ("Sample rate;25.6;kHz", 25_600.0),
            ("Sample rate,25.6,kHz", 25_600.0),
            ("Sample rate;25600;25600", 25_600.0),
            ("Sample rate: 25.6 kS/s", 25_600.0),
            ("Sample rate: 25.6 ksps", 25_600.0),
            ("Sample rate: 25.6 KHz", 25_600.0),
            ("Sample rate: 0.0256 MHz", 25_600.0),
            ("Sample rate: 0.0256 MS/s", 25_600.0),
            ("Sample rate: 25.600 kHz", 25_600.0),
            ("Sample rate: 25 600 Hz", 25_600.0),
            ("Sample rate: 25'600 Hz", 25_600.0),
            ("Sample rate: 1,024,000 Hz", 1_024_000.0),
            ("Sample rate: 25600.000 Hz", 25_600.0),
            ("Sample rate: 25.6 kilohertz", 25_600.0),
            ("Sample rate: 25600 samples per second", 25_600.0),
            ("Sample rate: 25600 [Hz],,", 25_600.0),
            ("Samples/s: 25600", 25_600.0),
            ("Rate: 25600 S/s", 25_600.0),
            ("Fs = 25600", 25_600.0),
            ("\"Sampling Freq. [Hz]\",\"25600\"", 25_600.0),
            ("Sample interval: 39.0625 us", 25_600.0),
            ("Sample rate: 39.0625 µs", 25_600.0),
            ("sample period (s);0.0000390625", 25_600.0),
            ("dt;0.0390625;ms", 25_600.0),
            ("dt = 3.90625E-05 s", 25_600.0),
            ("Delta_X\t3.90625e-5\t3.90625e-5", 25_600.0),
        ] {
            let mut lines = StatedLines::default();
            lines.add(1, line.as_bytes());
            let (found, why) = lines.rate();
            assert_eq!(found.map(|stated| stated.hz), Some(rate), "{line}: {why:?}");
        }
    }

    #[test]
    fn what_is_not_understood_is_not_guessed() {
        for (line, why) in [
            ("Sampling rate: 25,600 Hz", "which may be 25.6 or 25600"),
            ("Sample rate: 25.600 Hz", "which may be 25.6 or 25600"),
            ("Sample rate,25,600 Hz", "found 2 numbers"),
            ("Sample rate: -25600 Hz", "expected a positive number"),
            ("Sample rate: 0 Hz", "expected a positive number"),
            (
                "Sample rate: unknown, see 2026 protocol",
                "what follows the name",
            ),
            ("Sample rate: 1/25600 s", "found `/25600 s`"),
            ("Sample rate: 25600 rpm", "found `rpm`"),
            ("Sample rate: 1.536e6 /min", "found `/min`"),
            ("Sample rate: 1000 samples/rev", "found `samples/rev`"),
            ("Sample rate: 25.6 k", "found `k`"),
            ("Sample rate: 25.6 mhz", "found `mhz`"),
            ("Sample rate error: 0.01 %", "what follows the name"),
            ("Sample rate of tacho: 1000 Hz", "what follows the name"),
            ("Sample rate 1: 25600 Hz", "numbers"),
            ("Sample rate;Channel 1;25600", "what follows the name"),
            ("Sample rate;12800;25600", "found 2 numbers"),
            ("Sample rate: 25600 Hz, cut-off 10 kHz", "expected a unit"),
            ("SampleRate=25.6", "expected a unit"),
            ("dt = 0.0390625", "expected a unit"),
            (
                "Sample interval: 25600 Hz",
                "a period in samples per second",
            ),
            ("Max. sample rate: 102400 Hz", "does not begin with"),
            ("Original sample rate: 51200 Hz", "does not begin with"),
            ("Sample rate divisor: 2", "divides"),
        ] {
            let mut lines = StatedLines::default();
            lines.add(7, line.as_bytes());
            let (found, said) = lines.rate();
            assert_eq!(found.map(|stated| stated.hz), None, "{line}");
            let said = said.unwrap();
            assert!(said.starts_with("line 7, `"), "{said}");
            assert!(
                said.contains(why) || why == "what follows the name" && said.contains("expected"),
                "{said}"
            );
        }
        for line in [
            "Samples;4000",
            "acceleration rate 5",
            "Rate: 72 Hz",
            "dtc: 5",
            "fs2;1",
            "",
            "Datum;2026",
        ] {
            assert_eq!(said(line), None, "{line}");
        }
    }

    #[test]
    fn lines_decide_together() {
        for (text, rate, why) in [
            (
                "Original sample rate: 51200 Hz\nSample rate: 25600 Hz",
                Some(25_600.0),
                None,
            ),
            ("Sample rate: unknown\nFs = 25600", Some(25_600.0), None),
            (
                "dt = 3.90625E-05 s\nSampling rate: 25.6 kHz",
                Some(25_600.0),
                None,
            ),
            (
                "sample_rate;12800 Hz\nsample_rate;25600 Hz",
                None,
                Some("says 25600 Hz"),
            ),
            (
                "Sample rate: 51200 Hz\nSample rate divisor: 2",
                None,
                Some("divides"),
            ),
            (
                "X_Dimension\tFrequency\nDelta_X\t0.001",
                None,
                Some("do not follow in time"),
            ),
            (
                "X_Dimension\tTime\tTime\nDelta_X\t0.001",
                Some(1000.0),
                None,
            ),
            ("Device: ABC", None, None),
        ] {
            let mut lines = StatedLines::default();
            for (i, line) in text.lines().enumerate() {
                lines.add(i as u64 + 1, line.as_bytes());
            }
            let (found, said) = lines.rate();
            assert_eq!(found.map(|stated| stated.hz), rate, "{text}");
            assert_eq!(said.is_some(), why.is_some(), "{text}");
            let said = said.unwrap_or_default();
            assert!(said.contains(why.unwrap_or_default()), "{said}");
        }
    }
}
