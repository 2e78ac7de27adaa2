//! Samples that are missing in a channel: cells without a number, which read as NaN.
//!
//! A gap of at most [`LONGEST_BRIDGED`] samples is bridged by a straight line between its neighbours. At
//! an end of the window the one neighbour is repeated. A longer gap ends the stretch of the recording.

use std::ops::Range;

/// Longest gap that is bridged, samples. A line over five steps spans half a period of a tenth of the
/// sample rate. A longer line would hide faster motion.
pub const LONGEST_BRIDGED: usize = 4;

/// What a line between two samples of a channel is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bridge {
    /// The straight one.
    Line,
    /// That of an angle, the shorter way round a turn of so many of the channel's units.
    Turn(f64),
}

/// Where samples without a number stand, as ranges.
fn gaps(samples: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    samples
        .chunk_by(|a, b| a.is_nan() == b.is_nan())
        .filter_map(move |run| {
            let start = end;
            end += run.len();
            run[0].is_nan().then_some(start..end)
        })
}

/// The first gap of any channel that no line bridges.
///
/// A channel without a stretch of `shortest` samples between such gaps is passed over. It is not
/// recorded here, or more slowly than the others, and must not cut them to pieces.
pub(super) fn first_long_gap(channels: &[&[f64]], shortest: usize) -> Option<Range<usize>> {
    let long = |samples: &&[f64]| -> Vec<Range<usize>> {
        gaps(samples)
            .filter(|gap| gap.len() > LONGEST_BRIDGED)
            .collect()
    };
    let recorded = |samples: &[f64], gaps: &[Range<usize>]| {
        let starts = std::iter::once(0).chain(gaps.iter().map(|gap| gap.end));
        let ends = gaps.iter().map(|gap| gap.start).chain([samples.len()]);
        starts.zip(ends).any(|(start, end)| end - start >= shortest)
    };
    let firsts = channels.iter().filter_map(|samples| {
        let gaps = long(samples);
        let first = gaps.first()?.clone();
        recorded(samples, &gaps).then_some(first)
    });
    firsts.min_by_key(|gap| gap.start)
}

/// Bridges the short gaps of a channel; how many samples that gave.
pub(super) fn bridge(samples: &mut [f64], bridge: Bridge) -> usize {
    let short: Vec<Range<usize>> = gaps(samples)
        .filter(|gap| gap.len() <= LONGEST_BRIDGED && gap.len() < samples.len())
        .collect();
    for gap in &short {
        let before = gap.start.checked_sub(1).map(|i| samples[i]);
        let after = samples.get(gap.end).copied();
        // One of the two is there: the gap is not the whole of the samples.
        let [from, to] = [before.or(after), after.or(before)].map(Option::unwrap_or_default);
        let rise = match bridge {
            Bridge::Line => to - from,
            Bridge::Turn(turn) => (to - from) - turn * ((to - from) / turn).round(),
        };
        let steps = (gap.len() + 1) as f64;
        for (i, sample) in samples[gap.clone()].iter_mut().enumerate() {
            *sample = from + rise * ((i + 1) as f64 / steps);
        }
    }
    short.iter().map(Range::len).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: f64 = f64::NAN;

    #[test]
    fn short_gaps_are_bridged_and_counted() {
        let mut line = [NAN, 2.0, NAN, 4.0, NAN, NAN, 1.0, NAN];
        assert_eq!(bridge(&mut line, Bridge::Line), 5);
        assert_eq!(line, [2.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0, 1.0]);
        let mut long = [1.0, NAN, NAN, NAN, NAN, NAN, 2.0];
        assert_eq!(bridge(&mut long, Bridge::Line), 0);
        let mut all = [NAN; 3];
        assert_eq!(bridge(&mut all, Bridge::Line), 0);
    }

    #[test]
    fn angles_are_bridged_round_the_turn() {
        let mut angle = [350.0, NAN, 10.0, NAN, 30.0];
        assert_eq!(bridge(&mut angle, Bridge::Turn(360.0)), 2);
        assert_eq!(angle, [350.0, 360.0, 10.0, 20.0, 30.0]);
    }

    #[test]
    fn long_gaps_of_recorded_channels_are_found() {
        let whole = vec![1.0; 100];
        let mut broken = whole.clone();
        broken[40..50].fill(NAN);
        let mut slow = vec![NAN; 100];
        (0..100).step_by(10).for_each(|i| slow[i] = 1.0);
        let dead = vec![NAN; 100];
        let find = |channels: &[&[f64]]| first_long_gap(channels, 30);
        assert_eq!(find(&[&whole, &broken]), Some(40..50));
        assert_eq!(find(&[&whole, &slow, &dead]), None);
        assert_eq!(first_long_gap(&[&broken], 60), None);
    }
}
