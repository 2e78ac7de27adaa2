//! Surrogates: signals with the spectrum of the given one and nothing else of it.

use rand::RngExt;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
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
        *bin = Complex::from_polar(amplitude, generator.random_range(0.0..TAU));
    }
    backward(spectrum, signal.len())
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
    sorted.sort_by(f64::total_cmp);
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
        let mut next: Vec<usize> = (0..signal.len()).collect();
        next.sort_by(|&a, &b| coloured[a].total_cmp(&coloured[b]));
        for (&place, &value) in next.iter().zip(&sorted) {
            surrogate[place] = value;
        }
        if next == order {
            break;
        }
        order = next;
    }
    surrogate
}

fn shuffle(values: &mut [f64], generator: &mut Stream) {
    for i in (1..values.len()).rev() {
        values.swap(i, generator.random_range(0..=i));
    }
}

fn forward(signal: &[f64]) -> Vec<Complex<f64>> {
    let fft = RealFftPlanner::new().plan_fft_forward(signal.len());
    let mut spectrum = fft.make_output_vec();
    fft.process(&mut signal.to_vec(), &mut spectrum)
        .expect("the buffers come from the plan");
    spectrum
}

fn backward(mut spectrum: Vec<Complex<f64>>, length: usize) -> Vec<f64> {
    // The inverse transform of a real signal has real first and (even lengths) last bins.
    spectrum[0].im = 0.0;
    if length.is_multiple_of(2)
        && let Some(last) = spectrum.last_mut()
    {
        last.im = 0.0;
    }
    let fft = RealFftPlanner::new().plan_fft_inverse(length);
    let mut signal = fft.make_output_vec();
    fft.process(&mut spectrum, &mut signal)
        .expect("the buffers come from the plan");
    signal.iter_mut().for_each(|x| *x /= length as f64);
    signal
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
