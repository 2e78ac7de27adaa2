//! What is answered to each path.

use crate::answer::Answer;
use crate::index::entries;
use crate::kept::{Kept, Stamp};
use crate::pages::{Found, Pages, case_name};
use crate::place::{Place, Wanted};
use report::folder_kind::FolderKind;
use report::folder_page::{FolderEntry, FolderPage};
use report::progress_page::ProgressPage;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Entries of the index that are kept.
const MOST_ENTRIES: usize = 10_000;
/// The page of a sweep under way.
const PROGRESS: &str = "progress.html";

/// The folder that is served, and what was made of it.
pub(crate) struct Site {
    /// The folder, without links on the way.
    root: PathBuf,
    /// The folder, as its user knows it.
    named: PathBuf,
    entries: Kept<FolderEntry>,
    pages: Pages,
    /// Ends what is under way.
    stop: Arc<AtomicBool>,
}

/// Whether an answer is at hand.
pub(crate) enum AtHand {
    /// It is.
    Yes(Answer),
    /// It takes a while: [`Site::make`] makes it.
    No,
}

impl Site {
    /// The site of the folder `root`, which its user calls `named`.
    pub(crate) fn new(root: PathBuf, named: PathBuf, stop: Arc<AtomicBool>) -> Self {
        Self {
            root,
            named,
            entries: Kept::new(MOST_ENTRIES),
            pages: Pages::new(),
            stop,
        }
    }

    /// What takes no time: the index, progress, what is kept, and what is not there.
    pub(crate) fn find(&self, place: &Place) -> AtHand {
        let answer = match &place.wanted {
            Wanted::Index => self.index(),
            Wanted::IndexJson => or_failure(self.folder_page().json().map(Answer::json)),
            _ => match self.at(place, |found| self.find_in(place, found)) {
                Ok(found) => return found,
                Err(refused) => refused,
            },
        };
        AtHand::Yes(answer)
    }

    /// What [`Self::find`] does not have.
    pub(crate) fn make(&self, place: &Place) -> Answer {
        let made = self.at(place, |of| match &place.wanted {
            Wanted::Page(page) => self.pages.page(of, page, None),
            Wanted::Figure(figure) => match of.kind.page_of_figure(figure) {
                Some(page) => self.pages.page(of, page, Some(figure)),
                None => Answer::nothing(),
            },
            Wanted::Case(case) => self.pages.case(of, case, &self.stop),
            _ => Answer::nothing(),
        });
        made.unwrap_or_else(|refused| refused)
    }

    /// What `answer` gives for the result at a place.
    fn at<T>(&self, place: &Place, answer: impl FnOnce(&Found) -> T) -> Result<T, Answer> {
        let folder = place.folder(&self.root).ok_or_else(Answer::nothing)?;
        let kind = FolderKind::detect(&folder).ok_or_else(Answer::nothing)?;
        let stamp = Stamp::read(&folder, &self.root).map_err(Answer::failure)?;
        let named = self.named.join(place.folders.iter().collect::<PathBuf>());
        Ok(answer(&Found {
            folder: &named,
            kind,
            stamp,
        }))
    }

    fn find_in(&self, place: &Place, of: &Found) -> AtHand {
        let first = of.kind.pages().first().unwrap_or(&PROGRESS);
        let kept = match &place.wanted {
            Wanted::Folder => Some(Answer::elsewhere(place.address(first))),
            Wanted::Progress => Some(progress(of.folder, |page| page.render().map(Answer::page))),
            Wanted::ProgressJson => Some(progress(of.folder, |page| page.json().map(Answer::json))),
            Wanted::Page(page) if !of.kind.pages().contains(&page.as_str()) => {
                Some(match of.kind {
                    // The address of a page that is there when the sweep is complete.
                    FolderKind::UnderWay
                        if FolderKind::Dataset.pages().contains(&page.as_str()) =>
                    {
                        Answer::elsewhere(place.address(first))
                    }
                    _ => Answer::nothing(),
                })
            }
            Wanted::Page(page) => self.pages.find(of, page, None),
            Wanted::Figure(figure) => {
                let page = of.kind.page_of_figure(figure);
                page.map_or_else(
                    || Some(Answer::nothing()),
                    |page| self.pages.find(of, page, Some(figure)),
                )
            }
            Wanted::Case(case) => match of.kind {
                FolderKind::Dataset | FolderKind::UnderWay => {
                    self.pages.find(of, &case_name(case), None)
                }
                _ => Some(Answer::nothing()),
            },
            Wanted::Index | Wanted::IndexJson => Some(Answer::nothing()),
        };
        kept.map_or(AtHand::No, AtHand::Yes)
    }

    fn index(&self) -> Answer {
        or_failure(self.folder_page().render().map(Answer::page))
    }

    fn folder_page(&self) -> FolderPage {
        let (entries, is_cut) = entries(&self.root, &self.entries);
        FolderPage {
            folder: self.named.display().to_string(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            entries,
            is_cut,
        }
    }
}

/// The progress of the sweep in `folder`; there is none where no sweep was planned.
fn progress(
    folder: &Path,
    show: impl FnOnce(ProgressPage) -> Result<Answer, report::Error>,
) -> Answer {
    if !folder.join(FolderKind::UnderWay.file()).is_file() {
        return Answer::nothing();
    }
    or_failure(ProgressPage::read(folder).and_then(show))
}

fn or_failure(answer: Result<Answer, report::Error>) -> Answer {
    answer.unwrap_or_else(Answer::failure)
}
