//! A smooth map from delay vectors to the next sample, fitted to the whole signal.

use nalgebra::{DMatrix, DVector};

/// Width of the basis functions in standard deviations of the signal. It is wide enough that a smooth
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

    /// A column for each vector of `rows`: the functions there, and 0 in place of the target.
    pub fn design(&self, x: &[f64], rows: impl ExactSizeIterator<Item = usize>) -> DMatrix<f64> {
        let mut design = DMatrix::zeros(self.size() + 1, rows.len());
        self.redesign(&mut design, x, rows);
        design
    }

    /// The same in place of the design of another signal.
    pub fn redesign(
        &self,
        design: &mut DMatrix<f64>,
        x: &[f64],
        rows: impl Iterator<Item = usize>,
    ) {
        let (m, size) = (self.dimension, self.size());
        let columns = design.as_mut_slice().chunks_exact_mut(size + 1);
        for (row, out) in rows.zip(columns) {
            out[0] = 1.0;
            self.vector(x, row, &mut out[1..=m]);
            let (z, rest) = out[..size].split_at_mut(1 + m);
            self.multiquadrics(&z[1..], rest);
        }
    }

    /// At every vector of `design`, the next sample by each map and its derivatives by the
    /// coordinates. With weights `a` and multiquadrics `v`, those of the sum of `a v` are
    /// `-(z sum(a v^3) - sum(a c v^3)) / w^2`.
    pub fn along(&self, maps: &[&[f64]], design: &DMatrix<f64>) -> Vec<Linear> {
        let (m, size) = (self.dimension, self.size());
        let mut found: Vec<Linear> = maps
            .iter()
            .map(|_| Linear::new(self, design.ncols()))
            .collect();
        // For each map the weights, and the weights times each coordinate of the centres. Products
        // of fewer than six rows would be slow.
        let mut moments = DMatrix::zeros((maps.len() * (1 + m)).max(6), self.count);
        for (map, place) in maps.iter().zip((0..).step_by(1 + m)) {
            for (j, weight) in map[1 + m..].iter().enumerate() {
                moments[(place, j)] = *weight;
                for axis in 0..m {
                    moments[(place + 1 + axis, j)] = weight * self.centres[axis * self.count + j];
                }
            }
        }
        let mut cubes = DMatrix::zeros(self.count, BATCH);
        let mut sums = DMatrix::zeros(moments.nrows(), BATCH);
        for batch in design.as_slice().chunks(BATCH * (size + 1)) {
            let columns = batch.chunks_exact(size + 1);
            let cube_columns = cubes.as_mut_slice().chunks_exact_mut(self.count);
            for (column, cubes) in columns.clone().zip(cube_columns) {
                for (cube, v) in cubes.iter_mut().zip(&column[1 + m..]) {
                    *cube = v * v * v;
                }
            }
            sums.gemm(1.0, &moments, &cubes, 0.0);
            for (column, sums) in columns.zip(sums.column_iter()) {
                let pulls = sums.as_slice().chunks_exact(1 + m);
                for ((linear, map), pull) in found.iter_mut().zip(maps).zip(pulls) {
                    linear.values.push(dot(map, &column[..size]));
                    for axis in 1..=m {
                        let pull = column[axis] * pull[0] - pull[axis];
                        linear.slopes.push(map[axis] - pull / (WIDTH * WIDTH));
                    }
                }
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

/// Sum of products, in eight parts so that the machine can add them side by side.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
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
/// Ridges, as shares of the mean square of a function, and the place where to look first.
const RIDGES: [f64; 10] = [
    1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3,
];
pub(crate) const FIRST_RIDGE: usize = 3;
/// Largest increase of the held-out error for the sake of a larger ridge, in its standard errors.
const TOLERATED: f64 = 0.3;
/// Rows multiplied at a time.
const BATCH: usize = 256;
/// Rows of their products computed at a time.
const STRIP: usize = 80;

/// A map fitted by ridge regression.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Weights of the functions.
    pub map: Vec<f64>,
    ridge: f64,
    whole: Products,
    parts: Vec<Products>,
}

/// Sums of products of the functions and the target over some vectors.
#[derive(Clone, Debug)]
struct Products(DMatrix<f64>);

impl Products {
    fn new(columns: &[f64], size: usize) -> Self {
        let mut sums = DMatrix::zeros(size, size);
        for batch in columns.chunks(BATCH * size) {
            let batch = DMatrix::from_column_slice(size, batch.len() / size, batch);
            let transposed = batch.transpose();
            // The lower triangle, in strips.
            for start in (0..size).step_by(STRIP) {
                let height = STRIP.min(size - start);
                sums.view_mut((start, 0), (height, start + height)).gemm(
                    1.0,
                    &batch.rows(start, height),
                    &transposed.columns(0, start + height),
                    1.0,
                );
            }
        }
        sums.fill_upper_triangle_with_lower_triangle();
        Self(sums)
    }

    /// The weights with the least squared error; those of the target's own row are left out.
    fn solve(&self, ridge: f64) -> Option<Vec<f64>> {
        let size = self.0.nrows() - 1;
        let mut matrix = DMatrix::zeros(size, size);
        matrix.copy_from(&self.0.view((0, 0), (size, size)));
        (0..size).for_each(|i| matrix[(i, i)] += ridge);
        let mut map = DVector::from_column_slice(&self.0.as_slice()[size * (size + 1)..][..size]);
        matrix.cholesky()?.solve_mut(&mut map);
        Some(map.as_slice().to_vec())
    }

    /// Sum of squared errors of a map on these vectors.
    fn error(&self, map: &[f64]) -> f64 {
        let weights = |column: &[f64]| dot(&column[..map.len()], map) - column[map.len()];
        let columns = self.0.as_slice().chunks_exact(map.len() + 1);
        let sums: Vec<f64> = columns.map(weights).collect();
        dot(&sums[..map.len()], map) - sums[map.len()]
    }
}

impl Fit {
    /// The maps with each part of the signal left out in turn.
    pub fn folds(&self) -> Option<Vec<Vec<f64>>> {
        let rests = self.parts.iter().map(|part| self.rest(part));
        rests.map(|rest| rest.solve(self.ridge)).collect()
    }

    fn rest(&self, part: &Products) -> Products {
        Products(&self.whole.0 - &part.0)
    }

    /// Sum of squared errors on the parts left out.
    pub fn held_out(&self) -> Option<f64> {
        let maps = self.folds()?;
        let errors = self.parts.iter().zip(&maps);
        Some(errors.map(|(part, map)| part.error(map)).sum())
    }
}

/// Sets the target of every column of `design`.
pub(crate) fn set_target(design: &mut DMatrix<f64>, target: impl Iterator<Item = f64>) {
    let last = design.nrows() - 1;
    design
        .row_mut(last)
        .iter_mut()
        .zip(target)
        .for_each(|(d, t)| *d = t);
}

/// Ridge regression on the columns of `design`, functions and target. The ridge is the largest whose
/// held-out error is not significantly above the least (Breiman, Friedman, Olshen and Stone 1984),
/// looked for from that at `place`, which becomes its place.
pub(crate) fn regression(design: &DMatrix<f64>, place: &mut usize) -> Option<Fit> {
    let (size, count) = design.shape();
    let columns = design.as_slice();
    let parts: Vec<Products> = columns
        .chunks(count.div_ceil(FOLDS) * size)
        .map(|part| Products::new(part, size))
        .collect();
    let mut whole = parts.first()?.clone();
    parts[1..].iter().for_each(|part| whole.0 += &part.0);
    let mut fit = Fit {
        map: Vec::new(),
        ridge: 0.0,
        whole,
        parts,
    };
    let chosen: Vec<(Products, &Products)> = CHOOSING
        .iter()
        .filter_map(|fold| fit.parts.get(*fold))
        .map(|part| (fit.rest(part), part))
        .collect();
    let functions = size - 1;
    let scale = (0..functions).map(|i| fit.whole.0[(i, i)]).sum::<f64>() / functions as f64;
    let mut known = [None; RIDGES.len()];
    let mut error = |place: usize| {
        *known[place].get_or_insert_with(|| {
            let held_out = chosen.iter().map(|(rest, part)| {
                let map = rest.solve(scale * RIDGES[place]);
                map.map_or(f64::INFINITY, |map| part.error(&map))
            });
            held_out.sum::<f64>()
        })
    };
    // The error falls towards its least from both sides.
    while *place > 0 && error(*place - 1) < error(*place) {
        *place -= 1;
    }
    let mut least = error(*place);
    let tolerated = 1.0 + TOLERATED * (2.0 / count as f64).sqrt();
    while *place + 1 < RIDGES.len() && error(*place + 1) <= least * tolerated {
        *place += 1;
        least = least.min(error(*place));
    }
    fit.ridge = scale * RIDGES[*place];
    fit.map = fit.whole.solve(fit.ridge)?;
    Some(fit)
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
        let mut design = basis.design(&x, 0..basis.rows(&x));
        set_target(&mut design, x[2..].iter().copied());
        let fit = regression(&design, &mut FIRST_RIDGE.clone()).unwrap();
        let linear = &basis.along(&[&fit.map], &design)[0];
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
