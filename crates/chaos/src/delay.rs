//! Delay of the embedding, and the window within which vectors are neighbours only in time.

use crate::autocorrelation::autocorrelation;
use crate::error::{Error, checked};

/// Times in a signal, in samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    /// Lag of the first minimum of the mutual information (Fraser and Swinney 1986); `None` where
    /// it falls without a minimum.
    pub mutual_information: Option<usize>,
    /// Lag at which the autocorrelation is first below 1/e.
    pub decorrelation: usize,
    /// Delay to embed with: the smaller of the two; 1 for a signal without memory.
    pub delay: usize,
    /// Mean period: samples between upward crossings of the mean, counted once the signal has
    /// also gone below it by a fifth of its standard deviation.
    pub mean_period: f64,
    /// Theiler window: one mean period or three decorrelation times, whichever is more, and at
    /// most a twentieth of the signal.
    pub theiler: usize,
}

/// The times of a signal.
///
/// # Errors
/// A signal that [`checked`] refuses.
pub fn times(signal: &[f64]) -> Result<Times, Error> {
    let (mean, deviation) = checked(signal)?;
    let longest = signal.len() / 10;
    let correlation = autocorrelation(signal, longest);
    let decorrelation = correlation
        .iter()
        .position(|r| *r < (-1.0_f64).exp())
        .unwrap_or(longest);
    let mean_period = mean_period(signal, mean, BAND * deviation);
    let searched = (2.0 * mean_period).ceil().min(longest as f64) as usize;
    let information = information_minimum(signal, searched.max(2));
    let delay = information
        .map_or(decorrelation, |lag| lag.min(decorrelation))
        .max(1);
    let theiler = (mean_period.ceil() as usize)
        .max(3 * decorrelation)
        .min(signal.len() / 20);
    Ok(Times {
        mutual_information: information,
        decorrelation,
        delay,
        mean_period,
        theiler,
    })
}

/// Distance below and above the mean that a cycle must reach, in standard deviations.
const BAND: f64 = 0.2;

/// Where each cycle begins, in samples: at an upward crossing of the mean (interpolated). Before it the signal has
/// gone below the mean by a fifth of its standard deviation, and after it it goes above by as much.
///
/// # Errors
/// A signal that [`checked`] refuses.
pub fn cycle_starts(signal: &[f64]) -> Result<Vec<f64>, Error> {
    let (mean, deviation) = checked(signal)?;
    Ok(crossings(signal, mean, BAND * deviation))
}

fn crossings(signal: &[f64], mean: f64, band: f64) -> Vec<f64> {
    let (mut armed, mut crossed) = (false, 0.0);
    let mut starts = Vec::new();
    for (i, x) in signal.iter().enumerate() {
        if *x < mean - band {
            armed = true;
        }
        if i > 0 && signal[i - 1] < mean && *x >= mean {
            crossed = (i - 1) as f64 + (mean - signal[i - 1]) / (x - signal[i - 1]);
        }
        if armed && *x > mean + band {
            armed = false;
            starts.push(crossed);
        }
    }
    starts
}

fn mean_period(signal: &[f64], mean: f64, band: f64) -> f64 {
    let starts = crossings(signal, mean, band);
    match starts[..] {
        [first, .., last] => (last - first) / (starts.len() - 1) as f64,
        _ => signal.len() as f64 / 10.0,
    }
}

/// First lag up to `longest` whose mutual information is below that of both neighbours.
fn information_minimum(signal: &[f64], longest: usize) -> Option<usize> {
    let bins = (signal.len() as f64 / 5.0).sqrt().clamp(8.0, 32.0) as usize;
    let ranks = ranks(signal, bins);
    let mut before = mutual_information(&ranks, bins, 1);
    let mut here = mutual_information(&ranks, bins, 2);
    if before < here {
        return Some(1);
    }
    for lag in 3..=longest {
        let after = mutual_information(&ranks, bins, lag);
        if here < before && here <= after {
            return Some(lag - 1);
        }
        (before, here) = (here, after);
    }
    None
}

/// The bin of each sample, all bins equally full.
fn ranks(signal: &[f64], bins: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..signal.len()).collect();
    order.sort_by(|&a, &b| signal[a].total_cmp(&signal[b]));
    let mut ranks = vec![0; signal.len()];
    for (rank, &place) in order.iter().enumerate() {
        ranks[place] = rank * bins / signal.len();
    }
    ranks
}

/// Mutual information of the signal and itself `lag` samples later (nats), from equally full bins.
fn mutual_information(ranks: &[usize], bins: usize, lag: usize) -> f64 {
    let pairs = (ranks.len() - lag) as f64;
    let mut joint = vec![0.0; bins * bins];
    let (mut now, mut later) = (vec![0.0; bins], vec![0.0; bins]);
    for (&a, &b) in ranks.iter().zip(&ranks[lag..]) {
        joint[a * bins + b] += 1.0;
        now[a] += 1.0;
        later[b] += 1.0;
    }
    (0..bins * bins)
        .filter(|&cell| joint[cell] > 0.0)
        .map(|cell| {
            let together: f64 = joint[cell];
            together / pairs * (together * pairs / (now[cell / bins] * later[cell % bins])).ln()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, System};

    #[test]
    fn a_sine_is_embedded_a_quarter_period_apart() {
        let signal: Vec<f64> = (0..4000).map(|i| (f64::from(i) * 0.1).sin()).collect();
        let times = times(&signal).unwrap();
        assert!((times.mean_period - 62.83).abs() < 0.1, "{times:?}");
        assert!((12..=16).contains(&times.decorrelation), "{times:?}");
    }

    #[test]
    fn the_autoregression_decorrelates_after_its_time_constant() {
        // 0.9^n < 1/e first at n = 10.
        let times = times(&Noise::Ar1.samples(50_000, 2)).unwrap();
        assert!((9..=11).contains(&times.decorrelation), "{times:?}");
    }

    #[test]
    fn maps_have_delay_one() {
        assert_eq!(times(&System::Logistic.samples(5000, 1)).unwrap().delay, 1);
        assert_eq!(times(&System::Henon.samples(5000, 1)).unwrap().delay, 1);
    }

    #[test]
    fn information_of_equal_signals_is_the_logarithm_of_the_bins() {
        let ranks: Vec<usize> = (0..800).map(|i| i % 8).collect();
        assert!((mutual_information(&ranks, 8, 8) - 8.0_f64.ln()).abs() < 1e-12);
    }
}
