//! Text that is nearly YAML becomes YAML, line by line.
//!
//! A parser stops at the first line that it cannot read. Here several repairs of that line, and of the one before
//! it, are tried: spaces for tabs, `key: value` for `key = value`, a closing bracket, the indentation of the line
//! above, and at last no line at all. The repair after which the parser gets furthest is kept. What else is wrong
//! in the file is then found in the same run.

use crate::error::{Error, Place, Problem};

/// Lines that are repaired at most.
const REPAIRS: usize = 20;

/// Bytes that all attempts together parse at most, so that a large file takes no longer.
const PARSED: usize = 10_000_000;

/// Spaces of an indentation where no line of a file shows how wide it is.
const WIDTH: usize = 2;

/// What is said of a text that is not parsed to its end.
pub(crate) const TOO_LARGE: &str = "nested too deeply, or too large";

/// Begins a document of a file that has several.
const DOCUMENT: &str = "---";

/// What became of a text.
pub(crate) struct Repaired<T> {
    /// What the parser made of it in the end.
    pub(crate) content: T,
    /// A mistake for each repair.
    pub(crate) mistakes: Vec<Error>,
    /// Whether lines are gone, and with them keys that somebody wrote.
    pub(crate) has_lost_lines: bool,
}

/// Parses `text`, which it may repair first.
///
/// # Errors
/// What the parser says of a text that no repairs help.
pub(crate) fn parse<T>(
    text: &str,
    parser: &dyn Fn(&str) -> Result<T, Error>,
) -> Result<Repaired<T>, Error> {
    let first = match parser(text) {
        Ok(content) => {
            return Ok(Repaired {
                content,
                mistakes: Vec::new(),
                has_lost_lines: false,
            });
        }
        Err(error) => error,
    };
    let mut error = first.clone();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let (mut mistakes, mut has_lost_lines) = (Vec::new(), false);
    let mut left = PARSED / text.len().max(1);
    for _ in 0..REPAIRS {
        let repairs = repairs(&lines, &error);
        if repairs.len() > left {
            break;
        }
        left -= repairs.len();
        let here = error.place().map_or(0, |place| place.line);
        let tried = repairs.into_iter().map(|repair| {
            let next = parser(&repair.lines.join("\n"));
            (reach(&next), repair, next)
        });
        let best = tried.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let Some((_, repair, next)) = best.filter(|(reach, ..)| *reach > here) else {
            break;
        };
        mistakes.push(repair.mistake);
        has_lost_lines |= repair.loses;
        match next {
            Ok(content) => {
                return Ok(Repaired {
                    content,
                    mistakes,
                    has_lost_lines,
                });
            }
            Err(next) => error = next,
        }
        lines = repair.lines;
    }
    Err(first)
}

/// The line up to which the parser got.
fn reach<T>(outcome: &Result<T, Error>) -> u64 {
    match outcome {
        Ok(_) => u64::MAX,
        Err(error) => error.place().map_or(0, |place| place.line),
    }
}

/// One way to mend a text.
struct Repair {
    lines: Vec<String>,
    mistake: Error,
    loses: bool,
}

/// What may be meant at the line of `error`, the likeliest first.
fn repairs(lines: &[String], error: &Error) -> Vec<Repair> {
    let (Some(place), Problem::Syntax(words)) = (error.place(), error.problem()) else {
        return Vec::new();
    };
    // Parsing it again would take as long each time.
    if words == TOO_LARGE || lines.is_empty() {
        return Vec::new();
    }
    let here = usize::try_from(place.line).map_or(0, |line| line.saturating_sub(1));
    let here = here.min(lines.len().saturating_sub(1));
    let above = (0..here).rev().find(|i| !is_blank(&lines[*i]));
    let above = above.filter(|i| !lines[*i].starts_with(DOCUMENT));
    let mut all = Vec::new();
    let with = |at: usize, line: String, words: &str, column: usize| {
        let mut lines = lines.to_vec();
        lines[at] = line;
        let mistake = mistake(at, column, words);
        Repair {
            lines,
            mistake,
            loses: false,
        }
    };
    all.extend(without_tabs(lines, here));
    if let Some(line) = as_entry(&lines[here]) {
        let words = format!(
            "expected a colon and a space after the key: '{}'",
            line.trim()
        );
        all.push(with(here, line, &words, indentation(&lines[here]).len()));
    }
    for at in [above, Some(here)].into_iter().flatten() {
        if let Some((column, opener, line)) = closed(&lines[at]) {
            let words = format!("the bracket '{opener}' is not closed");
            all.push(with(at, line, &words, column));
        }
    }
    if let Some(above) = above {
        let line = format!("{}{}", indentation(&lines[above]), lines[here].trim_start());
        let [found, expected] = [here, above].map(|at| indentation(&lines[at]).len());
        let words = format!("indented by {found}, where the line above is indented by {expected}");
        all.push(with(here, line, &words, found));
    }
    all.extend(without_line(lines, here, here, error));
    all.extend(above.and_then(|above| without_line(lines, above, here, error)));
    all
}

/// The text without the line `at`; the parser stopped at the line `here`.
fn without_line(lines: &[String], at: usize, here: usize, error: &Error) -> Option<Repair> {
    let mut rest = lines.to_vec();
    rest.get_mut(at)?.clear();
    let mistake = match at == here {
        true => error.clone(),
        false => Error::new("", error.problem().clone()).at(place_at(at, 0)),
    };
    Some(Repair {
        lines: rest,
        mistake,
        loses: true,
    })
}

fn mistake(line: usize, column: usize, words: &str) -> Error {
    Error::new("", Problem::Syntax(words.to_owned())).at(place_at(line, column))
}

fn place_at(line: usize, column: usize) -> Place {
    Place {
        line: line as u64 + 1,
        column: column as u64 + 1,
    }
}

fn is_blank(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#')
}

fn indentation(line: &str) -> &str {
    &line[..line.len() - line.trim_start().len()]
}

/// The text with spaces in the place of the tabs that lines begin with, if the line `here` or the next one has some.
fn without_tabs(lines: &[String], here: usize) -> Option<Repair> {
    let has_tab = |line: &String| indentation(line).contains('\t');
    if !lines.iter().skip(here).take(2).any(has_tab) {
        return None;
    }
    let widths = lines.iter().map(|line| indentation(line));
    let widths = widths.filter(|indent| !indent.is_empty() && !indent.contains('\t'));
    let width = widths.map(str::len).min().unwrap_or(WIDTH);
    let tabbed: Vec<usize> = (0..lines.len()).filter(|i| has_tab(&lines[*i])).collect();
    let spaced = |line: &String| {
        let indent = indentation(line).replace('\t', &" ".repeat(width));
        format!("{indent}{}", line.trim_start())
    };
    let others = match tabbed.len() {
        0 | 1 => String::new(),
        2 => ", and one more line".to_owned(),
        several => format!(", and {} more lines", several - 1),
    };
    Some(Repair {
        lines: lines.iter().map(spaced).collect(),
        mistake: mistake(
            *tabbed.first()?,
            0,
            &format!("indented by a tab{others}; expected spaces"),
        ),
        loses: false,
    })
}

/// `key: value` of a line in which the colon or the space after it is missing.
fn as_entry(line: &str) -> Option<String> {
    let indent = indentation(line);
    let rest = line.trim_start();
    let (item, rest) = match rest.strip_prefix("- ") {
        Some(rest) => ("- ", rest.trim_start()),
        None => ("", rest),
    };
    let is_of_key = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let end = rest.find(|c| !is_of_key(c)).filter(|end| *end > 0)?;
    let (key, rest) = rest.split_at(end);
    let value = rest.trim_start().strip_prefix([':', '='])?.trim();
    (!value.is_empty()).then(|| format!("{indent}{item}{key}: {value}"))
}

/// A line with the brackets closed that it opens, and column and sign of the first of them; none where all are closed.
fn closed(line: &str) -> Option<(usize, char, String)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    let (mut quote, mut before, mut end) = (None, ' ', line.len());
    for (at, (byte, c)) in line.char_indices().enumerate() {
        match (quote, c) {
            (Some(sign), c) if c == sign => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '#') if before.is_whitespace() => {
                end = byte;
                break;
            }
            (None, '{' | '[') => open.push((at, c)),
            (None, '}' | ']') => {
                open.pop();
            }
            _ => {}
        }
        before = c;
    }
    let (column, opener) = *open.first()?;
    let closers = open.iter().rev().map(|(_, c)| match c {
        '{' => '}',
        _ => ']',
    });
    let closers: String = closers.collect();
    let line = format!("{}{closers} {}", line[..end].trim_end(), &line[end..]);
    Some((column, opener, line))
}
