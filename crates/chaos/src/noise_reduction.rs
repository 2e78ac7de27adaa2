//! Nonlinear noise reduction.

use crate::delay::Times;
use crate::error::{Error, checked};
use crate::neighbours::{Delays, LARGEST_DIMENSION, Neighbours};

/// Coordinates of the window about a sample; odd, so that the sample is in the middle.
const WINDOW: usize = LARGEST_DIMENSION - 1;

/// The signal with each sample replaced by the mean, over the `neighbours` most similar windows
/// about it, of the samples in their middle (Schreiber 1993). The ends stay as they are.
pub fn noise_reduced(signal: &[f64], times: &Times, neighbours: usize) -> Result<Vec<f64>, Error> {
    checked(signal)?;
    let delay = times.delay.div_ceil(2);
    let delays = Delays {
        signal,
        dimension: WINDOW,
        delay,
    };
    let count = delays.count();
    let too_short = Error::TooShort {
        found: signal.len(),
        needed: delays.span() + 2 * times.theiler + neighbours + 1,
    };
    if signal.len() < delays.span() + 2 * times.theiler + neighbours + 1 {
        return Err(too_short);
    }
    let search = Neighbours::new(&delays, count, times.theiler).ok_or(too_short)?;
    let middle = WINDOW / 2;
    let mut reduced = signal.to_vec();
    for index in 0..count {
        let near = search.nearest(index, neighbours);
        let sum: f64 = near.iter().map(|n| delays.at(n.index, middle)).sum();
        let own = delays.at(index, middle);
        reduced[index + middle * delay] = (own + sum) / (near.len() + 1) as f64;
    }
    Ok(reduced)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{System, with_noise};

    #[test]
    fn noise_on_a_flow_shrinks() {
        let clean = System::Roessler.samples(6000, 1);
        let noisy = with_noise(&clean, 0.05, 1);
        let reduced = noise_reduced(&noisy, &times(&noisy).unwrap(), 12).unwrap();
        let square =
            |other: &[f64]| -> f64 { clean.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum() };
        assert!(square(&reduced) < 0.5 * square(&noisy));
    }
}
