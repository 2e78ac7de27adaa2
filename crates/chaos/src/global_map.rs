//! A smooth map from delay vectors to the next sample, fitted to the whole signal.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use scalar::random::Stream;

/// Functions of delay vectors: 1, the coordinates, and inverse multiquadrics.
#[derive(Clone, Debug)]
pub struct Basis {
    pub dimension: usize,
    pub delay: usize,
    /// axis-major
    pub centres: Vec<f64>,
    pub count: usize,
    pub sharpness: f64,
}

impl Basis {
    pub fn new(x: &[f64], dimension: usize, delay: usize, count: usize, width: f64) -> Self {
        let span = (dimension - 1) * delay;
        let available = x.len() - span;
        // Low-discrepancy picks along the signal, farthest-point thinning of 4x candidates.
        let golden = 0.618_033_988_749_895_f64;
        let candidates: Vec<usize> = (0..4 * count)
            .map(|i| ((i as f64 * golden).fract() * available as f64) as usize + span)
            .collect();
        let at = |n: usize, a: usize| x[n - a * delay];
        let mut nearest = vec![f64::INFINITY; candidates.len()];
        let mut chosen = Vec::new();
        let mut next = 0;
        for _ in 0..count {
            chosen.push(candidates[next]);
            let c = candidates[next];
            let (mut far, mut place) = (-1.0, 0);
            for (i, &n) in candidates.iter().enumerate() {
                let square: f64 = (0..dimension).map(|a| (at(n, a) - at(c, a)).powi(2)).sum();
                nearest[i] = f64::min(nearest[i], square);
                if nearest[i] > far {
                    far = nearest[i];
                    place = i;
                }
            }
            next = place;
        }
        let mut centres = vec![0.0; dimension * count];
        for a in 0..dimension {
            for (j, &n) in chosen.iter().enumerate() {
                centres[a * count + j] = at(n, a);
            }
        }
        Self {
            dimension,
            delay,
            centres,
            count,
            sharpness: 1.0 / (width * width),
        }
    }

    pub fn size(&self) -> usize {
        1 + self.dimension + self.count
    }

    pub fn span(&self) -> usize {
        (self.dimension - 1) * self.delay
    }

    fn squares(&self, z: &[f64], out: &mut [f64]) {
        out.fill(1.0);
        for (a, &za) in z.iter().enumerate() {
            let c = &self.centres[a * self.count..(a + 1) * self.count];
            for (o, c) in out.iter_mut().zip(c) {
                let d = za - c;
                *o += d * d * self.sharpness;
            }
        }
    }

    pub fn features(&self, z: &[f64], out: &mut [f64]) {
        let m = self.dimension;
        out[0] = 1.0;
        out[1..=m].copy_from_slice(z);
        let rest = &mut out[1 + m..];
        self.squares(z, rest);
        for o in rest {
            *o = 1.0 / o.sqrt();
        }
    }

    /// value and gradient
    pub fn evaluate(&self, theta: &[f64], z: &[f64], work: &mut [f64], slopes: &mut [f64]) -> f64 {
        let m = self.dimension;
        let mut value = theta[0];
        for a in 0..m {
            value += theta[1 + a] * z[a];
            slopes[a] = theta[1 + a];
        }
        self.squares(z, work);
        let weights = &theta[1 + m..];
        let mut sum = 0.0;
        for (w, t) in work.iter_mut().zip(weights) {
            let p = 1.0 / w.sqrt();
            sum += t * p;
            *w = t * p * p * p;
        }
        value += sum;
        let total: f64 = work.iter().sum();
        for a in 0..m {
            let c = &self.centres[a * self.count..(a + 1) * self.count];
            let dot: f64 = work.iter().zip(c).map(|(w, c)| w * c).sum();
            slopes[a] -= self.sharpness * (z[a] * total - dot);
        }
        value
    }
}

pub fn vector(x: &[f64], n: usize, basis: &Basis, z: &mut [f64]) {
    for (a, z) in z.iter_mut().enumerate() {
        *z = x[n - a * basis.delay];
    }
}

/// Banded lower Cholesky factor; row n has entries for columns n-k, k=0..=w.
pub struct Band {
    pub w: usize,
    pub l: Vec<f64>,
}

/// slopes: rows x m. rows r correspond to n = span + r.
pub fn covariance(slopes: &[f64], m: usize, delay: usize, noise: f64, model: f64) -> Band {
    let rows = slopes.len() / m;
    let w = (m - 1) * delay + 1;
    let mut l = vec![0.0; rows * (w + 1)];
    // Offsets: column = n - o, shifted by one.
    let offset = |i: usize| if i == 0 { 0 } else { 1 + (i - 1) * delay };
    let coefficient = |r: usize, i: usize| if i == 0 { 1.0 } else { -slopes[r * m + i - 1] };
    for r in 0..rows {
        l[r * (w + 1)] = model;
        for i in 0..=m {
            for j in 0..=i {
                let k = offset(i) - offset(j);
                if k <= r {
                    l[r * (w + 1) + k] += noise * coefficient(r, i) * coefficient(r - k, j);
                }
            }
        }
    }
    for r in 0..rows {
        let reach = w.min(r);
        for k in (0..=reach).rev() {
            let c = r - k;
            // sum over columns p < c of L[r,p] L[c,p]
            let mut s = l[r * (w + 1) + k];
            let back = w.saturating_sub(k).min(c);
            for q in 1..=back {
                s -= l[r * (w + 1) + k + q] * l[c * (w + 1) + q];
            }
            l[r * (w + 1) + k] = if k == 0 { s.max(1e-300).sqrt() } else { s / l[c * (w + 1)] };
        }
    }
    Band { w, l }
}

impl Band {
    /// In place L^-1 on row-major rows of `width`.
    pub fn whiten(&self, rows: &mut [f64], width: usize) {
        let w = self.w;
        let count = rows.len() / width;
        for r in 0..count {
            let (before, here) = rows.split_at_mut(r * width);
            let here = &mut here[..width];
            for k in 1..=w.min(r) {
                let c = self.l[r * (w + 1) + k];
                if c != 0.0 {
                    let other = &before[(r - k) * width..(r - k + 1) * width];
                    for (h, o) in here.iter_mut().zip(other) {
                        *h -= c * o;
                    }
                }
            }
            let d = 1.0 / self.l[r * (w + 1)];
            here.iter_mut().for_each(|h| *h *= d);
        }
    }

    /// L^-T on a vector
    pub fn back(&self, v: &mut [f64]) {
        let w = self.w;
        for r in (0..v.len()).rev() {
            v[r] /= self.l[r * (w + 1)];
            for k in 1..=w.min(r) {
                v[r - k] -= self.l[r * (w + 1) + k] * v[r];
            }
        }
    }

    pub fn log_determinant(&self) -> f64 {
        let w = self.w;
        self.l.chunks(w + 1).map(|r| 2.0 * r[0].ln()).sum()
    }
}

pub const FOLDS: usize = 5;

pub struct Fit {
    pub theta: Vec<f64>,
    pub folds: Vec<Vec<f64>>,
    pub ridge: f64,
    /// held-out mean square of whitened residual
    pub held_out: f64,
}

/// Ridge regression with cross-validation by contiguous folds. phi row-major rows x size.
pub fn regress(phi: &[f64], size: usize, g: &[f64]) -> Option<Fit> {
    let rows = g.len();
    let per = rows.div_ceil(FOLDS);
    let mut normals = Vec::new();
    for f in 0..FOLDS {
        let (a, b) = (f * per, ((f + 1) * per).min(rows));
        let mut n = DMatrix::<f64>::zeros(size, size);
        let mut r = DVector::<f64>::zeros(size);
        let mut yy = 0.0;
        for start in (a..b).step_by(256) {
            let end = (start + 256).min(b);
            let p = DMatrix::from_column_slice(size, end - start, &phi[start * size..end * size]);
            let t = DVector::from_column_slice(&g[start..end]);
            let q = p.transpose();
            n.gemm(1.0, &p, &q, 1.0);
            r.gemv(1.0, &p, &t, 1.0);
            yy += t.norm_squared();
        }
        normals.push((n, r, yy));
    }
    let mut n = DMatrix::<f64>::zeros(size, size);
    let mut r = DVector::<f64>::zeros(size);
    for (a, b, _) in &normals {
        n += a;
        r += b;
    }
    let scale = n.trace() / size as f64;
    // Held-out error of two folds for each ridge.
    let mut errors = Vec::new();
    for power in (-12..=-3).rev() {
        let ridge = scale * 10f64.powi(power);
        let (mut error, mut count) = (0.0, 0);
        for f in [1, 3] {
            let (a, b, yy) = &normals[f];
            let Some(theta) = solve(&(&n - a), &(&r - b), ridge) else { error = f64::INFINITY; break };
            error += yy - 2.0 * theta.dot(b) + theta.dot(&(a * &theta));
            count += per;
        }
        if error.is_finite() {
            errors.push((power, error / count as f64));
        }
    }
    let least = errors.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
    // One-standard-error rule (Breiman et al. 1984).
    let limit = least * (1.0 + se_factor() * (2.0 / rows as f64).sqrt());
    let power = errors.iter().find(|e| e.1 <= limit)?.0;
    let ridge = scale * 10f64.powi(power);
    let mut error = 0.0;
    let mut folds = Vec::new();
    for (a, b, yy) in &normals {
        let theta = solve(&(&n - a), &(&r - b), ridge)?;
        error += yy - 2.0 * theta.dot(b) + theta.dot(&(a * &theta));
        folds.push(theta.as_slice().to_vec());
    }
    let theta = solve(&n, &r, ridge)?;
    Some(Fit { theta: theta.as_slice().to_vec(), folds, ridge: 10f64.powi(power), held_out: error / rows as f64 })
}

fn se_factor() -> f64 { std::env::var("SE").ok().and_then(|s| s.parse().ok()).unwrap_or(0.3) }

fn solve(n: &DMatrix<f64>, r: &DVector<f64>, ridge: f64) -> Option<DVector<f64>> {
    let mut n = n.clone();
    for i in 0..n.nrows() {
        n[(i, i)] += ridge;
    }
    Some(n.cholesky()?.solve(r))
}

pub struct State {
    pub x: Vec<f64>,
    pub slopes: Vec<f64>,
    pub fit: Fit,
    pub noise: f64,
    pub model: f64,
    pub likelihood: f64,
}

pub fn slopes_along(basis: &Basis, theta: &[f64], x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let m = basis.dimension;
    let span = basis.span();
    let rows = x.len() - span - 1;
    let mut slopes = vec![0.0; rows * m];
    let mut values = vec![0.0; rows];
    let mut z = vec![0.0; m];
    let mut work = vec![0.0; basis.count];
    for r in 0..rows {
        vector(x, span + r, basis, &mut z);
        values[r] = basis.evaluate(theta, &z, &mut work, &mut slopes[r * m..(r + 1) * m]);
    }
    (values, slopes)
}

/// One pass of GLS given the current x, its slopes and the noise levels.
pub fn fit_once(basis: &Basis, y: &[f64], x: &[f64], slopes: Option<&[f64]>, noise: f64, model: f64) -> Option<Fit> {
    let m = basis.dimension;
    let span = basis.span();
    let rows = y.len() - span - 1;
    let size = basis.size();
    let mut phi = vec![0.0; rows * size];
    let mut z = vec![0.0; m];
    let mut g = vec![0.0; rows];
    for r in 0..rows {
        let n = span + r;
        vector(x, n, basis, &mut z);
        basis.features(&z, &mut phi[r * size..(r + 1) * size]);
        g[r] = y[n + 1];
        if let Some(s) = slopes {
            for a in 0..m {
                let c = n - a * basis.delay;
                g[r] -= s[r * m + a] * (y[c] - x[c]);
            }
        }
    }
    if let Some(s) = slopes {
        let band = covariance(s, m, basis.delay, noise, model);
        band.whiten(&mut phi, size);
        band.whiten(&mut g, 1);
    }
    regress(&phi, size, &g)
}

/// State estimate by one Gauss-Newton step, and log-likelihood.
pub fn smooth(basis: &Basis, theta: &[f64], y: &[f64], x: &[f64], noise: f64, model: f64) -> (Vec<f64>, f64, f64) {
    let (values, slopes) = slopes_along(basis, theta, x);
    smooth_with(basis, &values, &slopes, y, x, noise, model)
}

pub fn smooth_with(basis: &Basis, values: &[f64], slopes: &[f64], y: &[f64], x: &[f64], noise: f64, model: f64) -> (Vec<f64>, f64, f64) {
    let m = basis.dimension;
    let span = basis.span();
    let rows = values.len();
    let mut e = vec![0.0; rows];
    for r in 0..rows {
        let n = span + r;
        e[r] = y[n + 1] - values[r];
        for a in 0..m {
            let c = n - a * basis.delay;
            e[r] -= slopes[r * m + a] * (y[c] - x[c]);
        }
    }
    let band = covariance(slopes, m, basis.delay, noise, model);
    band.whiten(&mut e, 1);
    let chi: f64 = e.iter().map(|v| v * v).sum::<f64>();
    let likelihood = -0.5 * (rows as f64 * (chi / rows as f64).ln() + band.log_determinant()) / rows as f64;
    band.back(&mut e);
    let mut out = y.to_vec();
    for r in 0..rows {
        let n = span + r;
        out[n + 1] -= noise * e[r];
        for a in 0..m {
            out[n - a * basis.delay] += noise * slopes[r * m + a] * e[r];
        }
    }
    (out, likelihood, chi / rows as f64)
}

/// Growth of a tangent per sample along slopes.
pub fn exponent_along(slopes: &[f64], m: usize, delay: usize) -> Vec<f64> {
    let w = (m - 1) * delay + 1;
    let rows = slopes.len() / m;
    let mut ring = vec![0.0; w];
    for (i, r) in ring.iter_mut().enumerate() {
        *r = ((i * 7919) as f64).sin() + 0.1;
    }
    let mut growths = Vec::with_capacity(rows);
    let mut head = 0; // position of newest
    for r in 0..rows {
        let mut next = 0.0;
        for a in 0..m {
            next += slopes[r * m + a] * ring[(head + a * delay) % w];
        }
        head = (head + w - 1) % w;
        ring[head] = next;
        if (r + 1) % w == 0 || w == 1 {
            let norm = ring.iter().map(|t| t * t).sum::<f64>().sqrt().max(1e-150);
            ring.iter_mut().for_each(|t| *t /= norm);
            growths.push(norm.ln());
        }
    }
    let skip = growths.len() / 20;
    growths.drain(..skip);
    growths.iter_mut().for_each(|g| *g /= w as f64);
    growths
}

/// Free run from the given start: exponent and the trajectory, None if it leaves.
pub fn free_run(basis: &Basis, theta: &[f64], start: &[f64], steps: usize, bound: f64, kick: f64) -> Option<(f64, Vec<f64>)> {
    let m = basis.dimension;
    let span = basis.span();
    let mut x = start[..=span].to_vec();
    x.reserve(steps);
    let mut slopes = vec![0.0; steps * m];
    let mut z = vec![0.0; m];
    let mut work = vec![0.0; basis.count];
    let mut generator = Stream::seed_from_u64(0);
    for r in 0..steps {
        vector(&x, x.len() - 1, basis, &mut z);
        let v = basis.evaluate(theta, &z, &mut work, &mut slopes[r * m..(r + 1) * m]);
        if !(v.abs() < bound) {
            return None;
        }
        x.push(v + kick * generator.sample::<f64, _>(StandardNormal));
    }
    let g = exponent_along(&slopes, m, basis.delay);
    Some((g.iter().sum::<f64>() / g.len() as f64, x))
}
