//! Pages and their figures as files.

use crate::{Error, Rendered};
use recordings::WholeFile;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Writes the pages of a dataset, each whole or not at all, in this order, and their figures into
/// `figures/` beside the last of them. Figures of earlier pages that these do not have are removed.
///
/// # Errors
/// A file that cannot be written.
pub fn write_pages(pages: &[(PathBuf, Rendered)]) -> Result<(), Error> {
    let Some((last, _)) = pages.last() else {
        return Ok(());
    };
    let folder = last.with_file_name("figures");
    let figures = || pages.iter().flat_map(|(_, page)| &page.figures);
    if figures().next().is_some() {
        make(&folder)?;
    }
    for figure in figures() {
        write_page(&folder.join(&figure.name), &figure.svg)?;
    }
    for name in ours(&folder)? {
        if !figures().any(|figure| figure.name == name) {
            let path = folder.join(name);
            fs::remove_file(&path).map_err(|error| Error::Unwritten { path, error })?;
        }
    }
    for (path, page) in pages {
        write_page(path, &page.html)?;
    }
    Ok(())
}

/// Writes a page or a figure whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write_page(out: &Path, text: &str) -> Result<(), Error> {
    WholeFile::write(out, text).map(drop).map_err(Error::Write)
}

/// The names of the figures in the folder that a report has written.
fn ours(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unwritten(folder, error)),
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

fn make(folder: &Path) -> Result<(), Error> {
    match fs::create_dir(folder) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(unwritten(folder, error)),
        _ => Ok(()),
    }
}

fn unwritten(path: &Path, error: std::io::Error) -> Error {
    let path = path.to_owned();
    Error::Unwritten { path, error }
}
