//! The page about chaos: the tables, and the few cases that are simulated again for it.

mod bifurcations;
mod cases;
mod motions;
mod shown;
mod spectra;

pub(super) use cases::is_chaotic;

use crate::Error;
use crate::chaos_page::ChaosPage;
use sweep::reader::Dataset;

/// What the page tells.
///
/// # Errors
/// A table that cannot be read, or a case that cannot be simulated again.
pub(super) fn page(dataset: &Dataset) -> Result<ChaosPage, Error> {
    let known = cases::cases(dataset)?;
    let shown = shown::shown(dataset, &known);
    Ok(ChaosPage {
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
