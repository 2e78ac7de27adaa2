//! The page about chaos, from the tables of a dataset.

use crate::Error;
use crate::chaos_page::ChaosPage;
use study::chaos::{bifurcations, cases, motions, shown, spectra};
use sweep::reader::Dataset;

impl ChaosPage {
    /// The page about chaos of a dataset. The few cases whose motion it shows are simulated again.
    ///
    /// # Errors
    /// A table that cannot be read, or a case that cannot be simulated again.
    pub fn from_dataset(dataset: &Dataset) -> Result<Self, Error> {
        let known = cases::cases(dataset)?;
        let shown = shown::shown(dataset, &known);
        Ok(Self {
            name: dataset.plan.name.clone(),
            version: dataset.manifest().version.clone(),
            seed: dataset.manifest().seed,
            joints: dataset.joints(),
            motions: motions::rows(dataset, &known, &shown)?,
            shown: shown.rule,
            bifurcations: bifurcations::diagrams(dataset)?,
            claims: dataset.plan.study.is_some(),
            spectra: spectra::by_class(dataset, &known)?,
            most_windows: spectra::MOST_WINDOWS,
            cases: known,
        })
    }
}
