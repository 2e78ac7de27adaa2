//! The pages and their figures as files.

use crate::Failure;
use ::report::Rendered;
use recordings::WholeFile;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where the pages of a dataset stand: all in one folder, the figures in `figures/` below it.
pub(super) struct Place {
    /// The page of the dataset.
    pub(super) dataset: PathBuf,
}

impl Place {
    /// The file of this name beside the page of the dataset.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.dataset.with_file_name(name)
    }

    /// Writes the pages, each whole or not at all, the one of the dataset last: where it is, the
    /// others are. Figures of earlier pages that these do not have are removed.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn write(&self, pages: &[(PathBuf, Rendered)]) -> Result<(), Failure> {
        let folder = self.beside("figures");
        let figures = || pages.iter().flat_map(|(_, page)| &page.figures);
        if figures().next().is_some() {
            make(&folder)?;
        }
        for figure in figures() {
            write(&folder.join(&figure.name), &figure.svg)?;
        }
        for name in ours(&folder)? {
            if !figures().any(|figure| figure.name == name) {
                let path = folder.join(name);
                fs::remove_file(&path).map_err(|error| Failure::unwritten(&path, error))?;
            }
        }
        for (path, page) in pages {
            write(path, &page.html)?;
        }
        Ok(())
    }
}

/// The names of the figures in the folder that a report has written.
fn ours(folder: &Path) -> Result<Vec<String>, Failure> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(Failure::unwritten(folder, error)),
    };
    let names = entries
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok());
    let written = |name: &String| {
        let rest = name
            .strip_prefix("dataset-")
            .or(name.strip_prefix("chaos-"));
        name.ends_with(".svg")
            && rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    Ok(names.filter(written).collect())
}

fn make(folder: &Path) -> Result<(), Failure> {
    match fs::create_dir(folder) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => {
            Err(Failure::unwritten(folder, error))
        }
        _ => Ok(()),
    }
}

/// Writes a file whole or not at all.
pub(super) fn write(out: &Path, text: &str) -> Result<(), Failure> {
    let written = WholeFile::create(&out.with_extension("part"), out).and_then(|mut file| {
        file.write_all(text.as_bytes())
            .map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
