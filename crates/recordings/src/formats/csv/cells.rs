//! The cells of a line of text, and the numbers in them.

/// The separator of a line: semicolons and tabs before commas, which may be decimal signs.
pub(super) fn separator(line: &[u8]) -> u8 {
    let count = |separator: u8| cells(line, separator).count();
    [b';', b'\t']
        .into_iter()
        .find(|&separator| count(separator) > 1)
        .unwrap_or(b',')
}

/// The cells of a line; quotation marks around a cell are taken off.
pub(super) fn cells(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
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

/// The cells of a line as text.
pub(super) fn texts(line: &[u8], separator: u8) -> Vec<String> {
    let text = |cell| String::from_utf8_lossy(cell).trim().to_owned();
    cells(line, separator).map(text).collect()
}

/// The number in a cell, NaN in an empty one; none where something else stands there. A comma in a cell separates nothing: it
/// stands there in quotation marks, or another sign separates the cells. It is then the decimal sign.
pub(super) fn number(cell: &[u8]) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    let text = std::str::from_utf8(cell).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    match text.contains(',') && !text.contains('.') {
        true => text.replacen(',', ".", 1).parse().ok(),
        false => None,
    }
}

/// What loggers and spreadsheets write for a sample that is missing, in small letters.
const MISSING: [&str; 16] = [
    "n/a",
    "na",
    "#n/a",
    "#na",
    "null",
    "none",
    "nil",
    "--",
    "---",
    "-",
    "ovl",
    "ovld",
    "ovr",
    "over",
    "overload",
    "overrange",
];

/// Whether a cell says that its sample is missing.
pub(super) fn is_missing(cell: &[u8]) -> bool {
    std::str::from_utf8(cell)
        .is_ok_and(|cell| MISSING.contains(&cell.to_ascii_lowercase().as_str()))
}
