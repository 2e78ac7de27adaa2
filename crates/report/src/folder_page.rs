//! The HTML page of a folder: what is in it that has pages.

use crate::Error;
use crate::folder_kind::FolderKind;
use crate::refreshed::{self, Row, Shown};
use askama::Template;
use serde::Serialize;

/// The content of the page.
#[derive(Clone, Debug, Serialize)]
pub struct FolderPage {
    /// The folder, as its user knows it.
    pub folder: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// What has a page, in the order of the paths.
    pub entries: Vec<FolderEntry>,
    /// Whether there are more folders than were looked into.
    pub is_cut: bool,
}

/// A folder that has a page.
#[derive(Clone, Debug, Serialize)]
pub struct FolderEntry {
    /// Its path in the folder, with `/` between the names; `.` for the folder itself.
    pub path: String,
    /// What it holds.
    pub kind: FolderKind,
    /// The address of its page, from that of the folder's.
    pub href: String,
    /// When its files were written last, `2026-11-22T14:40:23Z`; empty where the system does not know.
    pub modified: String,
    /// All cases; none of what has no cases.
    pub cases: Option<u64>,
    /// Cases that are done, failed ones included.
    pub cases_done: Option<u64>,
    /// Cases that failed.
    pub cases_failed: Option<u64>,
    /// Why it cannot be read.
    pub mistake: Option<String>,
}

#[derive(Template)]
#[template(path = "folder_page.html")]
struct View<'a> {
    page: &'a FolderPage,
    shown: Shown,
}

impl View<'_> {
    /// What the script makes new rows of.
    fn blank() -> Row {
        Row::default()
    }
}

impl FolderPage {
    /// The page as one HTML file, which asks for `index.json` beside it every few seconds.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<String, Error> {
        let shown = self.shown();
        Ok(View { page: self, shown }.render()?)
    }

    /// The content as JSON, with the texts of the page in `shown`.
    ///
    /// # Errors
    /// None in practice.
    pub fn json(&self) -> Result<String, Error> {
        refreshed::json(self, self.shown())
    }

    fn shown(&self) -> Shown {
        let mut shown = Shown::default();
        shown.texts.insert(
            "empty",
            match self.entries.is_empty() {
                true => {
                    "There is nothing here yet. What appears is shown without a reload.".to_owned()
                }
                false => String::new(),
            },
        );
        shown.texts.insert(
            "cut",
            match self.is_cut {
                true => {
                    "There are more folders than are looked into: serve one of them.".to_owned()
                }
                false => String::new(),
            },
        );
        shown.rows = self.entries.iter().map(row).collect();
        shown
    }
}

fn row(entry: &FolderEntry) -> Row {
    let count = |cases: Option<u64>| cases.map_or(String::new(), |n| text::count(n as usize));
    let kind = match &entry.mistake {
        Some(mistake) => format!("{}: {mistake}", entry.kind.name()),
        None => entry.kind.name().to_owned(),
    };
    let modified = entry.modified.replace('T', " ");
    let texts = [
        ("name", entry.path.clone()),
        ("kind", text::capitalised(&kind)),
        ("cases", count(entry.cases)),
        ("done", count(entry.cases_done)),
        ("failed", count(entry.cases_failed)),
        ("modified", modified.replace('Z', " UTC")),
    ];
    Row {
        id: entry.path.clone(),
        href: entry.href.clone(),
        texts: texts.into(),
    }
}
