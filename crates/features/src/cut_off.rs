//! Samples at which the range of a sensor cut a signal off, found in the signal itself.

/// Equal samples in a row at an extreme, fewer of which are a coincidence.
const SHORTEST_RUN: usize = 3;

/// How far a signal may be from its extreme, a run's length beside the run, in steps of its resolution. Where a smooth
/// signal turns as t² or t⁴, rounding makes a run of half a length to either side of one step: a whole length further
/// the signal is 3² or 3⁴ steps away.
const FLATTEST: f32 = 81.0;

/// How many samples stand at the greatest or the least value for longer than the resolution of the signal explains.
/// Neither the rounded peak of a smooth signal is cut off, nor a signal of a few values only.
pub(crate) fn cut_off(samples: &[f32]) -> usize {
    let low = samples.iter().copied().fold(f32::INFINITY, f32::min);
    let high = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let step = steps.filter(|step| *step > 0.0).reduce(f32::min);
    let Some(step) = step.filter(|step| step.is_finite()) else {
        return 0;
    };
    let mut cut = 0;
    let mut start = 0;
    for run in samples.chunk_by(|a, b| a == b) {
        let (limit, end) = (run[0], start + run.len());
        let before = &samples[start.saturating_sub(run.len())..start];
        let after = &samples[end..samples.len().min(end + run.len())];
        let flat = FLATTEST * step.max(limit.abs() * f32::EPSILON);
        let leaves = |beside: &[f32]| beside.iter().any(|x| (x - limit).abs() > flat);
        let at_limit = limit == low || limit == high;
        if at_limit && run.len() >= SHORTEST_RUN && (leaves(before) || leaves(after)) {
            cut += run.len();
        }
        start = end;
    }
    cut
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(period: f64, limit: f64, quantum: f64, of: impl Fn(f64) -> f64) -> Vec<f32> {
        let value = |i: usize| of(TAU * i as f64 / period).clamp(-limit, limit);
        let samples = (0..20_000).map(value);
        samples
            .map(|x| ((x / quantum).round() * quantum) as f32)
            .collect()
    }

    #[test]
    fn peaks_that_are_cut_off_are_found() {
        for (limit, quantum) in [(0.8, 1e-4), (0.95, 1e-4), (0.8, 1e-9), (0.8, 1.0 / 128.0)] {
            let cut = cut_off(&wave(100.3, limit, quantum, f64::sin));
            assert!(cut > 1000, "{limit} {quantum}: {cut}");
        }
    }

    #[test]
    fn rounded_peaks_and_few_values_are_not_cut_off() {
        for period in [100.3, 400.0, 4000.0, 1e5] {
            for quantum in [1.0 / 128.0, 4.3e-4, 1e-6, 1e-12] {
                assert_eq!(cut_off(&wave(period, 2.0, quantum, f64::sin)), 0);
            }
        }
        // An ideal crosshead at its outer dead centre, where it turns as t⁴.
        let crosshead = |t: f64| t.cos() + 0.25 * (2.0 * t).cos();
        assert_eq!(cut_off(&wave(4000.0, 2.0, 4.3e-4, crosshead)), 0);
        assert_eq!(cut_off(&wave(100.3, 2.0, 1e-4, |t| t.sin().signum())), 0);
    }

    #[test]
    fn what_has_no_extremes_is_not_cut_off() {
        for samples in [&[][..], &[1.0; 100], &[f32::NAN; 100]] {
            assert_eq!(cut_off(samples), 0);
        }
    }
}
