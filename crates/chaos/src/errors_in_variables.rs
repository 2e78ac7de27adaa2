//! Maps of noisy signals: noise in the delay vectors, not only in the sample that follows, and the
//! signal without it.
//!
//! With `x` the signal without noise, `y = x + e`, and `x[n+1] = f(x[n], x[n-d], ...) + w`, the error
//! of prediction is, to first order, `D e + w`: `D` has 1 at sample `n+1` and the negative slopes of
//! `f` at the coordinates. Its covariance is `s^2 D D' + q^2 1`, a band as wide as a delay vector is
//! long. Errors whitened by it give the slopes that plain regression flattens (generalised least
//! squares for errors in variables, Fuller 1987), and `x = y - s^2 D' C^-1 (error)` is the most
//! likely signal.

use crate::global_map::{Basis, Fit, Linear, regression};

/// Variances of the noise, as a multiple of that of the map's own errors, among which the
/// likelihood chooses. The last is far from a deterministic map, whose likelihood has many maxima.
const RATIOS: [f64; 6] = [0.0, 0.01, 0.1, 1.0, 10.0, 100.0];

/// A map with the signal that it makes likely.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub basis: Basis,
    pub fit: Fit,
    /// The most likely signal.
    pub signal: Vec<f64>,
    /// Standard deviation of the noise.
    pub noise: f64,
    /// Standard deviation of the map's own errors.
    pub own: f64,
    /// Mean logarithm of the likelihood of a sample.
    pub likelihood: f64,
}

impl Model {
    /// Fits to the signal `y`, starting from the estimate `start` of it: map, noise and signal in
    /// turn, as long as the likelihood grows and at most `passes` times.
    pub fn fitted(basis: Basis, y: &[f64], start: &[f64], passes: usize) -> Option<Self> {
        let mut fit = ordinary(&basis, start)?;
        let mut signal = start.to_vec();
        let mut best: Option<Self> = None;
        for pass in 0.. {
            let linear = basis.along(&[&fit.map], &signal).remove(0);
            let smoothed = RATIOS
                .iter()
                .map(|ratio| Smoothed::new(&linear, y, &signal, *ratio))
                .max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))?;
            if best
                .as_ref()
                .is_some_and(|b| b.likelihood >= smoothed.likelihood)
            {
                break;
            }
            let (noise, own) = (smoothed.noise, smoothed.own);
            signal = smoothed.signal;
            let next = if noise > 0.0 && pass < passes {
                let linear = basis.along(&[&fit.map], &signal).remove(0);
                generalised(&basis, &linear, y, &signal, noise, own)
            } else {
                None
            };
            best = Some(Self {
                basis: basis.clone(),
                fit,
                signal: signal.clone(),
                noise: noise.sqrt(),
                own: own.sqrt(),
                likelihood: smoothed.likelihood,
            });
            let Some(next) = next else { break };
            fit = next;
        }
        best
    }
}

/// Plain regression.
fn ordinary(basis: &Basis, x: &[f64]) -> Option<Fit> {
    let design = basis.design(x, 0..basis.rows(x));
    regression(&design, basis.size(), &x[basis.span() + 1..])
}

/// Regression with whitened errors. The functions are taken at the most likely signal `x`, the
/// target is moved by what the slopes make of the difference to `y`.
fn generalised(
    basis: &Basis,
    linear: &Linear,
    y: &[f64],
    x: &[f64],
    noise: f64,
    own: f64,
) -> Option<Fit> {
    let mut design = basis.design(x, 0..basis.rows(x));
    let mut target = errors(linear, y, x);
    for (target, value) in target.iter_mut().zip(&linear.values) {
        *target += value;
    }
    let band = Band::new(linear, noise, own);
    band.whiten(&mut design, basis.size());
    band.whiten(&mut target, 1);
    regression(&design, basis.size(), &target)
}

/// Errors of prediction at `y`, linear about `x`.
fn errors(linear: &Linear, y: &[f64], x: &[f64]) -> Vec<f64> {
    let (m, delay) = (linear.dimension, linear.delay);
    let span = (m - 1) * delay;
    (linear.values.iter().zip(linear.slopes.chunks_exact(m)))
        .enumerate()
        .map(|(row, (value, slopes))| {
            let newest = span + row;
            let moved: f64 = slopes
                .iter()
                .enumerate()
                .map(|(axis, slope)| slope * (y[newest - axis * delay] - x[newest - axis * delay]))
                .sum();
            y[newest + 1] - value - moved
        })
        .collect()
}

/// The most likely signal for given shares of the noise and of the map's own errors.
struct Smoothed {
    signal: Vec<f64>,
    /// Variance of the noise, and of the map's own errors.
    noise: f64,
    own: f64,
    likelihood: f64,
}

impl Smoothed {
    fn new(linear: &Linear, y: &[f64], x: &[f64], ratio: f64) -> Self {
        let (noise, own) = (ratio / (1.0 + ratio), 1.0 / (1.0 + ratio));
        let mut errors = errors(linear, y, x);
        let count = errors.len() as f64;
        let band = Band::new(linear, noise, own);
        band.whiten(&mut errors, 1);
        // The common scale of both variances is the one that makes the errors most likely.
        let scale = errors.iter().map(|e| e * e).sum::<f64>() / count;
        let likelihood = -0.5 * scale.ln() - band.logarithm_of_root() / count;
        band.unwhiten_transposed(&mut errors);
        let (m, delay) = (linear.dimension, linear.delay);
        let mut signal = y.to_vec();
        for ((row, error), slopes) in errors.iter().enumerate().zip(linear.slopes.chunks_exact(m)) {
            let newest = (m - 1) * delay + row;
            signal[newest + 1] -= noise * error;
            for (axis, slope) in slopes.iter().enumerate() {
                signal[newest - axis * delay] += noise * slope * error;
            }
        }
        Self {
            signal,
            noise: noise * scale,
            own: own * scale,
            likelihood,
        }
    }
}

/// The lower triangular root `L` of the covariance `C = L L'` (Cholesky), a band.
struct Band {
    /// Entries left of the diagonal.
    width: usize,
    /// For each row the diagonal entry, then those left of it.
    root: Vec<f64>,
}

impl Band {
    fn new(linear: &Linear, noise: f64, own: f64) -> Self {
        let (m, delay) = (linear.dimension, linear.delay);
        let width = (m - 1) * delay + 1;
        let stride = width + 1;
        let rows = linear.values.len();
        let mut root = vec![0.0; rows * stride];
        // Row `r` of D has entry `i` this many samples before the sample predicted.
        let before = |i: usize| if i == 0 { 0 } else { 1 + (i - 1) * delay };
        let entry = |r: usize, i: usize| match i {
            0 => 1.0,
            _ => -linear.slopes[r * m + i - 1],
        };
        for r in 0..rows {
            root[r * stride] = own;
            for i in 0..=m {
                for j in 0..=i {
                    let left = before(i) - before(j);
                    if left <= r {
                        root[r * stride + left] += noise * entry(r, i) * entry(r - left, j);
                    }
                }
            }
        }
        for r in 0..rows {
            let (above, here) = root.split_at_mut(r * stride);
            for left in (0..=width.min(r)).rev() {
                let column = r - left;
                let reach = (width - left).min(column);
                let known = &here[left + 1..=left + reach];
                if left > 0 {
                    let other = &above[column * stride..(column + 1) * stride];
                    let sum: f64 = known.iter().zip(&other[1..]).map(|(a, b)| a * b).sum();
                    here[left] = (here[left] - sum) / other[0];
                } else {
                    let sum: f64 = known.iter().map(|a| a * a).sum();
                    here[0] = (here[0] - sum).max(f64::MIN_POSITIVE).sqrt();
                }
            }
        }
        Self { width, root }
    }

    /// Logarithm of the determinant of `L`.
    fn logarithm_of_root(&self) -> f64 {
        let diagonal = self.root.iter().step_by(self.width + 1);
        diagonal.map(|d| d.ln()).sum()
    }

    /// Multiplies by the inverse of `L`, for rows of `size` numbers.
    fn whiten(&self, rows: &mut [f64], size: usize) {
        let bands = self.root.chunks_exact(self.width + 1);
        for (r, band) in bands.enumerate() {
            let (before, here) = rows.split_at_mut(r * size);
            let here = &mut here[..size];
            for left in (1..=self.width.min(r)).filter(|left| band[*left] != 0.0) {
                let other = &before[(r - left) * size..][..size];
                for (h, o) in here.iter_mut().zip(other) {
                    *h -= band[left] * o;
                }
            }
            here.iter_mut().for_each(|h| *h /= band[0]);
        }
    }

    /// Multiplies by the inverse of `L'`.
    fn unwhiten_transposed(&self, vector: &mut [f64]) {
        let bands = self.root.chunks_exact(self.width + 1);
        for (r, band) in bands.enumerate().rev() {
            vector[r] /= band[0];
            for left in 1..=self.width.min(r) {
                vector[r - left] -= band[left] * vector[r];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{System, with_noise};

    #[test]
    fn whitening_by_the_root_of_the_covariance_is_exact() {
        let linear = Linear {
            dimension: 2,
            delay: 2,
            values: vec![0.0; 9],
            slopes: (0..18).map(|i| (f64::from(i)).sin()).collect(),
        };
        let band = Band::new(&linear, 0.7, 0.2);
        // C applied to a vector by its definition, s^2 D D' v + q^2 v, then both inverses.
        let v: Vec<f64> = (0..9).map(|i| (f64::from(i) * 1.7).cos()).collect();
        let mut transposed = [0.0; 12];
        for r in 0..9 {
            transposed[r + 3] += v[r];
            transposed[r + 2] -= linear.slopes[2 * r] * v[r];
            transposed[r] -= linear.slopes[2 * r + 1] * v[r];
        }
        let mut product: Vec<f64> = (0..9)
            .map(|r| {
                let d = transposed[r + 3]
                    - linear.slopes[2 * r] * transposed[r + 2]
                    - linear.slopes[2 * r + 1] * transposed[r];
                0.7 * d + 0.2 * v[r]
            })
            .collect();
        band.whiten(&mut product, 1);
        band.unwhiten_transposed(&mut product);
        for (found, expected) in product.iter().zip(&v) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_is_measured_and_most_of_it_removed() {
        let clean = System::Henon.samples(3000, 1);
        let noisy = with_noise(&clean, 0.05, 1);
        let model = Model::fitted(Basis::new(&noisy, 3, 1, 60), &noisy, &noisy, 3).unwrap();
        let size = |a: &[f64], b: &[f64]| {
            let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
            (square / a.len() as f64).sqrt()
        };
        let truth = size(&noisy, &clean);
        assert!((model.noise / truth - 1.0).abs() < 0.1, "{}", model.noise);
        assert!(size(&model.signal, &clean) < 0.4 * truth);
    }
}
