//! The HTML page of a dataset.
//!
//! [`DatasetPage::from_dataset`] reads the tables of the dataset. [`DatasetPage::render`] is one
//! file with its styles and figures inside, for a browser or a printer. Its size is bounded for any
//! dataset: figures thin their lines, and long tables end with a count of the rows that are left
//! out.

mod captions;
mod comparison;
mod diagnosis;
mod distributions;
mod examples;
mod operation;
mod page;
mod portrait;

use crate::Column;
use crate::case_table::CaseTable;
use crate::class_colour::class_colour;
use classify::{Baseline, RankedFeature};
use figure::Colour;
use recordings::{CaseWarning, FailedCase};
use study::counts::{FaultCount, ParameterRange};
use study::examples::ClassExample;
use study::features::{Feature, FeatureRow};
use study::grid::ClearanceGrids;
use study::operation::Operation;
use study::random::RandomSweep;
use study::ranking::FeatureByClass;

/// The content of the page. Numbers are SI; labels and names are as in the data.
#[derive(Clone, Debug)]
pub struct DatasetPage {
    /// Name of the dataset.
    pub name: String,
    /// What it is, in a sentence or two.
    pub about: String,
    /// Version of the program that wrote it.
    pub version: String,
    /// Seed of the sweep.
    pub seed: u64,
    /// Rate at which the sensors are recorded, Hz.
    pub sample_rate_hz: f64,
    /// Samples in a revolution, where the channels are resampled over the crank angle.
    pub samples_per_revolution: Option<u32>,
    /// Revolutions of the crank in one window.
    pub revolutions_per_window: u32,
    /// Fewest and most samples in one window; they differ where the speed does.
    pub samples_per_window: (usize, usize),
    /// The channels, by name.
    pub channels: Vec<String>,
    /// The machine's joints, in their order.
    pub joints: Vec<String>,
    /// Names of the splits, in the order of the counts below.
    pub splits: Vec<String>,
    /// How many cases and windows there are of each fault.
    pub faults: Vec<FaultCount>,
    /// The parameters that vary, and how far.
    pub ranges: Vec<ParameterRange>,
    /// The cases that have no data.
    pub failed: Vec<FailedCase>,
    /// What is doubtful about the others.
    pub warnings: Vec<CaseWarning>,
    /// One example per fault.
    pub examples: Vec<ClassExample>,
    /// Why there is no example; empty where there are some.
    pub no_examples: String,
    /// What is compared: depends on the design of the sweep.
    pub design: Design,
    /// How levels and spectra go with speed and load.
    pub operation: Operation,
    /// How well a classifier does that is trained on it; none where it has no test or one class alone.
    pub baseline: Option<Baseline>,
    /// The cases, for the script of the page.
    pub cases: CaseTable,
    /// What each feature says about the class by itself, that which says most first.
    pub ranking: Vec<RankedFeature>,
    /// The values of those that say most.
    pub by_class: Vec<FeatureByClass>,
    /// The features of the table.
    pub features: Vec<Feature>,
    /// The values of the features for each fault.
    pub feature_rows: Vec<FeatureRow>,
    /// The columns of all tables.
    pub columns: Vec<Column>,
}

/// How the cases of the sweep lie.
#[derive(Clone, Debug)]
pub enum Design {
    /// The same clearances in several sets of joints, all else equal.
    Grid(ClearanceGrids),
    /// Drawn at random.
    Random(RandomSweep),
}

impl DatasetPage {
    /// The colour that a class has in all figures.
    fn class_colour(&self, fault: &str) -> Colour {
        let labels = self.faults.iter().map(|count| count.fault.as_str());
        class_colour(fault, &self.joints, labels)
    }
}
