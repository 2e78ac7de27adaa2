//! A smooth map from delay vectors to the next sample, fitted to the whole signal.

use nalgebra::{Const, DMatrix, DVector, Dyn, MatrixView};

/// Width of the basis functions in standard deviations of the signal: wide enough that a smooth
/// map needs few of them (the flat limit of Fornberg and Driscoll 2002), narrow enough for double
/// precision.
const WIDTH: f64 = 2.5;
/// Candidates per centre.
const CANDIDATES: usize = 4;

/// Functions of the delay vector `(x[n], x[n - delay], ...)`: 1, its coordinates, and inverse
/// multiquadrics `(1 + r^2 / w^2)^(-1/2)` about centres (Hardy 1971; Casdagli 1989 for time series).
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    pub dimension: usize,
    pub delay: usize,
    /// Number of centres.
    count: usize,
    /// First coordinates of all centres, then second ones, and so on.
    centres: Vec<f64>,
}

impl Basis {
    /// About `count` centres among the vectors of `x`, each as far as possible from those before.
    pub fn new(x: &[f64], dimension: usize, delay: usize, count: usize) -> Self {
        let span = (dimension - 1) * delay;
        let golden = 0.618_033_988_749_895;
        let candidates: Vec<usize> = (0..CANDIDATES * count)
            .map(|i| span + ((i as f64 * golden).fract() * (x.len() - span) as f64) as usize)
            .collect();
        let mut nearest = vec![f64::INFINITY; candidates.len()];
        let mut centres = vec![0.0; dimension * count];
        let mut next = 0;
        for place in 0..count {
            let chosen = candidates[next];
            for axis in 0..dimension {
                centres[axis * count + place] = x[chosen - axis * delay];
            }
            let mut farthest = -1.0;
            for (i, (&n, least)) in candidates.iter().zip(&mut nearest).enumerate() {
                let square = (0..dimension)
                    .map(|axis| (x[n - axis * delay] - x[chosen - axis * delay]).powi(2))
                    .sum();
                *least = least.min(square);
                if *least > farthest {
                    (farthest, next) = (*least, i);
                }
            }
        }
        Self {
            dimension,
            delay,
            count,
            centres,
        }
    }

    /// Number of functions.
    pub fn size(&self) -> usize {
        1 + self.dimension + self.count
    }

    /// Samples before the newest that a vector reaches back.
    pub fn span(&self) -> usize {
        (self.dimension - 1) * self.delay
    }

    /// Number of vectors of `x` that have a next sample.
    pub fn rows(&self, x: &[f64]) -> usize {
        x.len().saturating_sub(self.span() + 1)
    }

    fn vector(&self, x: &[f64], row: usize, z: &mut [f64]) {
        let newest = self.span() + row;
        for (axis, z) in z.iter_mut().enumerate() {
            *z = x[newest - axis * self.delay];
        }
    }

    /// Values of the multiquadrics.
    fn multiquadrics(&self, z: &[f64], out: &mut [f64]) {
        out.fill(1.0);
        for (z, centres) in z.iter().zip(self.centres.chunks_exact(self.count)) {
            for (o, c) in out.iter_mut().zip(centres) {
                let apart = (z - c) * (1.0 / WIDTH);
                *o += apart * apart;
            }
        }
        out.iter_mut().for_each(|o| *o = 1.0 / o.sqrt());
    }

    /// The functions at the vectors of `rows`, one vector after the other.
    pub fn design(&self, x: &[f64], rows: impl ExactSizeIterator<Item = usize>) -> Vec<f64> {
        let (m, size) = (self.dimension, self.size());
        let mut design = vec![0.0; rows.len() * size];
        for (row, out) in rows.zip(design.chunks_exact_mut(size)) {
            out[0] = 1.0;
            self.vector(x, row, &mut out[1..=m]);
            let (z, rest) = out.split_at_mut(1 + m);
            self.multiquadrics(&z[1..], rest);
        }
        design
    }

    /// Along the signal `x`, the next sample by each map and its derivatives by the coordinates.
    pub fn along(&self, maps: &[&[f64]], x: &[f64]) -> Vec<Linear> {
        let mut z = vec![0.0; self.dimension];
        let mut work = Work::new(self);
        let rows = self.rows(x);
        let mut found: Vec<Linear> = maps.iter().map(|_| Linear::new(self, rows)).collect();
        for row in 0..rows {
            self.vector(x, row, &mut z);
            work.prepare(self, &z);
            for (linear, map) in found.iter_mut().zip(maps) {
                work.evaluate(self, map, linear);
            }
        }
        found
    }
}

/// A map along a signal: values of the next sample, and derivatives by the coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub dimension: usize,
    pub delay: usize,
    pub values: Vec<f64>,
    /// `dimension` of them for each value.
    pub slopes: Vec<f64>,
}

impl Linear {
    fn new(basis: &Basis, rows: usize) -> Self {
        Self {
            dimension: basis.dimension,
            delay: basis.delay,
            values: Vec::with_capacity(rows),
            slopes: Vec::with_capacity(rows * basis.dimension),
        }
    }

    /// Nats per sample by which a tangent grows along the signal, step by step, each step as many
    /// samples as the tangent has coordinates. The first steps, in which it turns to the fastest
    /// growing direction, are left out.
    pub fn growth(&self) -> Vec<f64> {
        let (m, delay) = (self.dimension, self.delay);
        let width = (m - 1) * delay + 1;
        // A ring of the last displacements, the newest at `head`; at first an arbitrary tangent.
        let mut ring: Vec<f64> = (0..width).map(|i| 1.0 + (7.0 * i as f64).sin()).collect();
        let mut head = 0;
        let mut growth = Vec::with_capacity(self.values.len() / width);
        for (row, slopes) in self.slopes.chunks_exact(m).enumerate() {
            let next: f64 = slopes
                .iter()
                .enumerate()
                .map(|(axis, slope)| slope * ring[(head + axis * delay) % width])
                .sum();
            head = (head + width - 1) % width;
            ring[head] = next;
            if (row + 1) % width == 0 {
                let length = ring.iter().map(|t| t * t).sum::<f64>().sqrt().max(1e-150);
                ring.iter_mut().for_each(|t| *t /= length);
                growth.push(length.ln() / width as f64);
            }
        }
        growth.drain(..growth.len() / 20);
        growth
    }
}

/// What all maps of one basis share at a vector.
struct Work {
    z: Vec<f64>,
    /// Multiquadrics, their cubes, and the cubes times each coordinate of the centre.
    values: Vec<f64>,
    cubes: Vec<f64>,
    moments: Vec<f64>,
}

impl Work {
    fn new(basis: &Basis) -> Self {
        Self {
            z: vec![0.0; basis.dimension],
            values: vec![0.0; basis.count],
            cubes: vec![0.0; basis.count],
            moments: vec![0.0; basis.count * basis.dimension],
        }
    }

    fn prepare(&mut self, basis: &Basis, z: &[f64]) {
        self.z.copy_from_slice(z);
        basis.multiquadrics(z, &mut self.values);
        for (cube, v) in self.cubes.iter_mut().zip(&self.values) {
            *cube = v * v * v;
        }
        let centres = basis.centres.chunks_exact(basis.count);
        for (moments, centres) in self.moments.chunks_exact_mut(basis.count).zip(centres) {
            for ((moment, cube), c) in moments.iter_mut().zip(&self.cubes).zip(centres) {
                *moment = cube * c;
            }
        }
    }

    fn evaluate(&self, basis: &Basis, map: &[f64], out: &mut Linear) {
        let (linear, weights) = map.split_at(1 + basis.dimension);
        out.values
            .push(linear[0] + dot(&linear[1..], &self.z) + dot(weights, &self.values));
        let total = dot(weights, &self.cubes);
        let moments = self.moments.chunks_exact(basis.count);
        for ((slope, z), moments) in linear[1..].iter().zip(&self.z).zip(moments) {
            let pull = z * total - dot(weights, moments);
            out.slopes.push(slope - pull / (WIDTH * WIDTH));
        }
    }
}

/// Sum of products, in eight parts so that the machine can add them side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = (a8.remainder().iter().zip(b8.remainder()))
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a8.zip(b8) {
        for ((part, a), b) in parts.iter_mut().zip(a).zip(b) {
            *part += a * b;
        }
    }
    rest + parts.iter().sum::<f64>()
}

/// Parts of the signal that are left out in turn.
pub(crate) const FOLDS: usize = 5;
/// Those on which the ridge is chosen.
const CHOOSING: [usize; 2] = [1, 3];
/// Powers of ten of the ridge, as a share of the mean square of a function.
const RIDGES: std::ops::RangeInclusive<i32> = -12..=-3;
/// Largest increase of the held-out error for the sake of a larger ridge, in its standard errors.
const TOLERATED: f64 = 0.3;
/// Rows multiplied at a time.
const BATCH: usize = 256;

/// A map fitted by ridge regression.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Weights of the functions.
    pub map: Vec<f64>,
    /// The same, with each part of the signal left out in turn.
    pub folds: Vec<Vec<f64>>,
    /// Mean square error on the parts left out.
    pub held_out: f64,
}

/// Sums of products over some rows.
#[derive(Clone)]
struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
}

impl Normal {
    fn new(design: &[f64], size: usize, target: &[f64]) -> Self {
        let mut normal = Self {
            matrix: DMatrix::zeros(size, size),
            right: DVector::zeros(size),
            square: target.iter().map(|t| t * t).sum(),
        };
        for (rows, target) in design.chunks(BATCH * size).zip(target.chunks(BATCH)) {
            let rows = DMatrix::from_column_slice(size, target.len(), rows);
            let target: MatrixView<f64, Dyn, Const<1>> =
                MatrixView::from_slice_generic(target, Dyn(target.len()), Const::<1>);
            normal.right.gemv(1.0, &rows, &target, 1.0);
            normal.matrix.gemm(1.0, &rows, &rows.transpose(), 1.0);
        }
        normal
    }

    fn without(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix - &other.matrix,
            right: &self.right - &other.right,
            square: self.square - other.square,
        }
    }

    fn solve(&self, ridge: f64) -> Option<DVector<f64>> {
        let mut matrix = self.matrix.clone();
        (0..matrix.nrows()).for_each(|i| matrix[(i, i)] += ridge);
        Some(matrix.cholesky()?.solve(&self.right))
    }

    /// Sum of squared errors of a map on these rows.
    fn error(&self, map: &DVector<f64>) -> f64 {
        self.square - 2.0 * map.dot(&self.right) + map.dot(&(&self.matrix * map))
    }
}

/// Ridge regression of `target` on the rows of `design`. The ridge is the largest whose held-out
/// error is not significantly above the least (Breiman, Friedman, Olshen and Stone 1984).
pub(crate) fn regression(design: &[f64], size: usize, target: &[f64]) -> Option<Fit> {
    let count = target.len();
    let part = count.div_ceil(FOLDS);
    let parts: Vec<Normal> = (design.chunks(part * size).zip(target.chunks(part)))
        .map(|(design, target)| Normal::new(design, size, target))
        .collect();
    let mut whole = parts[0].clone();
    for other in &parts[1..] {
        whole.matrix += &other.matrix;
        whole.right += &other.right;
        whole.square += other.square;
    }
    let rests: Vec<Normal> = parts.iter().map(|p| whole.without(p)).collect();
    let scale = whole.matrix.trace() / size as f64;
    let mut errors = Vec::new();
    for power in RIDGES.rev() {
        let ridge = scale * 10.0_f64.powi(power);
        let mut error = 0.0;
        for fold in CHOOSING {
            let map = rests.get(fold)?.solve(ridge);
            error += map.map_or(f64::INFINITY, |map| parts[fold].error(&map));
        }
        errors.push((ridge, error));
    }
    let least = errors.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
    let limit = least * (1.0 + TOLERATED * (2.0 / count as f64).sqrt());
    let (ridge, _) = errors.iter().find(|(_, error)| *error <= limit)?;
    let mut held_out = 0.0;
    let mut folds = Vec::new();
    for (rest, part) in rests.iter().zip(&parts) {
        let map = rest.solve(*ridge)?;
        held_out += part.error(&map) / count as f64;
        folds.push(map.as_slice().to_vec());
    }
    Some(Fit {
        map: whole.solve(*ridge)?.as_slice().to_vec(),
        folds,
        held_out,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::System;

    #[test]
    fn the_henon_map_is_found_with_its_exponent() {
        // x(n+1) = 1 - 1.4 x(n)^2 + 0.3 x(n-1)
        let x = System::Henon.samples(2000, 1);
        let basis = Basis::new(&x, 2, 1, 60);
        let design = basis.design(&x, 0..basis.rows(&x));
        let fit = regression(&design, basis.size(), &x[2..]).unwrap();
        let linear = &basis.along(&[&fit.map], &x)[0];
        for row in (0..basis.rows(&x)).step_by(97) {
            assert!((linear.values[row] - x[row + 2]).abs() < 0.02);
            assert!((linear.slopes[2 * row] + 2.8 * x[row + 1]).abs() < 0.25);
        }
        let growth = linear.growth();
        let mean = growth.iter().sum::<f64>() / growth.len() as f64;
        assert!(
            (mean / System::Henon.exponent() - 1.0).abs() < 0.04,
            "{mean}"
        );
    }

    #[test]
    fn a_tangent_of_a_linear_recurrence_grows_by_the_largest_root() {
        // x(n+1) = 1.3 x(n) - 0.2 x(n-2) grows by the root of its characteristic polynomial.
        let linear = Linear {
            dimension: 2,
            delay: 2,
            values: vec![0.0; 4000],
            slopes: [1.3, -0.2].repeat(4000),
        };
        let root = |s: f64| s * s * s - 1.3 * s * s + 0.2;
        let growth = linear.growth();
        let rate = growth.iter().sum::<f64>() / growth.len() as f64;
        assert!(root(rate.exp()).abs() < 1e-6, "{}", rate.exp());
    }
}
