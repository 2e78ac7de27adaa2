//! Maps of noisy signals: noise in the delay vectors, not only in the sample that follows, and the
//! signal without it.
//!
//! With `x` the signal without noise, `y = x + e`, and `x[n+1] = f(x[n], x[n-d], ...) + w`, the error
//! of prediction is, to first order, `D e + w`: `D` has 1 at sample `n+1` and the negative slopes of
//! `f` at the coordinates. Its covariance is `s^2 D D' + q^2 1`, a band as wide as a delay vector is
//! long. Errors whitened by it give the slopes that plain regression flattens (generalised least
//! squares for errors in variables, Fuller 1987), and `x = y - s^2 D' C^-1 (error)` is the most
//! likely signal.

use crate::global_map::{Basis, FIRST_RIDGE, Fit, Linear, dot, regression, set_target};
use nalgebra::DMatrix;

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
    /// Fits to the signal `y`, starting from the estimate `start` of it. Map, noise and signal in
    /// turn, as long as the likelihood grows and at most `passes` times.
    pub fn fitted(basis: Basis, y: &[f64], start: &[f64], passes: usize) -> Option<Self> {
        let mut design = basis.design(start, 0..basis.rows(start));
        set_target(&mut design, start[basis.span() + 1..].iter().copied());
        let mut ridge = FIRST_RIDGE;
        let mut fit = regression(&design, &mut ridge)?;
        let mut signal = start.to_vec();
        let mut whitened = DMatrix::zeros(0, 0);
        let mut ratio = RATIOS.len() / 2;
        let mut best: Option<Self> = None;
        for pass in 0.. {
            let linear = basis.along(&[&fit.map], &design).remove(0);
            let smoothed = Smoothed::likeliest(&linear, y, &signal, &mut ratio);
            if best
                .as_ref()
                .is_some_and(|b| b.likelihood >= smoothed.likelihood)
            {
                break;
            }
            let (noise, own) = (smoothed.noise, smoothed.own);
            signal = smoothed.signal;
            basis.redesign(&mut design, &signal, 0..basis.rows(&signal));
            let next = if noise > 0.0 && pass < passes {
                // Regression with whitened errors. The functions are taken at the most likely
                // signal, and the target is moved by what the last slopes make of the difference to
                // `y`; the value at the signal itself cancels.
                let errors = errors(&linear, y, &signal);
                let target = errors.iter().zip(&linear.values).map(|(e, v)| e + v);
                set_target(&mut design, target);
                whitened.clone_from(&design);
                Band::new(&linear, noise, own).whiten(&mut whitened);
                regression(&whitened, &mut ridge)
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
    /// By the likeliest of `RATIOS`, looked for uphill from that at `place`, which becomes its
    /// place.
    fn likeliest(linear: &Linear, y: &[f64], x: &[f64], place: &mut usize) -> Self {
        let mut best = Self::new(linear, y, x, RATIOS[*place]);
        let (above, below) = (*place + 1..RATIOS.len(), (0..*place).rev());
        for next in above {
            let other = Self::new(linear, y, x, RATIOS[next]);
            if other.likelihood <= best.likelihood {
                break;
            }
            (best, *place) = (other, next);
        }
        // Uphill is one way only.
        if *place == below.len() {
            for next in below {
                let other = Self::new(linear, y, x, RATIOS[next]);
                if other.likelihood <= best.likelihood {
                    break;
                }
                (best, *place) = (other, next);
            }
        }
        best
    }

    fn new(linear: &Linear, y: &[f64], x: &[f64], ratio: f64) -> Self {
        let (noise, own) = (ratio / (1.0 + ratio), 1.0 / (1.0 + ratio));
        let mut errors = errors(linear, y, x);
        let count = errors.len() as f64;
        let band = Band::new(linear, noise, own);
        band.solve(&mut errors);
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
                    let sum = dot(known, &other[1..=reach]);
                    here[left] = (here[left] - sum) / other[0];
                } else {
                    here[0] = (here[0] - dot(known, known)).max(f64::MIN_POSITIVE).sqrt();
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

    /// Multiplies by the inverse of `L`.
    fn solve(&self, vector: &mut [f64]) {
        // The vector backwards, as the bands are.
        vector.reverse();
        for (r, band) in self.root.chunks_exact(self.width + 1).enumerate() {
            let place = vector.len() - 1 - r;
            let (here, before) = vector[place..].split_at_mut(1);
            let reach = self.width.min(r);
            here[0] = (here[0] - dot(&before[..reach], &band[1..=reach])) / band[0];
        }
        vector.reverse();
    }

    /// The same for every row of `rows`, block after block of columns. What earlier columns
    /// contribute is taken off, then the inverse of the block of `L` on the diagonal multiplies.
    fn whiten(&self, rows: &mut DMatrix<f64>) {
        let block = self.width.max(8);
        let entry = |r: usize, column: usize| self.root[r * (self.width + 1) + r - column];
        for start in (0..rows.ncols()).step_by(block) {
            let count = block.min(rows.ncols() - start);
            let reach = self.width.min(start);
            let first = start - reach;
            let mut inverse = DMatrix::zeros(count, count);
            for i in 0..count {
                inverse[(i, i)] = 1.0;
                for k in i.saturating_sub(self.width)..i {
                    let factor = entry(start + i, start + k);
                    for j in 0..=k {
                        let known = inverse[(j, k)];
                        inverse[(j, i)] -= factor * known;
                    }
                }
                for j in 0..=i {
                    inverse[(j, i)] /= entry(start + i, start + i);
                }
            }
            let columns = &rows.as_slice()[start * rows.nrows()..][..count * rows.nrows()];
            let mut here = DMatrix::from_column_slice(rows.nrows(), count, columns);
            if reach > 0 {
                let mut left = DMatrix::zeros(reach, count);
                for i in 0..count.min(self.width) {
                    for k in (start + i).saturating_sub(self.width).max(first)..start {
                        left[(k - first, i)] = entry(start + i, k);
                    }
                }
                here.gemm(-1.0, &rows.columns(first, reach), &left, 1.0);
            }
            rows.columns_mut(start, count)
                .gemm(1.0, &here, &inverse, 0.0);
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
        let mut rows = DMatrix::from_fn(2, 9, |i, j| product[j] * (1.0 + i as f64));
        band.whiten(&mut rows);
        band.solve(&mut product);
        for (j, expected) in product.iter().enumerate() {
            assert!((rows[(1, j)] - 2.0 * expected).abs() < 1e-12);
        }
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
