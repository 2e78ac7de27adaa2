//! Where in frequency a signal comes in bursts.

use crate::error::Error;
use crate::segments::Segments;
use crate::welch::for_each_segment;
use crate::windows::Window;

/// Spectral kurtosis over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralKurtosis {
    /// Distance of two bins, Hz.
    pub resolution: f64,
    /// Kurtosis at `resolution` times the index; none where the signal has no power.
    pub kurtosis: Vec<Option<f64>>,
}

/// ⟨|X_k|⁴⟩/⟨|X_k|²⟩² − 2 over the segments of [`welch`](crate::welch::welch()): 0 for stationary
/// Gaussian noise, −1 for a steady line, large where power comes in few bursts. At 0 Hz and at
/// the Nyquist frequency, where the transform is real, Gaussian noise gives 1.
///
/// Segments should be shorter than the time between bursts and longer than a burst; the
/// [`kurtogram`](crate::kurtogram) looks for the best.
///
/// Source: Antoni 2006, "The spectral kurtosis: a useful tool for characterising non-stationary
/// signals", Mechanical Systems and Signal Processing 20(2).
///
/// # Errors
/// As [`welch`](crate::welch::welch()).
pub fn spectral_kurtosis(
    x: &[f64],
    sample_rate: f64,
    window: Window,
    segment: usize,
) -> Result<SpectralKurtosis, Error> {
    let mut sums = vec![[0.0; 2]; segment / 2 + 1];
    let segments = Segments::overlapping(x.len(), segment);
    let count = for_each_segment(x, sample_rate, window, &segments, |spectrum| {
        for (sums, c) in sums.iter_mut().zip(spectrum) {
            let power = c.norm_sqr();
            sums[0] += power;
            sums[1] += power * power;
        }
    })?;
    let kurtosis = sums
        .iter()
        .map(|[second, fourth]| excess(second / count as f64, fourth / count as f64));
    Ok(SpectralKurtosis {
        resolution: sample_rate / segment as f64,
        kurtosis: kurtosis.collect(),
    })
}

/// ⟨|c|⁴⟩/⟨|c|²⟩² − 2 of a complex number, 0 if Gaussian; none without power.
pub(crate) fn excess(second_moment: f64, fourth_moment: f64) -> Option<f64> {
    let square = second_moment * second_moment;
    (square > 0.0).then(|| fourth_moment / square - 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn steady_line_gives_minus_one() {
        let x: Vec<f64> = (0..1280)
            .map(|i| (TAU * f64::from(i) / 8.0).sin())
            .collect();
        let sk = spectral_kurtosis(&x, 6400.0, Window::Hann, 64).unwrap();
        assert_eq!(sk.resolution, 100.0);
        for bin in 7..=9 {
            assert!((sk.kurtosis[bin].unwrap() + 1.0).abs() < 1e-9);
        }
        let still = spectral_kurtosis(&[3.0; 128], 1.0, Window::Hann, 64).unwrap();
        assert!(still.kurtosis.iter().all(Option::is_none));
    }

    #[test]
    fn single_burst_among_m_segments_gives_m_minus_two() {
        let mut x = vec![0.0; 64 * 20];
        // Sample 0 of segment 20 has no weight in a Hann window, so segment 19 alone sees it.
        x[64 * 10] = 1.0;
        let sk = spectral_kurtosis(&x, 1.0, Window::Hann, 64).unwrap();
        assert!((sk.kurtosis[20].unwrap() - 37.0).abs() < 0.2);
    }
}
