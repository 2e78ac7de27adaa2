//! How a record is cut into the segments over which a spectrum is averaged.

/// Steps that a segment of one revolution is moved on by, per revolution. The square of a Hann window
/// has waves of one and two periods. Over four equal steps (three at least) they cancel, so that every
/// crank angle counts alike.
const STEPS_PER_SEGMENT: usize = 4;

/// Segments of one length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segments {
    /// Samples of each.
    pub length: usize,
    /// First sample of each.
    pub starts: Vec<usize>,
}

impl Segments {
    /// Segments of `length` samples that overlap by half (Welch 1967). What is left after the last
    /// whole one of `samples` is not used.
    pub fn overlapping(samples: usize, length: usize) -> Self {
        let last = samples.checked_sub(length);
        let step = (length - length / 2).max(1);
        let starts = last.map_or_else(Vec::new, |last| (0..=last).step_by(step).collect());
        Self { length, starts }
    }

    /// Segments of one revolution, a quarter of a revolution apart, in whole revolutions of steps.
    ///
    /// The spectrum under a Hann window of a motion that repeats every revolution is then the same
    /// wherever the record begins. The power at order k is |c_k|²/4 + (|c_(k−1)|² + |c_(k+1)|²)/16 of
    /// its Fourier coefficients, and every product of two coefficients cancels over the four steps. A
    /// record of less than two revolutions has as many segments as fit, and is without that property.
    pub fn revolutions(samples: usize, per_revolution: f64) -> Self {
        let length = per_revolution.round() as usize;
        let step = per_revolution / STEPS_PER_SEGMENT as f64;
        let starts = (0..).map(|i| (f64::from(i) * step).round() as usize);
        let mut starts: Vec<usize> = starts
            .take_while(|start| start + length <= samples)
            .collect();
        if starts.len() > STEPS_PER_SEGMENT {
            starts.truncate(starts.len() / STEPS_PER_SEGMENT * STEPS_PER_SEGMENT);
        }
        Self { length, starts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::welch::welch_over;
    use crate::windows::Window;
    use std::f64::consts::TAU;

    #[test]
    fn half_of_a_segment_is_in_the_next() {
        let segments = Segments::overlapping(1000, 300);
        assert_eq!(segments.starts, [0, 150, 300, 450, 600]);
        assert!(Segments::overlapping(10, 300).starts.is_empty());
    }

    #[test]
    fn revolutions_come_in_whole_numbers_of_steps() {
        let segments = Segments::revolutions(1003, 100.4);
        // (1003 - 100)/25.1 = 35.9 steps, of which 36 segments are nine revolutions.
        assert_eq!((segments.length, segments.starts.len()), (100, 36));
        assert_eq!(segments.starts[..5], [0, 25, 50, 75, 100]);
        assert_eq!(Segments::revolutions(160, 100.0).starts, [0, 25, 50]);
        assert!(Segments::revolutions(99, 100.0).starts.is_empty());
    }

    /// A knock once per revolution over a slow wave: the closed form of the power at each order, from
    /// wherever the record begins.
    #[test]
    fn a_periodic_motion_has_the_same_spectrum_from_everywhere() {
        let wave = |i: usize| {
            let angle = TAU * i as f64 / 240.0;
            (-60.0 * (1.0 - (angle - 1.0).cos())).exp() + 0.4 * (2.0 * angle + 0.3).cos()
        };
        let spectrum = |from: usize| {
            let x: Vec<f64> = (from..from + 900).map(wave).collect();
            let segments = Segments::revolutions(x.len(), 240.0);
            welch_over(&x, 240.0, Window::Hann, &segments)
                .unwrap()
                .density
        };
        let one = spectrum(0);
        for from in [7, 60, 101, 239] {
            for (a, b) in one.iter().zip(spectrum(from)) {
                assert!((a - b).abs() < 1e-12, "{from}: {a} {b}");
            }
        }
    }
}
