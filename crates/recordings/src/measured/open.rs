//! A file is opened by the reader of its format.

use super::format::format_of_file;
use super::{MeasuredFile, Options};
use crate::Error;
use std::path::Path;

impl MeasuredFile {
    /// Opens a file and reads its heading. The format is that of the name's ending, and for other
    /// names the one that its first bytes show.
    ///
    /// # Errors
    /// When the file is missing, empty, damaged or of another format than its name says. When
    /// a column that was asked for is not there, or the rates contradict each other.
    pub fn open(path: &Path, options: &Options) -> Result<Self, Error> {
        if let Some(rate) = options.sample_rate_hz
            && !(rate.is_finite() && rate > 0.0)
        {
            return Err(Error::SampleRate(rate));
        }
        if path.is_dir() {
            return Err(Error::damaged("a recording", path, "it is a folder"));
        }
        let found = files::open(path).and_then(|file| file.metadata());
        if found.map_err(Error::io("open", path))?.len() == 0 {
            return Err(Error::damaged("a recording", path, "it is empty"));
        }
        (format_of_file(path)?.open)(path, options)
    }
}
