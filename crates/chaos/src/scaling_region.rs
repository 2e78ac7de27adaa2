//! The straight, rising part of a divergence curve, or the reason why it has none.

use crate::error::Error;

/// A straight line through part of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// First sample of the region.
    pub first: usize,
    /// Last sample of the region.
    pub last: usize,
    /// Rise per sample (nats).
    pub slope: f64,
    /// Its standard error, from the scatter about the line.
    pub standard_error: f64,
    /// Value of the line at sample 0.
    pub intercept: f64,
}

/// Least rise of a region, in nats: the distance grows at least by this factor of e.
const LEAST_RISE: f64 = 0.7;
/// Largest root mean square deviation from the line, as a share of the rise.
const STRAIGHT: f64 = 0.03;
/// Fewest points of a region.
const FEWEST_POINTS: usize = 4;

/// The region with the greatest rise among those that are straight to 3 % of their rise and begin
/// after the first `skip` samples.
///
/// # Errors
/// A curve with a value that is not finite, one that does not rise enough after `skip`, or one without a straight part.
pub fn scaling_region(curve: &[f64], skip: usize) -> Result<Fit, Error> {
    if curve.iter().any(|y| !y.is_finite()) {
        return Err(Error::NoScalingRegion {
            reason: "the curve is not finite",
        });
    }
    let highest = curve.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let start = curve.get(skip).copied().unwrap_or(highest);
    if highest - start < LEAST_RISE {
        return Err(Error::NoScalingRegion {
            reason: "neighbours do not part",
        });
    }
    let mut best: Option<(f64, Fit)> = None;
    for first in skip..curve.len() {
        for last in first + FEWEST_POINTS - 1..curve.len() {
            let (fit, scatter) = line(curve, first, last);
            let rise = fit.slope * (last - first) as f64;
            let better = best.as_ref().is_none_or(|(most, _)| rise > *most);
            if rise >= LEAST_RISE && scatter <= STRAIGHT * rise && better {
                best = Some((rise, fit));
            }
        }
    }
    best.map(|(_, fit)| fit).ok_or(Error::NoScalingRegion {
        reason: "no part of the rise is straight",
    })
}

/// Least-squares line over `first..=last`, and the root mean square deviation from it.
fn line(curve: &[f64], first: usize, last: usize) -> (Fit, f64) {
    let count = (last - first + 1) as f64;
    let middle = (first + last) as f64 / 2.0;
    let mean = curve[first..=last].iter().sum::<f64>() / count;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (i, y) in curve.iter().enumerate().take(last + 1).skip(first) {
        let (dx, dy) = (i as f64 - middle, y - mean);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    let slope = xy / xx;
    let residual = (yy - slope * xy).max(0.0);
    let fit = Fit {
        first,
        last,
        slope,
        standard_error: (residual / (count - 2.0) / xx).sqrt(),
        intercept: mean - slope * middle,
    };
    (fit, (residual / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_found_between_the_bend_and_the_plateau() {
        let curve: Vec<f64> = (0..100)
            .map(|i| {
                let t = f64::from(i);
                (-5.0 + 0.1 * t - (-t / 2.0).exp()).min(0.0)
            })
            .collect();
        let fit = scaling_region(&curve, 0).unwrap();
        assert!((fit.slope - 0.1).abs() < 0.005, "{fit:?}");
        assert!(fit.last >= 45 && fit.last <= 56, "{fit:?}");
    }

    #[test]
    fn flat_and_bent_curves_are_refused() {
        assert!(scaling_region(&[1.0; 50], 0).is_err());
        let oscillating: Vec<f64> = (0..50).map(|i| (f64::from(i) * 0.3).sin() * 0.2).collect();
        assert!(scaling_region(&oscillating, 0).is_err());
        assert!(scaling_region(&[0.0, f64::NAN, 3.0], 0).is_err());
        assert!(scaling_region(&[], 3).is_err());
    }
}
