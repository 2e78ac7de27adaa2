//! The characters of a text file: UTF-8, UTF-16 where a mark at its beginning says so, or those of Western Windows.

use crate::Error;
use encoding_rs::WINDOWS_1252;
use encoding_rs_io::DecodeReaderBytesBuilder;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Bytes that are read at a time, and from which the encoding is known.
const BUFFER: usize = 1 << 18;

/// Marks of UTF-16, little and big end first.
pub(super) const UTF_16: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];

/// The text of a file in UTF-8, without a mark at its beginning.
pub(super) type Text = BufReader<Box<dyn Read + Send>>;

/// Opens a text file. One that does not begin with UTF-8 is taken for Windows-1252, which has all printed characters of Latin-1.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn open(path: &Path) -> Result<Text, Error> {
    let file = files::open(path).map_err(Error::io("open", path))?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    let start = file.fill_buf().map_err(Error::io("read", path))?;
    let (marked, utf8) = (start.starts_with(b"\xef\xbb\xbf"), is_utf8(start));
    let encoding = match UTF_16.iter().any(|mark| start.starts_with(mark)) {
        true => None,
        false if utf8 => {
            if marked {
                file.consume(3);
            }
            return Ok(buffered(Box::new(file)));
        }
        false => Some(WINDOWS_1252),
    };
    let decoder = DecodeReaderBytesBuilder::new().encoding(encoding).build(file);
    Ok(buffered(Box::new(decoder)))
}

fn buffered(text: Box<dyn Read + Send>) -> Text {
    BufReader::with_capacity(BUFFER, text)
}

/// Whether bytes are UTF-8 but for a character that their end cuts.
fn is_utf8(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).map_or_else(|error| error.error_len().is_none(), |_| true)
}
