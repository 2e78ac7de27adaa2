//! CSV of plain columns, for spreadsheets and for a look with the naked eye (RFC 4180), and the text files of data loggers.

mod cells;
mod date;
mod encoding;
mod heading;
mod labview;
mod lines;
mod read;
mod stated_rate;
mod write;
mod written_number;

pub use write::write_table;

use super::recording_format::{RecordingFormat};

/// CSV as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "CSV",
    endings: &["csv", "tsv", "txt", "lvm"],
    signature_at: None,
    recognise: |head| is_text(head).then_some("text"),
    open: read::open,
};

/// Text in UTF-8, UTF-16 or Windows-1252: no control characters but those of lines and columns.
fn is_text(head: &[u8]) -> bool {
    if encoding::UTF_16.iter().any(|mark| head.starts_with(mark)) {
        return true;
    }
    let control = |b: &u8| *b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r');
    !head.iter().any(control)
}
