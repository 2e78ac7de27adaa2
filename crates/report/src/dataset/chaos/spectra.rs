//! Spectra of the recordings of each class.

use crate::Error;
use crate::chaos_page::MOST_CLASSES;
use crate::chaos_page::{CaseChaos, ClassSpectra, Quartiles};
use crate::dataset::recording::Recording;
use sweep::reader::Dataset;

/// Windows of a class that its spectra are from, at most.
pub(super) const MOST_WINDOWS: usize = 40;

/// The spectra of each class, in the order of the sweep; none where the recordings are not at hand.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn by_class(dataset: &Dataset, known: &[CaseChaos]) -> Result<Vec<ClassSpectra>, Error> {
    if !dataset.has_signals() {
        return Ok(Vec::new());
    }
    let mut classes: Vec<(&str, Vec<usize>)> = Vec::new();
    for (case, known) in dataset.cases.iter().zip(known) {
        match classes.iter_mut().find(|(class, _)| *class == known.joints) {
            Some((_, own)) => own.extend(&case.windows),
            None => classes.push((&known.joints, case.windows.clone())),
        }
    }
    classes
        .into_iter()
        .take(MOST_CLASSES)
        .map(|(class, own)| of_class(dataset, class, &evenly(&own)))
        .collect()
}

/// At most [`MOST_WINDOWS`] of the windows, spread evenly.
fn evenly(own: &[usize]) -> Vec<usize> {
    let count = own.len().min(MOST_WINDOWS);
    (0..count).map(|i| own[i * own.len() / count]).collect()
}

fn of_class(dataset: &Dataset, class: &str, own: &[usize]) -> Result<ClassSpectra, Error> {
    let (mut densities, mut envelopes) = (Vec::new(), Vec::new());
    let (mut frequencies, mut orders) = (Vec::new(), Vec::new());
    for &window in own {
        let Some(sensor) = dataset
            .sensors
            .first_of_fault(&dataset.windows.fault[window])
        else {
            continue;
        };
        let recording = Recording::read(dataset, window, sensor)?;
        let (at, density) = recording.density()?;
        frequencies = at;
        densities.push(density);
        if let Some((at, envelope)) = recording.envelope_spectrum() {
            orders = at;
            envelopes.push(envelope);
        }
    }
    Ok(ClassSpectra {
        class: class.to_owned(),
        windows: own.len(),
        spectrum: Quartiles::from_curves(&frequencies, &densities),
        envelope: Quartiles::from_curves(&orders, &envelopes),
    })
}
