//! What is removed of a dataset: what this program wrote, and nothing else.

use std::collections::BTreeSet;
use std::fs;
use std::time::Duration;

use recordings::{FileEntry, Manifest};
use serde::Deserialize;

use super::delta::VERSION;
use super::layout::{CALIBRATION, DELTA_LOG, FILES, FOLDERS, PLAN, WORK, strays};
use super::lock::alone;
use super::output::Output;
use super::store::{make, remove};
use crate::Error;
use crate::split::Split;

/// What `crosshead report` makes of a dataset; figures are the SVG files with these beginnings.
const PAGES: [&str; 3] = ["report.html", "chaos.html", "features.html"];
const FIGURES: [&str; 2] = ["dataset-", "chaos-"];
/// Files in `_sweep/tmp` that are younger stay in any case.
const DAY: Duration = Duration::from_secs(24 * 60 * 60);

/// The files of a record of a shard or of a diagram.
#[derive(Deserialize)]
struct Files {
    #[serde(default)]
    files: Vec<FileEntry>,
    #[serde(default)]
    file: Option<FileEntry>,
}

impl Output {
    /// Removes a dataset; its calibration stays where that is asked for. Files among the data that it
    /// did not write stay, and are named.
    pub(super) fn clear(&self, keep_calibration: bool) -> Result<(), Error> {
        let written = self.written()?;
        let own = |path: &str| written.contains(path) || has_own_name(path);
        // The manifest goes first: without it the folder is not a complete dataset.
        for file in FILES.into_iter().rev().chain([PLAN]).chain(PAGES) {
            remove(&self.path(file), |path| fs::remove_file(path))?;
        }
        for folder in FOLDERS {
            for name in self.store.names(folder)? {
                let path = format!("{folder}/{name}");
                if own(&path) {
                    remove(&self.path(&path), |path| fs::remove_file(path))?;
                }
            }
            let log = self.path(&format!("{folder}/{}", DELTA_LOG));
            remove(&log.join(VERSION), |path| fs::remove_file(path))?;
            // Folders that still have something in them are not removed.
            let _ = fs::remove_dir(log);
            let _ = fs::remove_dir(self.path(folder));
        }
        for path in strays(&self.store, |_| false)? {
            let path = self.path(&path);
            self.warn(format!(
                "`{}` was not written by this program, and stays among the data",
                path.display()
            ));
        }
        for folder in WORK {
            remove(&self.path(folder), |path| fs::remove_dir_all(path))?;
        }
        self.clear_figures()?;
        if !keep_calibration {
            self.clear_calibration()?;
        }
        WORK.iter().try_for_each(|folder| make(&self.path(folder)))
    }

    /// The files that the manifest or a record has.
    fn written(&self) -> Result<BTreeSet<String>, Error> {
        let manifest = Manifest::read(&self.path("manifest.json"));
        let mut files = manifest.map_or_else(|_| Vec::new(), |manifest| manifest.files);
        for name in self.store.names("_sweep/commits")? {
            let record = self.store.bytes(&format!("_sweep/commits/{name}"))?;
            let record = record.and_then(|r| serde_json::from_slice::<Files>(&r).ok());
            if let Some(record) = record {
                files.extend(record.files.into_iter().chain(record.file));
            }
        }
        Ok(files.into_iter().map(|file| file.path).collect())
    }

    pub(super) fn clear_calibration(&self) -> Result<(), Error> {
        remove(&self.path(CALIBRATION), |path| fs::remove_dir_all(path))
    }

    /// Removes the figures of a report; other files in their folder stay.
    fn clear_figures(&self) -> Result<(), Error> {
        let folder = self.path("figures");
        for name in self.store.names("figures")? {
            if name.ends_with(".svg") && FIGURES.iter().any(|start| name.starts_with(start)) {
                remove(&folder.join(name), |path| fs::remove_file(path))?;
            }
        }
        // A folder that still has something in it is not removed.
        let _ = fs::remove_dir(&folder);
        Ok(())
    }

    /// Removes what crashes left in `_sweep/tmp` a day ago or earlier, by the clock of the storage,
    /// unless another process is at work here. Buckets have rules of their own for that.
    ///
    /// # Errors
    /// Where it cannot be removed.
    pub(super) fn tidy(&self) -> Result<(), Error> {
        let Some(root) = self.store.folder() else {
            return Ok(());
        };
        let names = self.store.names("_sweep/tmp")?;
        if names.is_empty() {
            return Ok(());
        }
        alone(root, &self.lock, || {
            let now = self.store.now()?;
            for name in names {
                let path = format!("_sweep/tmp/{name}");
                let modified = self.store.modified(&path)?;
                let age = modified.and_then(|modified| now.duration_since(modified).ok());
                if age.is_some_and(|age| age > DAY) {
                    self.store.remove(&path)?;
                }
            }
            Ok(())
        })
    }
}

/// Whether `path` is a name that this program gives to a file of a shard: one may have been killed
/// between the file and its record.
fn has_own_name(path: &str) -> bool {
    let digits = |text: &str| text.len() >= 5 && text.bytes().all(|byte| byte.is_ascii_digit());
    let Some((folder, name)) = path.split_once('/') else {
        return false;
    };
    match folder {
        "signals" | "features" => {
            let name = name.strip_suffix(".parquet");
            let parts = name.and_then(|name| {
                let (split, numbers) = name.split_once('-')?;
                let (shard, shards) = numbers.split_once("-of-")?;
                Some((split, shard, shards))
            });
            parts.is_some_and(|(split, shard, shards)| {
                let is_split = Split::ALL.iter().any(|own| own.name() == split);
                is_split && digits(shard) && digits(shards)
            })
        }
        "mcap" => {
            let name = name.strip_suffix(".mcap");
            name.and_then(|name| name.strip_prefix("case-"))
                .is_some_and(digits)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::has_own_name;

    #[test]
    fn names_of_shards_are_known() {
        for own in [
            "signals/train-00000-of-00003.parquet",
            "features/validation-123456-of-200000.parquet",
            "mcap/case-000012.mcap",
        ] {
            assert!(has_own_name(own), "{own}");
        }
        for other in [
            "signals/mine.parquet",
            "signals/train-00000-of-00003.parquet.bak",
            "signals/training-00000-of-00003.parquet",
            "mcap/case-of-wine.mcap",
            "bifurcations/train-00000-of-00003.parquet",
            "notes.txt",
        ] {
            assert!(!has_own_name(other), "{other}");
        }
    }
}
