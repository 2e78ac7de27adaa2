//! The lines of a text file, one at a time. They end in LF, CR LF, or CR alone where the file begins so.

use super::encoding::{self, Text};
use crate::Error;
use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

/// A longer line does not belong to a table.
const LONGEST_LINE: u64 = 1 << 20;

/// A file, and the line that was read last.
pub(super) struct Lines {
    pub path: PathBuf,
    text: Text,
    /// The last byte of a line's end.
    end: u8,
    /// Without its end.
    pub line: Vec<u8>,
    /// Number of the line, from 1.
    pub number: u64,
}

impl Lines {
    pub fn open(path: &Path) -> Result<Self, Error> {
        let mut text = encoding::open(path)?;
        let start = text.fill_buf().map_err(Error::io("read", path))?;
        let end = match start.contains(&b'\r') && !start.contains(&b'\n') {
            true => b'\r',
            false => b'\n',
        };
        Ok(Self {
            path: path.to_owned(),
            text,
            end,
            line: Vec::new(),
            number: 0,
        })
    }

    /// Reads the next line; false at the end of the file.
    pub fn advance(&mut self) -> Result<bool, Error> {
        self.line.clear();
        let read = (&mut self.text)
            .take(LONGEST_LINE)
            .read_until(self.end, &mut self.line);
        let read = read.map_err(Error::io("read", &self.path))?;
        if read == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.line.last() == Some(&self.end) {
            self.line.pop();
            self.line.pop_if(|last| *last == b'\r');
        } else if read as u64 == LONGEST_LINE {
            let reason = format!("line {} is longer than {LONGEST_LINE} bytes", self.number);
            return Err(Error::damaged("CSV", &self.path, reason));
        }
        Ok(true)
    }

    /// Reads up to the next line that is neither empty nor a comment; false at the end of the file.
    pub fn advance_to_text(&mut self) -> Result<bool, Error> {
        while self.advance()? {
            if !self.is_blank() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether the line is empty or a comment.
    pub fn is_blank(&self) -> bool {
        let text = self.line.trim_ascii();
        text.is_empty() || text.starts_with(b"#")
    }
}
