//! What a folder holds that has pages, and these pages by name.

use crate::calibration_page::CalibrationPage;
use crate::chaos_page::ChaosPage;
use crate::dataset_page::DatasetPage;
use crate::features_page::FeaturesPage;
use crate::gap_page::GapPage;
use crate::wear_page::WearPage;
use crate::{Error, Rendered, write_page, write_pages};
use serde::Serialize;
use std::path::Path;
use sweep::reader::Dataset;

/// The page of every folder that has one.
pub const REPORT: &str = "report.html";
/// The further pages of a dataset.
const CHAOS: &str = "chaos.html";
const FEATURES: &str = "features.html";

/// What a folder holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FolderKind {
    /// A calibration.
    Calibration,
    /// An estimation of wear.
    Wear,
    /// An explanation of a gap.
    Explanation,
    /// A finished dataset.
    Dataset,
    /// A dataset that has been begun and has no manifest yet.
    UnderWay,
}

impl FolderKind {
    /// What `folder` holds, by its files; none where it has no page.
    pub fn detect(folder: &Path) -> Option<Self> {
        let kinds = [
            Self::Calibration,
            Self::Wear,
            Self::Explanation,
            Self::Dataset,
            Self::UnderWay,
        ];
        let has = |file: &str| folder.join(file).is_file();
        // Programs of all kinds have a manifest.
        let is_there =
            |kind: &Self| has(kind.file()) && (*kind != Self::Dataset || has("sweep.yaml"));
        kinds.into_iter().find(is_there)
    }

    /// The file, from the folder, that is written last of what it holds.
    pub fn file(self) -> &'static str {
        match self {
            Self::Calibration => calibrate::results::RESULTS,
            Self::Wear => calibrate::wear::WEAR,
            Self::Explanation => gap::results::RESULTS,
            Self::Dataset => "manifest.json",
            Self::UnderWay => "_sweep/plan.json",
        }
    }

    /// The kind in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Calibration => "calibration",
            Self::Wear => "wear",
            Self::Explanation => "explanation",
            Self::Dataset => "dataset",
            Self::UnderWay => "sweep under way",
        }
    }

    /// The names of its pages, the first of which leads to the others.
    pub fn pages(self) -> &'static [&'static str] {
        match self {
            Self::Calibration | Self::Wear | Self::Explanation => &[REPORT],
            Self::Dataset => &[REPORT, CHAOS, FEATURES],
            Self::UnderWay => &[],
        }
    }

    /// The page that the figure called `figure` stands on; none where no page can have it.
    pub fn page_of_figure(self, figure: &str) -> Option<&'static str> {
        let pages = [("dataset-", REPORT), ("chaos-", CHAOS)];
        let of = pages
            .into_iter()
            .find(|(start, _)| figure.starts_with(start));
        of.map(|(_, page)| page).filter(|_| self == Self::Dataset)
    }

    /// The page called `page` of the `folder`, made anew; none where this kind has no such page.
    ///
    /// # Errors
    /// A folder whose files are not those of its kind, or are damaged.
    pub fn render(self, folder: &Path, page: &str) -> Result<Option<Rendered>, Error> {
        if !self.pages().contains(&page) {
            return Ok(None);
        }
        let rendered = match (self, page) {
            (Self::Calibration, _) => CalibrationPage::read(folder)?.render()?,
            (Self::Wear, _) => WearPage::read(folder)?.render()?,
            (Self::Explanation, _) => GapPage::read(folder)?.render()?,
            (_, CHAOS) => ChaosPage::from_dataset(&Dataset::read(folder)?)?.render()?,
            (_, FEATURES) => FeaturesPage::from_dataset(&Dataset::read(folder)?)?.render()?,
            (_, _) => DatasetPage::from_dataset(&Dataset::read(folder)?)?.render()?,
        };
        Ok(Some(rendered))
    }

    /// Writes the page of a result of this kind in `folder` to the file `out`.
    ///
    /// # Errors
    /// A folder that holds no such result, or a page that cannot be made or written.
    pub fn write(self, folder: &Path, out: &Path) -> Result<(), Error> {
        let rendered = self.render(folder, REPORT)?;
        rendered.map_or(Ok(()), |page| write_page(out, &page.html))
    }
}

/// Writes the page of whatever `folder` holds to the file `out`; gives that of a dataset back, beside which its further
/// pages stand.
///
/// # Errors
/// A folder that holds nothing with a page, or a page that cannot be made or written.
pub fn write(folder: &Path, out: &Path) -> Result<Option<DatasetPage>, Error> {
    match FolderKind::detect(folder) {
        Some(kind) if !matches!(kind, FolderKind::Dataset | FolderKind::UnderWay) => {
            kind.write(folder, out).map(|()| None)
        }
        _ => write_dataset(folder, out).map(Some),
    }
}

/// Writes the pages of the dataset in `folder`, its own to the file `out` and last: where it is, the others are.
fn write_dataset(folder: &Path, out: &Path) -> Result<DatasetPage, Error> {
    let dataset = Dataset::read(folder)?;
    let page = DatasetPage::from_dataset(&dataset)?;
    let chaos = ChaosPage::from_dataset(&dataset)?.render()?;
    let features = FeaturesPage::from_dataset(&dataset)?.render()?;
    write_pages(&[
        (out.with_file_name(CHAOS), chaos),
        (out.with_file_name(FEATURES), features),
        (out.to_owned(), page.render()?),
    ])?;
    Ok(page)
}
