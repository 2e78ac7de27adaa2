//! The pages of results, and cases that are simulated again.

use crate::answer::Answer;
use crate::kept::{Kept, Key, Stamp};
use hyper::StatusCode;
use recordings::{FailedCase, Manifest};
use report::case_view::CaseView;
use report::folder_kind::FolderKind;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use sweep::Plan;
use sweep::dataset::{Output, status};

/// Bytes of pages, figures and cases that are kept.
const MOST_BYTES: usize = 256 << 20;
/// Plans that are kept: one of a dataset whose cases are looked at.
const MOST_PLANS: usize = 8;

/// A page and its figures.
pub(crate) struct Page {
    answer: Answer,
    figures: BTreeMap<String, Answer>,
}

impl Page {
    fn size(&self) -> usize {
        let figures = self.figures.values().map(Answer::size);
        self.answer.size() + figures.sum::<usize>()
    }

    /// The page, or its figure of this name.
    fn part(&self, figure: Option<&str>) -> Answer {
        match figure {
            None => self.answer.clone(),
            Some(name) => self
                .figures
                .get(name)
                .cloned()
                .unwrap_or_else(Answer::nothing),
        }
    }
}

/// A folder of a result.
pub(crate) struct Found<'a> {
    /// Its path, as its user knows it.
    pub(crate) folder: &'a Path,
    /// What it holds.
    pub(crate) kind: FolderKind,
    /// Its files.
    pub(crate) stamp: Stamp,
}

/// What was made of results.
pub(crate) struct Pages {
    pages: Kept<Page>,
    plans: Kept<Plan>,
}

impl Pages {
    pub(crate) fn new() -> Self {
        Self {
            pages: Kept::new(MOST_BYTES),
            plans: Kept::new(MOST_PLANS),
        }
    }

    /// What is kept under `name`: the page, or its figure.
    pub(crate) fn find(&self, of: &Found, name: &str, figure: Option<&str>) -> Option<Answer> {
        let page = self.pages.find(&key(of, name), &of.stamp)?;
        Some(page.part(figure))
    }

    /// The page `name`, or its figure, made of the files where it is not kept.
    pub(crate) fn page(&self, of: &Found, name: &str, figure: Option<&str>) -> Answer {
        self.get(of, name, figure, || {
            let rendered = of.kind.render(of.folder, name).map_err(Answer::failure)?;
            let rendered = rendered.ok_or_else(Answer::nothing)?;
            let figures = rendered.figures.into_iter();
            Ok(Page {
                answer: Answer::page(rendered.html),
                figures: figures
                    .map(|figure| (figure.name, Answer::svg(figure.svg)))
                    .collect(),
            })
        })
    }

    /// The case called `case` of a dataset or of a sweep under way; `stop` ends its simulation.
    pub(crate) fn case(&self, of: &Found, case: &str, stop: &AtomicBool) -> Answer {
        self.get(of, &case_name(case), None, || {
            let sweep = of.folder.join("sweep.yaml");
            let plan = self.plan(of, &sweep)?;
            let index = plan.case_index(case).ok_or_else(|| {
                let last = plan.case_id(plan.cases() - 1);
                let why = format!("{case}: expected a case from {} to {last}", plan.case_id(0));
                Answer::refusal(StatusCode::NOT_FOUND, why)
            })?;
            // A case that its process died of would end this one, too.
            if let Some(failed) = failed(of, case)? {
                let again = failed.command_in(of.folder);
                let why = format!("{case} failed: {}\nagain: {again}", failed.reason);
                return Err(Answer::failure(why));
            }
            let mut watch = |_| match stop.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let view = CaseView::simulate(&plan, &sweep, index, &mut watch);
            let fragment = view
                .and_then(|view| view.render())
                .map_err(Answer::failure)?;
            Ok(Page {
                answer: Answer::fragment(fragment),
                figures: BTreeMap::new(),
            })
        })
    }

    fn get(
        &self,
        of: &Found,
        name: &str,
        figure: Option<&str>,
        make: impl FnOnce() -> Result<Page, Answer>,
    ) -> Answer {
        let page = self
            .pages
            .get(&key(of, name), of.stamp.clone(), Page::size, make);
        page.map_or_else(|refused| refused, |page| page.part(figure))
    }

    fn plan(&self, of: &Found, sweep: &Path) -> Result<Arc<Plan>, Answer> {
        let read = || Plan::read(sweep).map_err(Answer::failure);
        self.plans
            .get(&key(of, "sweep.yaml"), of.stamp.clone(), |_| 1, read)
    }
}

/// The name under which a case is kept.
pub(crate) fn case_name(case: &str) -> String {
    format!("cases/{case}")
}

fn key(of: &Found, name: &str) -> Key {
    (of.folder.to_owned(), name.to_owned())
}

/// The record of the case, if it has failed.
fn failed(of: &Found, case: &str) -> Result<Option<FailedCase>, Answer> {
    let failed = match of.kind {
        FolderKind::UnderWay => {
            let (output, plan) = Output::open_read_only(of.folder).map_err(Answer::failure)?;
            status(&output, &plan, false)
                .map_err(Answer::failure)?
                .failed
        }
        kind => {
            Manifest::read(&of.folder.join(kind.file()))
                .map_err(Answer::failure)?
                .failed
        }
    };
    Ok(failed.into_iter().find(|failed| failed.case_id == case))
}
