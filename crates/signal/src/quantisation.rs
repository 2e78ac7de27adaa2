//! The step of the converter that recorded a signal, found in the values themselves.

/// Distinct values below which steps are a coincidence.
const FEWEST: usize = 32;
/// Relative spacing of single-precision numbers, in which recordings are stored.
const SINGLE: f64 = 1.0 / (1 << 23) as f64;
/// A step is visible from this many spacings of the largest value on: below, single precision itself
/// is the lattice.
const VISIBLE: f64 = 8.0;

/// The step of the lattice on which all values of `x` lie, up to the rounding of single precision:
/// the greatest common divisor of their differences. None where single precision shows no lattice,
/// or where fewer than 32 of the values differ.
///
/// The divisor is found by Euclid's algorithm with a tolerance, and refined as the sum of all
/// differences over the number of steps in them.
pub fn quantisation_step(x: &[f64]) -> Option<f64> {
    let mut values: Vec<f64> = x.iter().copied().filter(|x| x.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let largest = values.first()?.abs().max(values.last()?.abs());
    let rounding = largest * SINGLE;
    let gaps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let mut gaps: Vec<f64> = gaps.filter(|gap| *gap > rounding).collect();
    if gaps.len() + 1 < FEWEST {
        return None;
    }
    gaps.sort_by(f64::total_cmp);
    let step = divisor(&gaps, rounding)?;
    let on_lattice = |gap: &f64| {
        let off = (gap / step - (gap / step).round()).abs();
        off * step <= 2.0 * rounding
    };
    gaps.iter().all(on_lattice).then_some(step)
}

/// The greatest common divisor of ascending `gaps`, each known to ±`rounding`.
fn divisor(gaps: &[f64], rounding: f64) -> Option<f64> {
    let mut step = *gaps.first()?;
    'again: while step > VISIBLE * rounding {
        // What the gaps so far come to, and in how many steps: the step to a share of its rounding.
        let (mut sum, mut steps) = (0.0, 0.0);
        for gap in gaps {
            let within = if steps > 0.0 { sum / steps } else { step };
            let count = (gap / within).round();
            let uncertain = rounding * (2.0 + count / f64::max(steps, 1.0).sqrt());
            let rest = (gap - count * within).abs();
            if rest > uncertain {
                step = rest;
                continue 'again;
            }
            sum += gap;
            steps += count;
        }
        return Some(sum / steps);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(i: usize) -> f64 {
        let t = i as f64;
        300.0 * (0.013 * t).sin() + 40.0 * (0.31 * t).cos() + 2.0 * (1.7 * t * t).sin()
    }

    fn recorded(step: f64, count: usize) -> Vec<f64> {
        let of = |i| f64::from(((wave(i) / step).round() * step) as f32);
        (0..count).map(of).collect()
    }

    #[test]
    fn the_step_comes_back() {
        for step in [
            1.0,
            512.0 / 32768.0,
            1000.0 / 32768.0,
            9.80665 / 1000.0,
            0.1,
        ] {
            let found = quantisation_step(&recorded(step, 20_000)).unwrap();
            assert!((found / step - 1.0).abs() < 1e-4, "{found} {step}");
        }
    }

    /// 27, 28, 55, ... steps apart: none of the gaps is the step.
    #[test]
    fn a_step_that_no_gap_is_comes_back() {
        let step = std::f64::consts::TAU / 65536.0;
        let of =
            |i: usize| f64::from((((i % 2400) as f64 * 65536.0 / 2400.0).round() * step) as f32);
        let angles: Vec<f64> = (0..7200).map(of).collect();
        let found = quantisation_step(&angles).unwrap();
        assert!((found / step - 1.0).abs() < 1e-4, "{found} {step}");
    }

    #[test]
    fn no_lattice_is_none() {
        let single: Vec<f64> = (0..20_000).map(|i| f64::from(wave(i) as f32)).collect();
        assert_eq!(quantisation_step(&single), None);
        let few: Vec<f64> = (0..400).map(|i| f64::from(wave(i) as f32)).collect();
        assert_eq!(quantisation_step(&few), None);
        assert_eq!(quantisation_step(&[1.0; 100]), None);
        assert_eq!(quantisation_step(&recorded(50.0, 1000)), None);
    }
}
