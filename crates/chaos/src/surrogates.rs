//! Surrogates: signals with the spectrum of the given one and nothing else of it.

use fourier::Complex64;
use rand::RngExt;
use scalar::random::Stream;
use std::f64::consts::TAU;

/// The signal with the phase of every Fourier component drawn anew (Theiler et al. 1992): a
/// stationary linear Gaussian signal with the same spectrum. Fewer than two samples, or samples that
/// are not finite, come back as they are.
pub fn phase_randomised(signal: &[f64], generator: &mut Stream) -> Vec<f64> {
    if !usable(signal) {
        return signal.to_vec();
    }
    let mut spectrum = forward(signal);
    let amplitudes: Vec<f64> = spectrum.iter().map(|c| c.norm()).collect();
    for (bin, amplitude) in spectrum.iter_mut().zip(amplitudes).skip(1) {
        *bin = Complex64::from_polar(amplitude, generator.random_range(0.0..TAU));
    }
    backward(spectrum, signal.len())
}

/// The signal of a drive with `per_cycle` samples in each cycle. The phases of its Fourier components over
/// cycles are drawn anew, by the same angle at every phase of the drive (Prichard and
/// Theiler 1994). It is a cyclostationary linear Gaussian signal with the same covariances within and between
/// cycles. Samples after the last whole cycle are left out.
pub(crate) fn phases_randomised_alike(
    signal: &[f64],
    per_cycle: usize,
    generator: &mut Stream,
) -> Vec<f64> {
    let cycles = signal.len() / per_cycle;
    let turns: Vec<Complex64> = (0..=cycles / 2)
        .map(|_| Complex64::from_polar(1.0, generator.random_range(0.0..TAU)))
        .collect();
    let mut surrogate = vec![0.0; cycles * per_cycle];
    for phase in 0..per_cycle {
        let at_phase = signal.iter().skip(phase).step_by(per_cycle);
        let series: Vec<f64> = at_phase.take(cycles).copied().collect();
        let mut spectrum = forward(&series);
        // The mean stays, and of an even number of cycles the alternating component: both are real.
        for (bin, turn) in spectrum
            .iter_mut()
            .zip(&turns)
            .take(cycles.div_ceil(2))
            .skip(1)
        {
            *bin *= turn;
        }
        let turned = backward(spectrum, cycles);
        let places = surrogate.iter_mut().skip(phase).step_by(per_cycle);
        places.zip(turned).for_each(|(place, x)| *place = x);
    }
    surrogate
}

fn usable(signal: &[f64]) -> bool {
    signal.len() >= 2 && signal.iter().all(|x| x.is_finite())
}

/// The signal with its values and, nearly, its spectrum, in another order: iterated
/// amplitude-adjusted surrogate (Schreiber and Schmitz 1996). Stops when the order settles, at the
/// latest after `iterations`. Fewer than two samples, or samples that are not finite, come back as
/// they are.
pub fn iaaft(signal: &[f64], iterations: usize, generator: &mut Stream) -> Vec<f64> {
    if !usable(signal) {
        return signal.to_vec();
    }
    let amplitudes: Vec<f64> = forward(signal).iter().map(|c| c.norm()).collect();
    let mut sorted = signal.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut surrogate = signal.to_vec();
    shuffle(&mut surrogate, generator);
    let mut order = Vec::new();
    for _ in 0..iterations {
        let mut spectrum = forward(&surrogate);
        for (bin, amplitude) in spectrum.iter_mut().zip(&amplitudes) {
            let norm = bin.norm();
            if norm > 0.0 {
                *bin *= amplitude / norm;
            }
        }
        let coloured = backward(spectrum, signal.len());
        let mut next: Vec<(f64, usize)> = coloured.into_iter().zip(0..).collect();
        next.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (&(_, place), &value) in next.iter().zip(&sorted) {
            surrogate[place] = value;
        }
        let next: Vec<usize> = next.into_iter().map(|(_, place)| place).collect();
        if next == order {
            break;
        }
        order = next;
    }
    surrogate
}

/// Puts values into an order in which each is as likely as any other.
pub(crate) fn shuffle<T>(values: &mut [T], generator: &mut Stream) {
    for i in (1..values.len()).rev() {
        values.swap(i, generator.random_range(0..=i));
    }
}

/// The bins 0 to n/2 of a signal's spectrum.
fn forward(signal: &[f64]) -> Vec<Complex64> {
    fourier::forward(&mut signal.to_vec())
}

/// The signal of `length` samples that has this spectrum.
fn backward(spectrum: Vec<Complex64>, length: usize) -> Vec<f64> {
    let mut signal = fourier::inverse(spectrum, length);
    signal.iter_mut().for_each(|x| *x /= length as f64);
    signal
}

/// What surrogates say about a signal's statistic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// By how many standard deviations among the surrogates the signal's statistic is smaller.
    pub deviations: f64,
    /// Whether it is smaller than chance allows.
    pub significant: bool,
}

/// Numbers of surrogates after which the test may end, and the one-sided
/// 0.1 % quantiles of Student's t, for the prediction of one more value from that many. Three looks
/// call at most three signals in a thousand different that are not.
const LOOKS: [(usize, f64); 3] = [(5, 7.173), (10, 4.297), (20, 3.579)];

/// Compares a statistic that is small where the signal is deterministic with those of surrogates. The
/// test ends with a clear difference, or with a surrogate that does as well, so most signals need a few
/// surrogates only. `None` where a surrogate has no statistic.
pub fn compare(own: f64, mut surrogate: impl FnMut() -> Option<f64>) -> Option<Comparison> {
    let mut others: Vec<f64> = Vec::new();
    let mut significant = false;
    for (count, quantile) in LOOKS {
        while others.len() < count {
            others.push(surrogate()?);
        }
        significant = deviations(own, &others) > quantile * (1.0 + 1.0 / count as f64).sqrt();
        if significant || others.iter().any(|other| *other <= own) {
            break;
        }
    }
    Some(Comparison {
        deviations: deviations(own, &others),
        significant,
    })
}

fn deviations(own: f64, others: &[f64]) -> f64 {
    let count = others.len() as f64;
    let mean = others.iter().sum::<f64>() / count;
    let square = others.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    (mean - own) / square.sqrt().max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, System};
    use rand::SeedableRng;

    fn lag_product(signal: &[f64], lag: usize) -> f64 {
        let mean = signal.iter().sum::<f64>() / signal.len() as f64;
        let product = |lag: usize| -> f64 {
            signal
                .iter()
                .zip(&signal[lag..])
                .map(|(a, b)| (a - mean) * (b - mean))
                .sum()
        };
        product(lag) / product(0)
    }

    #[test]
    fn surrogates_keep_the_values_and_the_autocorrelation() {
        let signal = System::Lorenz.samples(4096, 3);
        let surrogate = iaaft(&signal, 100, &mut Stream::seed_from_u64(5));
        let sorted = |values: &[f64]| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values
        };
        assert_eq!(sorted(&signal), sorted(&surrogate));
        assert_ne!(signal, surrogate);
        for lag in [1, 5, 20] {
            let difference = lag_product(&signal, lag) - lag_product(&surrogate, lag);
            assert!(difference.abs() < 0.03, "{difference}");
        }
    }

    #[test]
    fn random_phases_keep_the_spectrum() {
        let signal = Noise::Ar2.samples(1000, 1);
        let other = phase_randomised(&signal, &mut Stream::seed_from_u64(9));
        for (a, b) in forward(&signal)
            .iter()
            .zip(forward(&other))
            .skip(1)
            .take(400)
        {
            assert!((a.norm() - b.norm()).abs() < 1e-8 * (1.0 + a.norm()));
        }
    }
}
