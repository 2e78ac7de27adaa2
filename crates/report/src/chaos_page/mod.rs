//! The HTML page of what a sweep says about chaos.
//!
//! [`ChaosPage::from_dataset`] reads the tables of the dataset and simulates the few cases whose
//! motion is shown again. [`ChaosPage::render`] is one file with its styles and figures inside. A
//! section without data says what to add to the sweep file. The size is bounded for any dataset.

mod bifurcations;
mod exponents;
mod levels;
mod maps;
mod motions;
mod page;
mod spectra;
mod table;

use crate::class_colour::class_colour;
use figure::Colour;
use study::chaos::bifurcations::Bifurcation;
use study::chaos::cases::CaseChaos;
use study::chaos::motions::MotionRow;
use study::chaos::spectra::ClassSpectra;

/// The content of the page. Numbers are SI, speeds in rpm; labels are as in the data.
#[derive(Clone, Debug, Default)]
pub struct ChaosPage {
    /// Name of the dataset.
    pub name: String,
    /// Version of the program that wrote it.
    pub version: String,
    /// Seed of the sweep.
    pub seed: u64,
    /// The machine's joints, in their order.
    pub joints: Vec<String>,
    /// Whether the sweep repeats the clearance study, so that its claims are held against the cases.
    pub claims: bool,
    /// The cases whose motion is shown, in rows.
    pub motions: Vec<MotionRow>,
    /// Which cases these are, as a rule.
    pub shown: String,
    /// Bifurcation diagrams.
    pub bifurcations: Vec<Bifurcation>,
    /// Exponents and regimes of all cases.
    pub cases: Vec<CaseChaos>,
    /// Spectra of each class.
    pub spectra: Vec<ClassSpectra>,
    /// How many windows of a class its spectra are from at most.
    pub most_windows: usize,
}

impl ChaosPage {
    /// The colour that a class has on all pages of the dataset.
    fn class_colour(&self, label: &str) -> Colour {
        let of_cases = self.cases.iter().map(|case| case.joints.as_str());
        let labels = self.spectra.iter().map(|class| class.class.as_str());
        class_colour(label, &self.joints, labels.chain(of_cases))
    }
}
