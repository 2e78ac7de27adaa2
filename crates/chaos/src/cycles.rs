//! The cycles of a signal: of one period, or of a length that changes slowly.

use crate::autocorrelation::autocorrelation;
use crate::forced::{FEWEST_CYCLES, residual};

/// Least similarity at a period: that of a signal of which half is periodic.
pub(crate) const HALF: f64 = 0.5;
/// Least number of multiples of a period.
const MULTIPLES: usize = 8;
/// Fewest samples of a cycle whose scatter is judged.
const FEWEST_PER_CYCLE: f64 = 8.0;

/// A signal in cycles of a whole number of samples.
pub(crate) struct Cycles {
    pub signal: Vec<f64>,
    pub per_cycle: usize,
    /// Length of a cycle in samples of the original signal.
    pub length: f64,
}

/// How much the signal is like itself later. It is 1 minus the mean square difference at each lag up to half of
/// the signal, over twice the variance (de Cheveigné and Kawahara 2002). Unlike the autocorrelation it
/// is 1 at a period of a signal of any length.
pub(crate) fn similarity(signal: &[f64]) -> Vec<f64> {
    let count = signal.len();
    let mean = signal.iter().sum::<f64>() / count as f64;
    let squares: Vec<f64> = signal.iter().map(|x| (x - mean).powi(2)).collect();
    let whole: f64 = squares.iter().sum();
    // Sums of squares without the first, and without the last, samples.
    let (mut later, mut earlier) = (whole, whole);
    let mut similarity = autocorrelation(signal, count / 2);
    for (lag, r) in similarity.iter_mut().enumerate() {
        if lag > 0 {
            later -= squares[lag - 1];
            earlier -= squares[count - lag];
        }
        let difference = (later + earlier) / whole - 2.0 * *r;
        *r = 1.0 - 0.5 * difference * count as f64 / (count - lag) as f64;
    }
    similarity
}

/// The shortest period in samples after every multiple of which more than half of the signal comes back.
pub(crate) fn period(similarity: &[f64]) -> Option<f64> {
    peaks(similarity, similarity.len() / MULTIPLES)
        .filter(|(_, height)| *height > HALF)
        .find_map(|(lag, _)| kept_period(similarity, lag))
}

/// Places and heights of the peaks up to a lag, after the similarity has fallen to half.
fn peaks(similarity: &[f64], last: usize) -> impl Iterator<Item = (f64, f64)> {
    let fallen = similarity.iter().position(|r| *r < HALF);
    let first = fallen.unwrap_or(last).max(1);
    (first..last)
        .filter(|&lag| similarity[lag] >= similarity[lag - 1].max(similarity[lag + 1]))
        .map(|lag| peak(similarity, lag))
}

/// A period, sharpened, if the similarity is above half at every multiple of it.
fn kept_period(similarity: &[f64], mut period: f64) -> Option<f64> {
    let mut multiple = 1.0;
    // Each multiple found sharpens the period with which the next is looked for.
    loop {
        multiple += 1.0;
        let centre = (multiple * period).round() as usize;
        if centre + 2 >= similarity.len() {
            return Some(period);
        }
        let highest =
            (centre - 1..=centre + 1).max_by(|&a, &b| similarity[a].total_cmp(&similarity[b]))?;
        let (place, height) = peak(similarity, highest);
        if height < HALF {
            return None;
        }
        period = place / multiple;
    }
}

/// Whether the signal comes back closer, by half of the mean square difference, after a time that is no
/// multiple of `period`. Then this is no period but a near return of a quasi-periodic motion.
pub(crate) fn returns_at_other_times(similarity: &[f64], period: f64) -> bool {
    let last = similarity.len() - 2;
    let multiples = 1..=(last as f64 / period) as usize;
    let count = multiples.end().max(&1);
    let left = multiples
        .clone()
        .map(|m| 1.0 - peak(similarity, (m as f64 * period).round() as usize).1)
        .sum::<f64>()
        / *count as f64;
    let others = peaks(similarity, last).filter(|(lag, _)| {
        let multiple = lag / period;
        // A sharpened period is right to a sample over its last multiple.
        (multiple - multiple.round()).abs() * period > 1.5
    });
    let closest = others
        .map(|(_, height)| 1.0 - height)
        .fold(f64::INFINITY, f64::min);
    closest < HALF * left
}

/// Place and height of the parabola through the values at `lag` and beside it.
fn peak(similarity: &[f64], lag: usize) -> (f64, f64) {
    let [before, here, after] = [lag - 1, lag, lag + 1].map(|i| similarity[i]);
    let curvature = before - 2.0 * here + after;
    if curvature >= 0.0 || here < before.max(after) {
        return (lag as f64, here);
    }
    let shift = (0.5 * (before - after) / curvature).clamp(-1.0, 1.0);
    (lag as f64 + shift, here - 0.25 * (before - after) * shift)
}

/// The signal in cycles of one period. Several short periods make a cycle: to interpolate between their
/// samples would make noise predictable. Where whole cycles end between samples, the signal is
/// interpolated to the next whole number of them. `None` where there are fewer cycles than can be judged.
pub(crate) fn of_one_period(signal: &[f64], period: f64) -> Option<Cycles> {
    let fewest = (FEWEST_PER_CYCLE / period).ceil().max(1.0) as usize;
    // Half a sample at the most over the whole signal.
    let strays = |length: f64| {
        let cycles = signal.len() as f64 / length;
        (length - length.round()).abs() * cycles > 0.5
    };
    let multiples = (fewest..2 * fewest.max(2)).map(|count| count as f64 * period);
    let cycles = match multiples.into_iter().find(|length| !strays(*length)) {
        Some(length) => Cycles {
            signal: signal.to_vec(),
            per_cycle: length.round() as usize,
            length: length.round(),
        },
        None => {
            let length = sharpened(signal, fewest as f64 * period);
            let per_cycle = length.ceil() as usize;
            Cycles {
                signal: interpolated(signal, length / per_cycle as f64),
                per_cycle,
                length,
            }
        }
    };
    (cycles.signal.len() >= FEWEST_CYCLES * cycles.per_cycle).then_some(cycles)
}

/// The length of a cycle that leaves least to differ from cycle to cycle, among those within a sample of
/// the given one over the whole signal.
fn sharpened(signal: &[f64], length: f64) -> f64 {
    let cycles = (signal.len() as f64 / length).floor();
    let left = |length: f64| {
        let per_cycle = length.ceil() as usize;
        let rest = residual(&interpolated(signal, length / per_cycle as f64), per_cycle);
        rest.iter().map(|r| r * r).sum::<f64>() / rest.len() as f64
    };
    let mut best = (left(length), length);
    for reach in [1.0, 0.2] {
        let middle = best.1;
        for step in (-5..=5).filter(|step| *step != 0) {
            let other = middle + f64::from(step) / 5.0 * reach / cycles;
            let found = left(other);
            if found < best.0 {
                best = (found, other);
            }
        }
    }
    best.1
}

/// The signal at every `step` samples.
fn interpolated(signal: &[f64], step: f64) -> Vec<f64> {
    let count = ((signal.len() - 3) as f64 / step) as usize;
    (0..count)
        .map(|i| at(signal, 1.0 + i as f64 * step))
        .collect()
}

/// The signal between samples (cubic: Keys 1981), from the second to the last but one.
fn at(signal: &[f64], place: f64) -> f64 {
    let (whole, t) = (place as usize, place.fract());
    let [a, b, c, d] = [whole - 1, whole, whole + 1, whole + 2].map(|j| signal[j]);
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

/// Part of the signal from which the length of a cycle at its start is taken.
const PART: usize = 4;
/// Most by which a cycle is longer or shorter than the last, as a share of it.
const CHANGE: f64 = 0.05;

/// How much longer or shorter than the first a cycle may become: beyond, part of a cycle was taken for it.
const UNEVEN: f64 = 1.5;

/// The signal in its own cycles, whose length changes slowly: each begins where the samples that follow
/// are most like the mean of the cycles before. `None` where no cycle comes back at the start, where
/// they become too uneven, or where there are too few.
pub(crate) fn of_changing_length(signal: &[f64]) -> Option<Cycles> {
    let part = similarity(&signal[..signal.len() / PART]);
    let found: Vec<(f64, f64)> = peaks(&part, part.len() - 1).collect();
    let highest = found.iter().map(|(_, height)| *height).fold(HALF, f64::max);
    let (first, _) = *found
        .iter()
        .find(|(_, height)| *height >= KEEPS * highest)?;
    let per_cycle = (first.ceil() as usize).max(FEWEST_PER_CYCLE as usize);
    let cycle = |start: f64, length: f64| -> Vec<f64> {
        let step = length / per_cycle as f64;
        (0..per_cycle)
            .map(|i| at(signal, start + i as f64 * step))
            .collect()
    };
    let mut sum = cycle(1.0, first);
    let (mut starts, mut length) = (vec![1.0], first);
    loop {
        let start = starts[starts.len() - 1];
        let reach = (CHANGE * length).ceil();
        if start + 2.0 * length + 2.0 * reach + 4.0 >= signal.len() as f64 {
            break;
        }
        let likeness = |length: f64| correlation(&sum, &cycle(start + length, length));
        let next = closest(length, reach, likeness);
        length = next;
        if length > UNEVEN * first || length < first / UNEVEN {
            return None;
        }
        starts.push(start + length);
        let next = cycle(start + length, length);
        sum.iter_mut().zip(next).for_each(|(sum, x)| *sum += x);
    }
    let lengths = starts.windows(2).map(|ends| ends[1] - ends[0]);
    let mean = lengths.clone().sum::<f64>() / lengths.len().max(1) as f64;
    let cycles = Cycles {
        signal: (starts.iter().zip(lengths))
            .flat_map(|(start, length)| cycle(*start, length))
            .collect(),
        per_cycle,
        length: mean,
    };
    (cycles.signal.len() >= FEWEST_CYCLES * per_cycle).then_some(cycles)
}

/// Share of the highest peak that the first has, which is taken.
const KEEPS: f64 = 0.9;

/// The length within `reach` of the last that is most like: to a sample, then between samples.
fn closest(last: f64, reach: f64, likeness: impl Fn(f64) -> f64) -> f64 {
    let mut best = last;
    for (reach, step) in [(reach, 1.0), (1.0, 0.25), (0.25, 0.0625)] {
        let steps = (reach / step) as i32;
        let middle = best;
        let tried = (-steps..=steps).map(|i| middle + f64::from(i) * step);
        // What is less than a sample long is no cycle.
        best = tried
            .filter(|length| *length >= 1.0)
            .map(|length| (likeness(length), length))
            .fold(
                (f64::NEG_INFINITY, middle),
                |a, b| if b.0 > a.0 { b } else { a },
            )
            .1;
    }
    best
}

/// Correlation coefficient.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        aa += x * x;
        ab += x * y;
        bb += y * y;
    }
    ab / (aa * bb).sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::Regular;

    #[test]
    fn a_clean_periodic_signal_has_its_period() {
        for (signal, expected) in [(Regular::Periodic, 20.3), (Regular::KnockTrain, 47.3)] {
            let found = period(&similarity(&signal.samples(2000, 1))).unwrap();
            assert!((found - expected).abs() < 0.01, "{signal:?} {found}");
        }
    }
}
