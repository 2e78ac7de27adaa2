//! Times of day and dates in the cells of a table.

use chrono::{NaiveDate, NaiveDateTime, NaiveTime};

/// How a time is written: ISO 8601 and what loggers make of it, day or month first.
const FORMATS: [&str; 6] = [
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
    "%m/%d/%Y %H:%M:%S%.f",
    "%m/%d/%Y %I:%M:%S%.f %p",
];

/// Nanoseconds of a time since 1970, or of a time of day since midnight; none where a cell holds none. A comma may stand
/// before the fraction, and at the end `Z` or the difference to UTC, `+01:00`, which is subtracted.
pub(super) fn nanoseconds(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?.replace(',', ".");
    let (text, ahead_ns) = without_zone(&text);
    let date = FORMATS
        .iter()
        .find_map(|format| NaiveDateTime::parse_from_str(text, format).ok());
    match date {
        Some(date) => date.and_utc().timestamp_nanos_opt()?.checked_sub(ahead_ns),
        None => time_of_day(cell),
    }
}

/// A date and time without its zone, and by how much that is ahead of UTC, ns.
fn without_zone(text: &str) -> (&str, i64) {
    /// Bytes of the shortest date.
    const DATE: usize = 10;
    if let Some(utc) = text.strip_suffix('Z') {
        return (utc, 0);
    }
    let Some(at) = text.rfind(['+', '-']).filter(|at| *at > DATE) else {
        return (text, 0);
    };
    let digits = text[at + 1..].replace(':', "");
    let number = |range: std::ops::Range<usize>| digits.get(range)?.parse::<i64>().ok();
    let minutes = match digits.len() {
        2 => number(0..2).map(|hours| 60 * hours),
        4 => number(0..2).zip(number(2..4)).map(|(hours, minutes)| 60 * hours + minutes),
        _ => None,
    };
    let sign = if text[at..].starts_with('-') { -1 } else { 1 };
    minutes.map_or((text, 0), |minutes| (text[..at].trim_end(), sign * minutes * 60_000_000_000))
}

/// Nanoseconds from midnight to a time of day; none where a cell holds none.
pub(super) fn time_of_day(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?.replace(',', ".");
    let time = NaiveTime::parse_from_str(text.trim_end_matches('Z'), "%H:%M:%S%.f").ok()?;
    time.signed_duration_since(NaiveTime::MIN).num_nanoseconds()
}

/// How a day is written.
const DAYS: [&str; 4] = ["%Y-%m-%d", "%Y/%m/%d", "%d.%m.%Y", "%m/%d/%Y"];

/// Nanoseconds from 1970 to a day; none where a cell holds none.
pub(super) fn day(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    let day = DAYS.iter().find_map(|format| NaiveDate::parse_from_str(text, format).ok())?;
    day.and_time(NaiveTime::MIN).and_utc().timestamp_nanos_opt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_loggers_write_them() {
        let at = |text: &str| nanoseconds(text.as_bytes());
        let expected = Some(1_767_225_661_000_500_000);
        for text in [
            "2026-01-01 00:01:01.0005",
            "2026-01-01T00:01:01.000500Z",
            "2026/01/01 00:01:01.0005",
            "01.01.2026 00:01:01,0005",
            "01/01/2026 00:01:01.0005",
            "01/01/2026 12:01:01.0005 AM",
            "2026-01-01T01:01:01.0005+01:00",
            "2025-12-31 18:31:01.0005-0530",
            "2026-01-01T02:01:01.0005+02",
        ] {
            assert_eq!(at(text), expected, "{text}");
        }
        assert_eq!(at("00:01:01.0005"), Some(61_000_500_000));
        for text in ["", "12", "2026-01-01", "2026-13-01 00:00:00", "a:b:c"] {
            assert_eq!(at(text), None, "{text}");
        }
    }
}
