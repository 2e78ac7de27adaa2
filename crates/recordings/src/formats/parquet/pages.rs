//! What the pages of a file announce, from their headers, before any is decoded.
//!
//! The footer says how long the pages of a column are together, but not how much each becomes. The decoder takes memory
//! for what a header says. The headers are structs in Thrift's compact protocol (Apache Parquet, *parquet.thrift*,
//! `PageHeader`; Apache Thrift, *Thrift Compact protocol encoding*).
//!
//! The decoder takes a field by its number, whatever type stands beside it. A field of another type than the definition's
//! would be one number here and another there, so it is damage.

use parquet::basic::Type;
use parquet::file::metadata::ParquetMetaData;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom};

/// Structs within structs of a header; two are in use.
const DEEPEST: u32 = 8;

/// What the pages announce.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Announced {
    /// Bytes that all pages decode to, eight for each value at least.
    pub(super) bytes: u64,
    /// Bytes of the longest page of texts. A text of a dictionary may come in every row, and so may one that begins as the
    /// one before. Each is as long as this at most.
    pub(super) longest_text: u64,
}

/// Reads the headers of all pages of `file`.
///
/// # Errors
/// In words, a header that is damaged.
pub(super) fn announced(file: &File, metadata: &ParquetMetaData) -> Result<Announced, String> {
    let mut announced = Announced::default();
    let mut headers = Headers {
        file: BufReader::with_capacity(1 << 9, file),
        read: 0,
    };
    for column in metadata
        .row_groups()
        .iter()
        .flat_map(|group| group.columns())
    {
        let (start, length) = column.byte_range();
        headers
            .file
            .seek(SeekFrom::Start(start))
            .map_err(|error| error.to_string())?;
        headers.read = 0;
        while headers.read < length {
            let page = headers
                .page()
                .map_err(|error| format!("the header of a page: {error}"))?;
            let bytes = page.uncompressed.max(page.values.saturating_mul(8));
            announced.bytes = announced.bytes.saturating_add(bytes);
            if column.column_type() == Type::BYTE_ARRAY {
                announced.longest_text = announced.longest_text.max(page.uncompressed);
            }
        }
    }
    Ok(announced)
}

#[derive(Default)]
struct Page {
    uncompressed: u64,
    compressed: u64,
    values: u64,
}

/// The headers of the pages of a column, one after the other.
struct Headers<'a> {
    file: BufReader<&'a File>,
    /// Bytes behind the start of the column.
    read: u64,
}

impl Headers<'_> {
    /// The next header; the file then stands behind its page.
    fn page(&mut self) -> io::Result<Page> {
        let mut page = Page::default();
        self.fields(PAGE, &mut |headers, field, kind| {
            match field {
                2 => page.uncompressed = headers.size()?,
                3 => page.compressed = headers.size()?,
                5..=8 => {
                    let types = OF_PAGE[field as usize - 5];
                    headers.fields(types, &mut |headers, field, kind| match field {
                        1 => {
                            page.values = headers.size()?;
                            Ok(())
                        }
                        _ => headers.skip(kind, 0),
                    })?
                }
                _ => headers.skip(kind, 0)?,
            }
            Ok(())
        })?;
        let compressed = i64::try_from(page.compressed).map_err(|_| damaged())?;
        self.file.seek_relative(compressed)?;
        self.read += page.compressed;
        Ok(page)
    }

    /// Hands every field of a struct to `each`, which reads its value: number and type. The types are those of `types`, from
    /// field 1 on.
    fn fields(
        &mut self,
        types: &[u8],
        each: &mut dyn FnMut(&mut Self, i64, u8) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut field = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(());
            }
            field = match head >> 4 {
                0 => self.signed()?,
                step => field + i64::from(step),
            };
            let kind = match head & 0xf {
                TRUE => FALSE,
                kind => kind,
            };
            let expected = usize::try_from(field - 1).ok().and_then(|i| types.get(i));
            if expected.is_none_or(|expected| ![kind, ANY].contains(expected)) {
                return Err(damaged());
            }
            each(self, field, kind)?;
        }
    }

    fn skip(&mut self, kind: u8, depth: u32) -> io::Result<()> {
        if depth > DEEPEST {
            return Err(damaged());
        }
        match kind {
            // The truth of a field stands in its type.
            FALSE => Ok(()),
            I32 | I64 => self.signed().map(drop),
            BINARY => {
                let length = self.unsigned()?;
                self.over(length)
            }
            STRUCT => self.fields(STATISTICS, &mut |headers, _, kind| {
                headers.skip(kind, depth + 1)
            }),
            _ => Err(damaged()),
        }
    }

    fn over(&mut self, bytes: u64) -> io::Result<()> {
        let skipped = io::copy(&mut self.file.by_ref().take(bytes), &mut io::sink())?;
        self.read += skipped;
        match skipped == bytes {
            true => Ok(()),
            false => Err(ErrorKind::UnexpectedEof.into()),
        }
    }

    fn byte(&mut self) -> io::Result<u8> {
        let byte = self.file.fill_buf()?.first().copied();
        let byte = byte.ok_or(ErrorKind::UnexpectedEof)?;
        self.file.consume(1);
        self.read += 1;
        Ok(byte)
    }

    /// A number in groups of seven bits, the last of which comes without its eighth.
    fn unsigned(&mut self) -> io::Result<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(damaged())
    }

    fn signed(&mut self) -> io::Result<i64> {
        let folded = self.unsigned()?;
        Ok((folded >> 1) as i64 ^ -((folded & 1) as i64))
    }

    fn size(&mut self) -> io::Result<u64> {
        u64::try_from(self.signed()?).map_err(|_| damaged())
    }
}

const TRUE: u8 = 1;
const FALSE: u8 = 2;
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const STRUCT: u8 = 12;
/// In a list of types: whatever stands there is skipped by its own type, here as in the decoder.
const ANY: u8 = 0;

/// The types of `PageHeader`: type, two sizes, sum, then the header of one kind of page.
const PAGE: &[u8] = &[I32, I32, I32, I32, STRUCT, STRUCT, STRUCT, STRUCT];
/// Those of the header of a page of data, of an index, of a dictionary, of a page of data of version 2. Where there are
/// values, their number comes first.
const OF_PAGE: [&[u8]; 4] = [
    &[I32, I32, I32, I32, STRUCT],
    &[],
    &[I32, I32, FALSE],
    &[I32, I32, I32, I32, I32, I32, FALSE, STRUCT],
];
/// Those of `Statistics`, which the decoder skips, with what a later version may add.
const STATISTICS: &[u8] = &[ANY; 16];

fn damaged() -> io::Error {
    io::Error::new(ErrorKind::InvalidData, "it is damaged")
}
