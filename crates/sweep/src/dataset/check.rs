//! A file of a dataset compared with its record.

use recordings::FileEntry;

use super::fault::Damage;
use super::store::Store;
use crate::Error;

/// How much of the files of a record is compared with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Check {
    /// Their lengths.
    Lengths,
    /// Their checksums: everything is read.
    Sums,
    /// Checksums in a folder. A bucket keeps checksums of its own, and reading it back takes as long
    /// as writing it did: their lengths there.
    Resume,
}

/// What is wrong with a file, if anything is.
pub(super) fn damage_of(
    store: &Store,
    file: &FileEntry,
    check: Check,
) -> Result<Option<Damage>, Error> {
    let expected = file.bytes;
    match store.length(&file.path)? {
        None => return Ok(Some(Damage::Missing)),
        Some(found) if found != expected => return Ok(Some(Damage::Length { found, expected })),
        Some(_) => {}
    }
    if check == Check::Lengths || check == Check::Resume && store.folder().is_none() {
        return Ok(None);
    }
    let found = store.record(&file.path)?;
    let is_same = found.is_some_and(|found| found.sha256 == file.sha256);
    Ok((!is_same).then_some(Damage::Content))
}
