//! What the programs print, and the files that they write.
//!
//! The standard library's `println!` panics where standard output cannot be written: a full disk, a
//! closed descriptor. Here it ends the program with one message and exit status 1; `eprintln!` continues, as
//! a message that nobody can read is no reason to lose the work. A summary that nobody reads to its end
//! (`| head`) ends the program without a word, as everywhere.
//!
//! Names of runs, cases and files come from others. What is printed is [`Harmless`], whoever wrote it.

use crate::{Failure, console};
use recordings::WholeFile;
use serde::Serialize;
use std::fmt::{Arguments, Write as _};
use std::io::{self, Write};
use std::path::{Path, is_separator};

/// Exit status of a program that the signal of a broken pipe has ended, as the shell reports it.
const BROKEN_PIPE: i32 = 128 + 13;

/// Words with which messages begin, and how they are coloured (Select Graphic Rendition, ECMA-48).
const LABELS: [(&str, &str); 4] = [
    ("error:", "1;31"),
    ("warning:", "33"),
    ("note:", "36"),
    ("next:", "32"),
];

/// Writes results as JSON into a file that appears whole or not at all.
///
/// # Errors
/// Where it cannot be written.
pub(crate) fn write_json(path: &Path, results: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(results)?;
    Ok(WholeFile::write(path, &text).map(drop)?)
}

/// Refuses to write where a file of `paths` is already there, and says which `option` writes elsewhere.
///
/// # Errors
/// The first that is, unless it may be replaced.
pub(crate) fn refuse_existing<P: AsRef<Path>>(
    paths: impl IntoIterator<Item = P>,
    overwrite: bool,
    option: &str,
) -> Result<(), Failure> {
    let mut paths = paths.into_iter();
    match paths.find(|path| path.as_ref().exists() && !overwrite) {
        None => Ok(()),
        Some(path) => Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, {option} writes elsewhere",
            path.as_ref().display()
        ))),
    }
}

/// Refuses a folder as the file `out` to write: one that is there, or a name that ends as that of a folder does.
///
/// # Errors
/// Where it is one.
pub(crate) fn refuse_folder(out: &Path) -> Result<(), Failure> {
    let named_so = out.as_os_str().to_string_lossy().ends_with(is_separator);
    match named_so || out.is_dir() {
        false => Ok(()),
        true => Err(Failure::input(format!(
            "--out: {} is a folder, expected a file",
            out.display()
        ))),
    }
}

/// Makes a folder, if it is not there.
///
/// # Errors
/// Where it cannot be made.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))
}

/// Writes to standard output, and ends the program where that fails.
pub(crate) fn print(text: Arguments) {
    let mut out = io::stdout().lock();
    let written = write(&mut out, text).and_then(|()| out.flush());
    end_if_unwritten(written);
}

/// Writes what this program has made, as it is, to standard output; ends the program where that fails.
pub(crate) fn bytes(content: &[u8]) {
    let mut out = io::stdout().lock();
    let written = out.write_all(content).and_then(|()| out.flush());
    end_if_unwritten(written);
}

#[allow(clippy::exit)] // A summary that cannot be written: what follows it could not be either.
fn end_if_unwritten(written: io::Result<()>) {
    if let Err(error) = written {
        if error.kind() == io::ErrorKind::BrokenPipe {
            std::process::exit(BROKEN_PIPE);
        }
        message(format_args!("error: standard output: {error}\n"));
        std::process::exit(1);
    }
}

/// `text` as it is printed, for a line that something else draws.
pub(crate) fn harmless(text: &str) -> String {
    let mut harmless = String::new();
    // A string takes all that is written to it.
    let _ = Harmless(&mut harmless).write_str(text);
    harmless
}

/// Writes to standard error, if that can be written. The word with which a message begins is coloured
/// where colours are wanted.
pub(crate) fn message(text: Arguments) {
    let mut err = io::stderr().lock();
    let text = text.to_string();
    let label = LABELS.iter().find(|(label, _)| text.starts_with(label));
    let _ = match label.filter(|_| console::is_coloured()) {
        Some((label, colour)) => err
            .write_all(format!("\u{1b}[{colour}m{label}\u{1b}[0m").as_bytes())
            .and_then(|()| write(&mut err, format_args!("{}", &text[label.len()..]))),
        None => write(&mut err, format_args!("{text}")),
    };
}

/// Says what is wrong, a line each.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        message(format_args!("warning: {warning}\n"));
    }
}

/// Says what its user may do next, in a line that can be copied; nothing with `--quiet`.
pub(crate) fn hint(next: Arguments) {
    if !console::is_quiet() {
        message(format_args!("next: {next}\n"));
    }
}

fn write(out: &mut impl Write, text: Arguments) -> io::Result<()> {
    let mut harmless = String::new();
    let written = Harmless(&mut harmless).write_fmt(text);
    written.map_err(io::Error::other)?;
    out.write_all(without_passwords(&harmless).as_bytes())
}

/// Text without control of the terminal. Control characters other than the line break, and
/// characters that change the direction of writing (Unicode Standard Annex 9), are written as
/// `\u001b`. In JSON this is the same character.
struct Harmless<'a>(&'a mut String);

impl std::fmt::Write for Harmless<'_> {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for c in text.chars() {
            let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
            match c {
                '\n' => self.0.push(c),
                c if c.is_control() || turns => write!(self.0, "\\u{:04x}", u32::from(c))?,
                c => self.0.push(c),
            }
        }
        Ok(())
    }
}

/// `text` with `***` in the place of the user and the password of each URL (RFC 3986, section 3.2.1).
fn without_passwords(text: &str) -> String {
    let mut masked = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(begin) = rest.find("://") {
        let (head, tail) = rest.split_at(begin + 3);
        masked += head;
        let end = tail.find(|c: char| c == '/' || c.is_whitespace());
        let host = &tail[..end.unwrap_or(tail.len())];
        rest = match host.rfind('@') {
            Some(at) => {
                masked += "***";
                &tail[at..]
            }
            None => tail,
        };
    }
    masked + rest
}

macro_rules! println {
    () => { $crate::output::print(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::print(format_args!("{}\n", format_args!($($text)*))) };
}

macro_rules! print {
    ($($text:tt)*) => { $crate::output::print(format_args!($($text)*)) };
}

macro_rules! eprintln {
    () => { $crate::output::message(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::message(format_args!("{}\n", format_args!($($text)*))) };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str) -> String {
        let mut out = Vec::new();
        write(&mut out, format_args!("{text}")).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn nothing_speaks_to_the_terminal() {
        assert_eq!(
            printed("run\u{1b}[2J\r\u{9b}1m\u{202e}\n"),
            "run\\u001b[2J\\u000d\\u009b1m\\u202e\n"
        );
        assert_eq!(printed("Überdruck 2 × p₀ µm\n"), "Überdruck 2 × p₀ µm\n");
    }

    #[test]
    fn passwords_are_masked() {
        for (text, expected) in [
            ("s3://me:secret@bucket/a: no", "s3://***@bucket/a: no"),
            ("`s3://me:se@cret@bucket`", "`s3://***@bucket`"),
            ("s3://bucket/a@b https://x/y", "s3://bucket/a@b https://x/y"),
            ("a://u:p@h b://u:p@h", "a://***@h b://***@h"),
        ] {
            assert_eq!(printed(text), expected);
        }
    }
}
