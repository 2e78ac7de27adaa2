//! What is in the folder that is served.

use crate::kept::{Kept, Stamp};
use crate::place::encoded;
use recordings::Manifest;
use report::folder_kind::FolderKind;
use report::folder_page::FolderEntry;
use report::progress_page::ProgressPage;
use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use sweep::dataset::utc;

/// Folders within folders that are looked into.
const DEEPEST: usize = 4;
/// Folders that are looked into.
const MOST_FOLDERS: usize = 5_000;
/// Folders in which results keep their data.
const DATA: [&str; 7] = [
    "signals",
    "features",
    "mcap",
    "bifurcations",
    "figures",
    "simulated",
    "baseline",
];

/// What has a page in `root`, in the order of the paths, and whether more folders are there than are looked into. Links
/// and hidden folders are passed by.
pub(crate) fn entries(root: &Path, kept: &Kept<FolderEntry>) -> (Vec<FolderEntry>, bool) {
    let mut entries = Vec::new();
    let mut left: VecDeque<Vec<String>> = VecDeque::from([Vec::new()]);
    let mut looked_into = 0;
    while let Some(names) = left.pop_front() {
        if looked_into == MOST_FOLDERS {
            entries.sort_by(by_path);
            return (entries, true);
        }
        looked_into += 1;
        let folder = root.join(names.iter().collect::<PathBuf>());
        let kind = FolderKind::detect(&folder);
        entries.extend(kind.map(|kind| entry(root, &folder, &names, kind, kept)));
        if names.len() < DEEPEST {
            left.extend(folders(&folder).into_iter().map(|name| {
                let below = names.iter().cloned().chain([name]);
                below.collect()
            }));
        }
    }
    entries.sort_by(by_path);
    (entries, false)
}

fn by_path(a: &FolderEntry, b: &FolderEntry) -> std::cmp::Ordering {
    a.path.cmp(&b.path)
}

/// The names of the folders in `folder` that results may be in, in order.
fn folders(folder: &Path) -> Vec<String> {
    let found = fs::read_dir(folder).into_iter().flatten().flatten();
    let folders = found.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    let names = folders.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names
        .filter(|name| !name.starts_with(['.', '_']) && !DATA.contains(&name.as_str()))
        .collect();
    names.sort_unstable();
    names
}

/// The entry of `folder`, which is at `names` in `root`; one whose files have not changed is not read again.
fn entry(
    root: &Path,
    folder: &Path,
    names: &[String],
    kind: FolderKind,
    kept: &Kept<FolderEntry>,
) -> FolderEntry {
    let files = match kind {
        FolderKind::UnderWay => folder.join("_sweep"),
        _ => folder.to_owned(),
    };
    let read = || read(folder, names, kind);
    let key = (folder.to_owned(), kind.name().to_owned());
    match Stamp::read(&files, root) {
        Ok(stamp) => match kept.get(&key, stamp, |_| 1, || Ok::<_, ()>(read())) {
            Ok(entry) => (*entry).clone(),
            Err(()) => read(),
        },
        Err(error) => FolderEntry {
            mistake: Some(error.to_string()),
            ..bare(folder, names, kind)
        },
    }
}

/// An entry without its cases.
fn bare(folder: &Path, names: &[String], kind: FolderKind) -> FolderEntry {
    let page = kind.pages().first().unwrap_or(&"progress.html");
    let folders: String = names
        .iter()
        .map(|name| format!("{}/", encoded(name)))
        .collect();
    let file = match kind {
        FolderKind::UnderWay => folder.join("_sweep/commits"),
        kind => folder.join(kind.file()),
    };
    let modified: Option<SystemTime> = file.metadata().and_then(|found| found.modified()).ok();
    FolderEntry {
        path: match names {
            [] => ".".to_owned(),
            names => names.join("/"),
        },
        kind,
        href: format!("/{folders}{page}"),
        modified: modified.map_or(String::new(), utc),
        cases: None,
        cases_done: None,
        cases_failed: None,
        mistake: None,
    }
}

fn read(folder: &Path, names: &[String], kind: FolderKind) -> FolderEntry {
    let bare = bare(folder, names, kind);
    // All cases, those that are done, those that failed.
    let counts = match kind {
        FolderKind::Dataset => Manifest::read(&folder.join(kind.file()))
            .map(|manifest| {
                [
                    manifest.counts.cases,
                    manifest.counts.cases,
                    manifest.counts.failed,
                ]
            })
            .map_err(|error| error.to_string()),
        FolderKind::UnderWay => ProgressPage::read(folder)
            .map(|progress| [progress.cases, progress.cases_done, progress.cases_failed])
            .map_err(|error| error.to_string()),
        _ => return bare,
    };
    match counts {
        Ok([cases, done, failed]) => FolderEntry {
            cases: Some(cases),
            cases_done: Some(done),
            cases_failed: Some(failed),
            ..bare
        },
        Err(mistake) => FolderEntry {
            mistake: Some(mistake),
            ..bare
        },
    }
}
