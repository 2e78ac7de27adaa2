//! Whether the files of a finished dataset are those that were written, from its manifest alone.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Component, Path};

use recordings::formats::parquet::rows_of_footer;
use recordings::{FileEntry, Manifest};
use serde::Serialize;

use super::check::{Check, damage_of};
use super::fault::{Damage, Fault};
use super::layout::{MANIFEST, SUMS, strays};
use super::record::checksum;
use super::store::{READERS, Store};
use crate::Error;
use crate::in_order::{in_order, pool};

/// What [`verify`] found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Verified {
    /// Files that were compared, with the manifest and `SHA256SUMS`.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
    /// Whether there is a `SHA256SUMS`, without which nothing vouches for the manifest itself.
    pub has_sums: bool,
    /// All that is wrong, by path.
    pub faults: Vec<Fault>,
}

/// Compares every file of the finished dataset at `root` with its manifest, and the manifest with
/// `SHA256SUMS`. Reads the number of rows of tables from their footers. Lists files of data that
/// are not in the manifest. Nothing is written. `progress` gets the bytes of all files and, after
/// each file, the bytes that are compared.
///
/// # Errors
/// [`Error::NoManifest`] without a manifest, [`Error::File`] if it cannot be parsed or a file cannot be read.
/// Damaged files are no error: they are in [`Verified::faults`].
pub fn verify(root: &Path, progress: &mut dyn FnMut(u64, u64)) -> Result<Verified, Error> {
    let store = Store::at(root)?;
    let no_manifest = || Error::NoManifest(root.to_owned());
    let text = store.bytes(MANIFEST)?.ok_or_else(no_manifest)?;
    let damaged = |reason: String| recordings::Error::Damaged {
        format: "a manifest",
        path: store.path(MANIFEST),
        reason,
    };
    let text = String::from_utf8(text).map_err(|error| damaged(error.to_string()))?;
    let manifest = Manifest::from_json(&text, &store.path(MANIFEST))?;
    let written = store.bytes(SUMS)?;
    let mut faults = Vec::new();
    let expected = sums(&manifest, &text);
    if written
        .as_ref()
        .is_some_and(|found| found != expected.as_bytes())
    {
        faults.push(Fault::new(SUMS, Damage::Sums));
    }
    let counted = manifest
        .counts
        .rows
        .values()
        .flat_map(|faults| faults.values());
    let counted = counted.fold(0, |sum: u64, rows| sum.saturating_add(*rows));
    let tabled = manifest
        .files
        .iter()
        .filter(|file| file.path.starts_with("features/"));
    let tabled = tabled.fold(0, |sum: u64, file| {
        sum.saturating_add(file.rows.unwrap_or(0))
    });
    if counted != tabled || manifest.counts.failed != manifest.failed.len() as u64 {
        faults.push(Fault::new(MANIFEST, Damage::Counts));
    }
    let names: BTreeSet<&str> = manifest
        .files
        .iter()
        .map(|file| file.path.as_str())
        .collect();
    if names.len() < manifest.files.len() {
        faults.push(Fault::new(MANIFEST, Damage::Twice));
    }
    let files = || manifest.files.iter();
    let bytes = files().fold(0, |sum: u64, file| sum.saturating_add(file.bytes));
    faults.extend(faults_of(&store, files(), &mut |done| {
        progress(bytes, done)
    })?);
    for path in strays(&store, |path| names.contains(path))? {
        faults.push(Fault::new(&path, Damage::Extra));
    }
    faults.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Verified {
        files: manifest.files.len() + 1 + usize::from(written.is_some()),
        bytes: bytes.saturating_add(text.len() as u64),
        has_sums: written.is_some(),
        faults,
    })
}

/// What is wrong with `files`, all of which are read. `progress` gets the number of compared bytes after
/// each file.
pub(super) fn faults_of<'a>(
    store: &Store,
    files: impl Iterator<Item = &'a FileEntry>,
    progress: &mut dyn FnMut(u64),
) -> Result<Vec<Fault>, Error> {
    let (mut faults, mut done) = (Vec::new(), 0_u64);
    in_order(
        &pool(READERS)?,
        4 * READERS,
        files,
        |file| damage_in(store, file),
        |file, damage| {
            faults.extend(damage?.map(|damage| Fault::new(&file.path, damage)));
            done = done.saturating_add(file.bytes);
            progress(done);
            Ok::<(), Error>(())
        },
    )?;
    Ok(faults)
}

/// The damage of `file` of the dataset at `root`, if any. The whole file is read.
///
/// # Errors
/// [`Error::File`] if the storage cannot be read.
pub fn damage(root: &Path, file: &FileEntry) -> Result<Option<Damage>, Error> {
    damage_in(&Store::at(root)?, file)
}

fn damage_in(store: &Store, file: &FileEntry) -> Result<Option<Damage>, Error> {
    if !is_inside(&file.path) {
        return Ok(Some(Damage::Outside));
    }
    if let Some(damage) = damage_of(store, file, Check::Sums)? {
        return Ok(Some(damage));
    }
    let Some(expected) = file.rows else {
        return Ok(None);
    };
    let read = |range| store.range(&file.path, range);
    let found = rows_of_footer(file.bytes, read, &store.path(&file.path));
    Ok(match found {
        Ok(found) if found == expected => None,
        Ok(found) => Some(Damage::Rows { found, expected }),
        Err(_) => Some(Damage::Table),
    })
}

/// Whether a path from a manifest stays within the dataset.
fn is_inside(path: &str) -> bool {
    let mut parts = Path::new(path).components();
    !path.is_empty() && parts.all(|part| matches!(part, Component::Normal(_)))
}

/// `SHA256SUMS`: every file with its checksum, the manifest included, as `sha256sum -c` reads it. A name
/// with a backslash or an end of line is escaped as `sha256sum` escapes it.
pub(super) fn sums(manifest: &Manifest, json: &str) -> String {
    let own = checksum(json);
    let files = manifest.files.iter();
    let mut files: Vec<(&str, &str)> = files
        .map(|file| (file.path.as_str(), file.sha256.as_str()))
        .chain([(MANIFEST, own.as_str())])
        .collect();
    files.sort_unstable();
    let mut text = String::new();
    for (path, sha256) in files {
        let escaped = path.replace('\\', "\\\\");
        let escaped = escaped.replace('\n', "\\n").replace('\r', "\\r");
        let mark = if escaped == path { "" } else { "\\" };
        // A `String` takes everything.
        let _ = writeln!(text, "{mark}{sha256}  {escaped}");
    }
    text
}
