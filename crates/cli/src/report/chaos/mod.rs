//! The page about chaos: the tables, and the few cases that are simulated again for it.

mod bifurcations;
mod cases;
mod motions;
mod shown;
mod spectra;

pub(super) use cases::Regimes;

use super::dataset::Dataset;
use super::windows::{Case, Windows};
use crate::Failure;
use ::report::chaos_page::ChaosPage;

/// What the page tells.
///
/// # Errors
/// A table that cannot be read, or a case that cannot be simulated again.
pub(super) fn page(
    dataset: &Dataset,
    windows: &Windows,
    cases: &[Case],
) -> Result<ChaosPage, Failure> {
    let known = cases::cases(dataset, windows, cases)?;
    let shown = shown::shown(dataset, windows, cases, &known);
    Ok(ChaosPage {
        name: dataset.plan.name.clone(),
        version: dataset.manifest.version.clone(),
        seed: dataset.manifest.seed,
        joints: dataset.joints(),
        motions: motions::rows(dataset, &known, &shown)?,
        shown: shown.rule,
        bifurcations: bifurcations::diagrams(dataset)?,
        claims: dataset.plan.study.is_some(),
        spectra: spectra::by_class(dataset, windows, cases, &known)?,
        most_windows: spectra::MOST_WINDOWS,
        cases: known,
    })
}
