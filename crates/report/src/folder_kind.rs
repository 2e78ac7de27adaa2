//! What a folder holds that has pages, and these pages by name.

use crate::calibration_page::CalibrationPage;
use crate::chaos_page::ChaosPage;
use crate::dataset_page::DatasetPage;
use crate::features_page::FeaturesPage;
use crate::gap_page::GapPage;
use crate::wear_page::WearPage;
use crate::{Error, Rendered};
use serde::Serialize;
use std::path::Path;
use sweep::reader::Dataset;

/// The page of every folder that has one.
const REPORT: &str = "report.html";
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
    pub fn of(folder: &Path) -> Option<Self> {
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
}
