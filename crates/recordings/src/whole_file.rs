//! A file that appears whole or not at all.

use crate::Error;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file under way: written under a temporary name, and given its own by [`WholeFile::commit`].
///
/// The temporary name ends in `.part` and lies outside the folders of data, on the same file
/// system. Readers that take every file of a folder (polars and DuckDB read hidden ones too) must
/// not meet a half-written one. The checksum is taken on the way, so that nothing is read twice.
/// Dropped before the commit, the temporary file is removed.
#[derive(Debug)]
pub struct WholeFile {
    out: BufWriter<File>,
    temporary: PathBuf,
    destination: PathBuf,
    hash: Sha256,
    bytes: u64,
    committed: bool,
}

/// A file that is there: how long it is, and its checksum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRecord {
    /// Length in bytes.
    pub bytes: u64,
    /// SHA-256 of the content, in hexadecimal.
    pub sha256: String,
}

impl WholeFile {
    /// Starts a file that will be called `destination`, under the name `temporary` (`*.part`; what
    /// stood there before is overwritten). Both folders must be there.
    ///
    /// # Errors
    /// When the temporary name does not end in `.part`, or the file cannot be created.
    pub fn create(temporary: &Path, destination: &Path) -> Result<Self, Error> {
        if temporary
            .extension()
            .is_none_or(|extension| extension != "part")
        {
            return Err(Error::TemporaryName(temporary.to_owned()));
        }
        let file = File::create(temporary).map_err(Error::io("create", temporary))?;
        Ok(Self {
            out: BufWriter::new(file),
            temporary: temporary.to_owned(),
            destination: destination.to_owned(),
            hash: Sha256::new(),
            bytes: 0,
            committed: false,
        })
    }

    /// Writes `text` into the file `destination`. Its last line ends in a line break, as all others do.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(destination: &Path, text: &str) -> Result<FileRecord, Error> {
        let mut file = Self::create(&destination.with_extension("part"), destination)?;
        file.write_all(text.as_bytes()).map_err(Error::Write)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(Error::Write)?;
        }
        file.commit()
    }

    /// What has been written so far.
    pub fn record(&self) -> FileRecord {
        FileRecord {
            bytes: self.bytes,
            sha256: format!("{:x}", self.hash.clone().finalize()),
        }
    }

    /// Hands everything to the disk and gives the file its name, in place of any file of that name.
    ///
    /// # Errors
    /// When the disk is full or the file cannot be renamed. There is then no file of that name, or
    /// still the one from before. When the folder cannot be synced the file is there, but a power
    /// failure could take it away.
    pub fn commit(mut self) -> Result<FileRecord, Error> {
        let written = self
            .out
            .flush()
            .and_then(|()| self.out.get_ref().sync_all());
        written.map_err(Error::io("write", &self.temporary))?;
        fs::rename(&self.temporary, &self.destination)
            .map_err(Error::io("rename the finished file to", &self.destination))?;
        self.committed = true;
        sync_folder(&self.destination)?;
        Ok(self.record())
    }

    /// The same error with the name of the file.
    fn named(&self, error: io::Error) -> io::Error {
        if error.kind() == io::ErrorKind::Interrupted {
            return error;
        }
        let text = format!("cannot write `{}`: {error}", self.temporary.display());
        io::Error::new(error.kind(), text)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes).map_err(|error| self.named(error))?;
        self.hash.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush().map_err(|error| self.named(error))
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if !self.committed {
            // A failure here cannot be reported; the name shows that it is no data.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Hands the folder of `file` to the disk: a new name, by a rename or a link, is there once its folder is.
///
/// # Errors
/// When the folder cannot be synced.
#[cfg(unix)]
pub fn sync_folder(file: &Path) -> Result<(), Error> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .map_err(Error::io("write", folder))
}

/// Folders cannot be opened here, and the file system orders renames itself.
#[cfg(not(unix))]
pub fn sync_folder(_: &Path) -> Result<(), Error> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn the_record_is_that_of_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let destination = folder.path().join("a.parquet");
        fs::write(&destination, "the one before").unwrap();
        let mut file = WholeFile::create(&folder.path().join("a.part"), &destination).unwrap();
        file.write_all(b"ab").unwrap();
        file.write_all(b"c").unwrap();
        assert_eq!(fs::read(&destination).unwrap(), b"the one before");
        let record = file.commit().unwrap();
        // The checksum of "abc" is the example of FIPS 180-2, appendix B.1.
        let sha256 = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad".to_owned();
        assert_eq!(record, FileRecord { bytes: 3, sha256 });
        assert_eq!(fs::read(&destination).unwrap(), b"abc");
        assert_eq!(names(folder.path()), ["a.parquet"]);
    }

    #[test]
    fn the_last_line_of_a_text_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        for (text, expected) in [("{}", "{}\n"), ("{}\n", "{}\n"), ("", "")] {
            WholeFile::write(&path, text).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), expected);
        }
    }

    #[test]
    fn a_file_given_up_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut file =
            WholeFile::create(&folder.path().join("a.part"), &folder.path().join("a")).unwrap();
        file.write_all(&[0; 1 << 20]).unwrap();
        drop(file);
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_temporary_file_is_never_called_data() {
        let folder = tempfile::tempdir().unwrap();
        let temporary = folder.path().join(".a.parquet");
        let refused = WholeFile::create(&temporary, &folder.path().join("a.parquet")).unwrap_err();
        assert!(matches!(refused, Error::TemporaryName(path) if path == temporary));
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_file_that_cannot_be_renamed_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let destination = folder.path().join("missing").join("a");
        let file = WholeFile::create(&folder.path().join("a.part"), &destination).unwrap();
        let message = file.commit().unwrap_err().to_string();
        assert!(
            message.contains("cannot rename the finished file to"),
            "{message}"
        );
        assert!(names(folder.path()).is_empty());
    }

    /// Every write to the device `/dev/full` ends as on a full disk.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_named_and_leaves_nothing() {
        use crate::formats::{csv, mcap, parquet};
        use crate::{Column, Data, Kind, Schema, Table};

        let folder = tempfile::tempdir().unwrap();
        let temporary = folder.path().join("a.part");
        let destination = folder.path().join("a");
        let create = || {
            let _ = fs::remove_file(&temporary);
            std::os::unix::fs::symlink("/dev/full", &temporary).unwrap();
            WholeFile::create(&temporary, &destination).unwrap()
        };

        // More than every buffer on the way, of numbers that do not compress.
        let noise = |i: u32| f32::from_bits(0x3f80_0000 | (i.wrapping_mul(2_654_435_761) >> 9));
        let samples: Vec<f32> = (0..2_000_000).map(noise).collect();
        let reals = samples.iter().map(|x| Some(f64::from(*x))).collect();
        let column = |kind| Schema::new(vec![Column::new("x", kind, "")]).unwrap();
        let recording = Table::from_columns(
            column(Kind::Samples),
            vec![Data::Samples(vec![Some(samples.clone())])],
        );
        let plain = Table::from_columns(column(Kind::Real), vec![Data::Real(reals)]);
        let channel = mcap::Channel {
            name: "x",
            unit: "",
            samples: &samples,
        };
        let case = mcap::Recording {
            sample_rate_hz: 1e4,
            channels: &[channel],
            labels: &Default::default(),
            sweep_yaml: "",
        };
        let mut last = create();
        last.write_all(b"less than a buffer").unwrap();
        for error in [
            parquet::write_table(create(), &recording.unwrap(), 1).unwrap_err(),
            csv::write_table(create(), &plain.unwrap()).unwrap_err(),
            mcap::write(create(), &case).unwrap_err(),
            last.commit().unwrap_err(),
        ] {
            assert!(error.is_storage_full(), "{error:?}");
            let message = error.to_string();
            assert!(
                message.contains("a.part") && message.contains("No space left"),
                "{message}"
            );
        }
        assert!(names(folder.path()).is_empty());
    }
}
