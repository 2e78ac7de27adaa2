//! What looks wrong with a window although its features can be computed.

/// Equal samples in a row that a sensor's noise hardly leaves.
const SHORTEST_RUN: usize = 3;

/// Samples at the limits that are many.
const MANY: usize = 8;

/// How steeply a signal runs into its limit where it is cut off, over its RMS step: smooth peaks
/// come to rest before they turn.
const STEEP: f64 = 0.2;

/// How many samples look clipped: several in a row at the highest or lowest value, reached at a speed at
/// which the signal does not turn. None where they are few.
pub(super) fn clipped(samples: &[f32]) -> Option<usize> {
    let low = samples.iter().copied().fold(f32::INFINITY, f32::min);
    let high = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if samples.len() < 2 || !low.is_finite() || !high.is_finite() || low == high {
        return None;
    }
    let step = |pair: &[f32]| f64::from(pair[1]) - f64::from(pair[0]);
    let squares: f64 = samples.windows(2).map(|pair| step(pair).powi(2)).sum();
    let steep = STEEP * (squares / (samples.len() - 1) as f64).sqrt();
    let mut clipped = 0;
    let mut start = 0;
    for run in samples.chunk_by(|a, b| a == b) {
        let end = start + run.len();
        let enters = start > 0 && step(&samples[start - 1..=start]).abs() > steep;
        let leaves = end < samples.len() && step(&samples[end - 1..=end]).abs() > steep;
        let at_limit = run[0] == low || run[0] == high;
        if at_limit && run.len() >= SHORTEST_RUN && (enters || leaves) {
            clipped += run.len();
        }
        start = end;
    }
    (clipped >= MANY).then_some(clipped)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(limit: f64, quantum: f64) -> Vec<f32> {
        let value = |i: usize| (std::f64::consts::TAU * i as f64 / 100.3).sin();
        let samples = (0..5000).map(|i| value(i).clamp(-limit, limit));
        samples
            .map(|x| ((x / quantum).round() * quantum) as f32)
            .collect()
    }

    #[test]
    fn cut_off_peaks_are_found_and_round_ones_are_not() {
        assert!(clipped(&sine(0.8, 1e-4)).unwrap() > 1000);
        assert!(clipped(&sine(0.95, 1e-4)).is_some());
        assert_eq!(clipped(&sine(2.0, 1e-4)), None);
        // An 8-bit recorder.
        assert_eq!(clipped(&sine(2.0, 1.0 / 128.0)), None);
        assert_eq!(clipped(&[1.0; 100]), None);
        assert_eq!(clipped(&[f32::NAN; 100]), None);
        assert_eq!(clipped(&[]), None);
    }
}
