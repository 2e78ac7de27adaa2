//! Which format a file has.

use crate::Error;
use crate::formats::FORMATS;
use crate::formats::recording_format::{RecordingFormat, has};
use std::io::Read;
use std::path::Path;

/// Enough of a file for the signatures of all formats; that of HDF5 may stand at 512.
const HEAD: u64 = 1024;

/// Signatures of formats that are not read, at the beginning of a file.
const UNREADABLE: [(&[u8], &str); 6] = [
    (b"TDSm", "a TDMS file"),
    (b"PK\x03\x04", "a ZIP archive or a spreadsheet"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"fLaC", "a FLAC file"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"ARROW1", "an Arrow file"),
];

/// The format that the name says, or for other names the one that the first bytes show.
///
/// # Errors
/// A file that cannot be read, whose name and first bytes contradict each other, or that has no known format.
pub(super) fn format_of_file(path: &Path) -> Result<&'static RecordingFormat, Error> {
    let mut head = Vec::new();
    files::open(path)
        .and_then(|file| file.take(HEAD).read_to_end(&mut head))
        .map_err(Error::io("read", path))?;
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let ending = ending.to_ascii_lowercase();
    let named = FORMATS.iter().find(|f| f.endings.contains(&&*ending));
    match (named, shown(&head)) {
        (Some(_), Shown::Format(shown, _)) if shown.endings.contains(&&*ending) => Ok(shown),
        (_, Shown::Other(what)) => {
            let reason = format!("it looks like {what}: save it as {}", names("or"));
            Err(Error::damaged(name_of(named), path, reason))
        }
        (Some(_), Shown::Format(_, what)) => {
            let reason = format!("it looks like {what}");
            Err(Error::damaged(name_of(named), path, reason))
        }
        (Some(named), Shown::Binary) if named.signature_at.is_none() => {
            Err(Error::damaged(named.name, path, "it is not text"))
        }
        // A damaged head: the reader of the format says what is wrong.
        (Some(named), Shown::Binary) => Ok(named),
        (None, Shown::Format(format, _)) => Ok(format),
        (None, Shown::Binary) => {
            let reason = format!("it is none of {}", names("and"));
            Err(Error::damaged(name_of(named), path, reason))
        }
    }
}

/// The formats that are read, as a list that ends with `last`.
fn names(last: &str) -> String {
    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    let (end, others) = names.split_last().unwrap_or((&"", &[]));
    format!("{} {last} {end}", others.join(", "))
}

fn name_of(named: Option<&RecordingFormat>) -> &'static str {
    named.map_or("a recording", |named| named.name)
}

enum Shown {
    Format(&'static RecordingFormat, &'static str),
    /// A format that is not read.
    Other(&'static str),
    Binary,
}

/// What the first bytes of a file show. A signature at the beginning is looked for before one further on, and
/// text after all signatures.
fn shown(head: &[u8]) -> Shown {
    let [signed, text] = [true, false].map(|has_signature| {
        let of_kind = move |f: &&RecordingFormat| f.signature_at.is_some() == has_signature;
        let mut formats: Vec<&RecordingFormat> = FORMATS.iter().filter(of_kind).collect();
        formats.sort_by_key(|format| format.signature_at);
        formats
    });
    let recognised = |formats: Vec<&'static RecordingFormat>| {
        let seen = |format: &'static RecordingFormat| {
            let what = (format.recognise)(head)?;
            Some(Shown::Format(format, what))
        };
        formats.into_iter().find_map(seen)
    };
    let unreadable = || {
        let mut known = UNREADABLE.iter();
        let found = known.find(|(signature, _)| has(head, 0, signature));
        found.map(|(_, what)| Shown::Other(what))
    };
    recognised(signed)
        .or_else(unreadable)
        .or_else(|| recognised(text))
        .unwrap_or(Shown::Binary)
}
