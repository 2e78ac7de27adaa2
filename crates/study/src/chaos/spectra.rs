//! Spectra of the recordings of each class.

use crate::Error;
use crate::chaos::cases::CaseChaos;
use crate::recording::Recording;
use sweep::reader::Dataset;

/// Spectra of the windows of one class.
#[derive(Clone, Debug, Default)]
pub struct ClassSpectra {
    /// The joints with clearance as a label.
    pub class: String,
    /// Windows that the spectra are from.
    pub windows: usize,
    /// Amplitude density of the acceleration, m/s²/√Hz, over frequency in Hz.
    pub spectrum: Quartiles,
    /// Amplitude of the envelope's spectrum, m/s², over order of the crank's speed.
    pub envelope: Quartiles,
}

/// The middle half of several curves.
#[derive(Clone, Debug, Default)]
pub struct Quartiles {
    /// Where.
    pub at: Vec<f64>,
    /// Lower quartile, median and upper quartile there.
    pub values: Vec<[f64; 3]>,
}

impl Quartiles {
    /// Of curves over the places `at`, each as long; places without a finite value are left out.
    pub fn from_curves(at: &[f64], curves: &[Vec<f64>]) -> Self {
        let mut quartiles = Self::default();
        for (i, &place) in at.iter().enumerate() {
            let here: Vec<f64> = curves
                .iter()
                .filter_map(|curve| curve.get(i).copied())
                .collect();
            let three = [0.25, 0.5, 0.75].map(|part| crate::statistics::quantile(&here, part));
            if let [Some(low), Some(middle), Some(high)] = three {
                quartiles.at.push(place);
                quartiles.values.push([low, middle, high]);
            }
        }
        quartiles
    }
}

/// At most this many classes.
pub const MOST_CLASSES: usize = 12;
/// Windows of a class that its spectra are from, at most.
pub const MOST_WINDOWS: usize = 40;

/// The spectra of each class, in the order of the sweep; none where the recordings are not at hand.
///
/// # Errors
/// A table that cannot be read.
pub fn by_class(dataset: &Dataset, known: &[CaseChaos]) -> Result<Vec<ClassSpectra>, Error> {
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
