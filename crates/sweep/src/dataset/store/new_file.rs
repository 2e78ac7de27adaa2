//! A file of a dataset under way, wherever that is kept.

use std::io::{self, Write};

use recordings::{FileRecord, WholeFile};

#[cfg(feature = "s3")]
use super::bucket::ObjectFile;
use crate::Error;

/// A file that is not visible before [`NewFile::commit`], with its checksum.
pub(in crate::dataset) enum NewFile {
    /// In a folder.
    File(WholeFile),
    /// In object storage.
    #[cfg(feature = "s3")]
    Object(Box<ObjectFile>),
}

impl NewFile {
    /// What has been written so far.
    pub(in crate::dataset) fn record(&self) -> FileRecord {
        match self {
            Self::File(file) => file.record(),
            #[cfg(feature = "s3")]
            Self::Object(file) => file.record(),
        }
    }

    /// Lets everybody see it, in place of what stood there.
    pub(in crate::dataset) fn commit(self) -> Result<FileRecord, Error> {
        match self {
            Self::File(file) => Ok(file.commit()?),
            #[cfg(feature = "s3")]
            Self::Object(file) => file.commit(),
        }
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            #[cfg(feature = "s3")]
            Self::Object(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            #[cfg(feature = "s3")]
            Self::Object(file) => file.flush(),
        }
    }
}
