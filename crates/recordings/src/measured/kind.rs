//! Which format a file has.

use crate::Error;
use std::io::Read;
use std::path::Path;

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Csv,
    Wav,
    Mat,
    Parquet,
    Mcap,
}

/// Enough of a file for the signatures of all formats; that of HDF5 may stand at 512.
const HEAD: u64 = 1024;

/// The format that the name says, or for other names the one that the first bytes show.
pub(super) fn of(path: &Path) -> Result<Kind, Error> {
    let mut head = Vec::new();
    files::open(path)
        .and_then(|file| file.take(HEAD).read_to_end(&mut head))
        .map_err(Error::io("read", path))?;
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let named = match ending.to_ascii_lowercase().as_str() {
        "csv" | "tsv" | "txt" => Some((Kind::Csv, "CSV")),
        "wav" => Some((Kind::Wav, "WAV")),
        "mat" => Some((Kind::Mat, "MAT")),
        "parquet" => Some((Kind::Parquet, "Parquet")),
        "mcap" => Some((Kind::Mcap, "MCAP")),
        _ => None,
    };
    let shown = shown(&head);
    match (named, shown) {
        (Some((named, _)), Shown::Kind(shown, _)) if named == shown => Ok(named),
        (Some((_, format)), Shown::Kind(_, what) | Shown::Other(what)) => Err(Error::damaged(
            format,
            path,
            format!("it looks like {what}"),
        )),
        (Some((Kind::Csv, _)), Shown::Binary) => Err(Error::damaged("CSV", path, "it is not text")),
        // A damaged head: the reader of the format says what is wrong.
        (Some((kind, _)), Shown::Binary) => Ok(kind),
        (None, Shown::Kind(kind, _)) => Ok(kind),
        (None, Shown::Other(what)) => Err(Error::damaged(
            "a recording",
            path,
            format!("it looks like {what}"),
        )),
        (None, Shown::Binary) => Err(Error::damaged(
            "a recording",
            path,
            "it is none of CSV, WAV, MAT, Parquet and MCAP",
        )),
    }
}

enum Shown {
    Kind(Kind, &'static str),
    /// A format that is not read.
    Other(&'static str),
    Binary,
}

fn shown(head: &[u8]) -> Shown {
    let starts = |signature: &[u8]| head.starts_with(signature);
    let at =
        |from: usize, signature: &[u8]| head.get(from..from + signature.len()) == Some(signature);
    if starts(b"PAR1") {
        Shown::Kind(Kind::Parquet, "a Parquet file")
    } else if starts(b"\x89MCAP") {
        Shown::Kind(Kind::Mcap, "an MCAP file")
    } else if (starts(b"RIFF") || starts(b"RF64") || starts(b"BW64")) && at(8, b"WAVE") {
        Shown::Kind(Kind::Wav, "a WAV file")
    } else if starts(b"MATLAB 7.3") || at(512, b"\x89HDF\r\n\x1a\n") {
        Shown::Other("a MAT file of version 7.3 (HDF5); save it with `-v7`")
    } else if at(126, b"IM") || at(126, b"MI") {
        Shown::Kind(Kind::Mat, "a MAT file")
    } else if starts(b"\x89HDF\r\n\x1a\n") {
        Shown::Other("an HDF5 file")
    } else if starts(b"PK\x03\x04") {
        Shown::Other("a ZIP archive or a spreadsheet")
    } else if starts(b"\x1f\x8b") {
        Shown::Other("a gzip archive")
    } else if starts(b"fLaC") {
        Shown::Other("a FLAC file")
    } else if starts(b"\x93NUMPY") {
        Shown::Other("a NumPy array")
    } else if starts(b"ARROW1") {
        Shown::Other("an Arrow file")
    } else if is_text(head) {
        Shown::Kind(Kind::Csv, "text")
    } else {
        Shown::Binary
    }
}

/// Text in UTF-8 or Latin-1: no control characters but those of lines and columns.
fn is_text(head: &[u8]) -> bool {
    let control = |b: &u8| *b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r');
    !head.iter().any(control)
}
