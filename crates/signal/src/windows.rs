//! Windows that taper a record before its Fourier transform.

use std::f64::consts::TAU;

/// A window w_i = Σ_m (−1)^m a_m cos(2πmi/n), i = 0 .. n: a sum of cosines that is periodic in n
/// (the "DFT-even" form, as spectra want it), w_0 being its low end.
///
/// Source: Harris 1978, "On the use of windows for harmonic analysis with the discrete Fourier
/// transform", Proc. IEEE 66(1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// No taper: for records of whole periods.
    Rectangular,
    /// Hann: little leakage, lines 1.5 bins wide. For everything else.
    Hann,
    /// Five-term flat top: reads the amplitude of a line between two bins within 0.1 %.
    /// Coefficients: D'Antona and Ferrero 2006, "Digital Signal Processing for Measurement
    /// Systems".
    FlatTop,
}

impl Window {
    fn coefficients(self) -> &'static [f64] {
        match self {
            Window::Rectangular => &[1.0],
            Window::Hann => &[0.5, 0.5],
            Window::FlatTop => &[
                0.21557895,
                0.41663158,
                0.277263158,
                0.083578947,
                0.006947368,
            ],
        }
    }

    /// The `n` weights.
    pub fn weights(self, n: usize) -> Vec<f64> {
        let (constant, waves) = self.coefficients().split_at(1);
        let weight = |i: usize| {
            let phase = TAU * i as f64 / n as f64;
            let terms = waves.iter().zip(1..);
            terms.fold(constant[0], |sum, (a, m)| {
                let signed = if m % 2 == 0 { *a } else { -a };
                sum + signed * (f64::from(m) * phase).cos()
            })
        };
        // w_(n−i) = w_i
        let half: Vec<f64> = (0..=n / 2).map(weight).collect();
        (0..n).map(|i| half[i.min(n - i)]).collect()
    }
}

/// Σw/n: the share of the amplitude of a line on a bin that a window of these n weights leaves.
pub fn coherent_gain(weights: &[f64]) -> f64 {
    weights.iter().sum::<f64>() / weights.len() as f64
}

/// n Σw²/(Σw)²: the equivalent noise bandwidth in bins, by which white noise stands too high in a
/// spectrum that is scaled for lines.
pub fn noise_bandwidth(weights: &[f64]) -> f64 {
    let sum: f64 = weights.iter().sum();
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    weights.len() as f64 * squares / (sum * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a sum of cosines over more points than terms, the gain is a₀ and the bandwidth
    /// 1 + ½ Σ (a_m/a₀)².
    #[test]
    fn gain_and_bandwidth_have_their_closed_forms() {
        for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
            let weights = window.weights(37);
            let [a0, rest @ ..] = window.coefficients() else {
                unreachable!()
            };
            let bandwidth = 1.0 + 0.5 * rest.iter().map(|a| (a / a0).powi(2)).sum::<f64>();
            assert!((coherent_gain(&weights) - a0).abs() < 1e-15);
            assert!((noise_bandwidth(&weights) - bandwidth).abs() < 1e-14);
        }
        assert!((noise_bandwidth(&Window::Hann.weights(8)) - 1.5).abs() < 1e-15);
    }
}
