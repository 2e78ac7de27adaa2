//! Which terms of a library explain a residual: greedy forward selection. It is accepted only where it is
//! stable under resampling (Meinshausen and Bühlmann 2010, in the complementary pairs of Shah and
//! Samworth 2013).
//!
//! |t + N δ + D c|² + |δ|² + |c|² is minimised, with the nuisance N of what is calibrated and the
//! terms D. Both have priors of 1, so that neither goes further than it may. All selections work on
//! the normal matrix of the lines that are drawn.

use crate::criteria::NOISE;
use nalgebra::{DMatrix, DVector};
use rand::seq::SliceRandom;
use scalar::random::{Purpose, stream};

/// Share of the squared misfit above the noise that a law has to take.
const EARNED: f64 = 0.3;
/// Most groups of terms: what needs more is no law.
const MOST_GROUPS: usize = 3;
/// Pairs of halves that are drawn.
const PAIRS: u64 = 50;
/// Share of the halves in which a group must be chosen to be believed.
const STABLE: f64 = 0.8;
/// Seed of the draws.
const SEED: u64 = 0;

/// A residual and what may explain it. Rows come in pairs: the real and the imaginary part of a line.
pub(crate) struct Regression {
    /// Derivatives by the calibrated parameters, over their priors.
    pub nuisance: DMatrix<f64>,
    /// Derivatives by the terms, over their priors.
    pub terms: DMatrix<f64>,
    /// The residual.
    pub target: DVector<f64>,
}

impl Regression {
    /// The groups that are chosen in most halves of the lines, in their order. A group is a list of columns of `terms`.
    pub fn stable(&self, groups: &[Vec<usize>]) -> Vec<usize> {
        let lines: Vec<usize> = (0..self.target.len() / 2).collect();
        let whole = self.normal(&lines);
        let half = lines.len() / 2;
        let mut counts = vec![0_u32; groups.len()];
        for pair in 0..PAIRS {
            let mut lines = lines.clone();
            lines.shuffle(&mut stream(SEED, pair, Purpose::Split));
            let first = self.normal(&lines[..half]);
            let second = &whole - &first;
            for (normal, lines) in [(first, half), (second, lines.len() - half)] {
                for group in self.eliminated(&normal).chosen(groups, 2 * lines) {
                    counts[group] += 1;
                }
            }
        }
        let enough = |group: &usize| f64::from(counts[*group]) >= STABLE * (2 * PAIRS) as f64;
        (0..groups.len()).filter(enough).collect()
    }

    /// Coefficients of some terms that explain most.
    pub fn fitted(&self, terms: &[usize]) -> Vec<f64> {
        let lines: Vec<usize> = (0..self.target.len() / 2).collect();
        self.eliminated(&self.normal(&lines)).solved(terms).0
    }

    /// The normal matrix of nuisance, terms and target over some lines.
    fn normal(&self, lines: &[usize]) -> DMatrix<f64> {
        let columns = self.nuisance.ncols() + self.terms.ncols() + 1;
        let rows: Vec<usize> = lines.iter().flat_map(|i| [2 * i, 2 * i + 1]).collect();
        let of = |i: usize, j: usize| {
            let row = rows[i];
            match j.checked_sub(self.nuisance.ncols()) {
                None => self.nuisance[(row, j)],
                Some(j) if j < self.terms.ncols() => self.terms[(row, j)],
                Some(_) => self.target[row],
            }
        };
        let drawn = DMatrix::from_fn(rows.len(), columns, of);
        drawn.tr_mul(&drawn)
    }

    /// A normal matrix with the nuisance eliminated.
    fn eliminated(&self, normal: &DMatrix<f64>) -> Eliminated {
        let count = self.nuisance.ncols();
        let rest = normal.ncols() - count;
        let own = normal.view((0, 0), (count, count)) + DMatrix::identity(count, count);
        let across = normal.view((0, count), (count, rest)).into_owned();
        let left = normal.view((count, count), (rest, rest)).into_owned();
        Eliminated(match own.cholesky() {
            Some(own) => left - across.tr_mul(&own.solve(&across)),
            None => left,
        })
    }
}

/// The normal matrix of terms and target, the target last.
struct Eliminated(DMatrix<f64>);

impl Eliminated {
    fn target(&self) -> usize {
        self.0.ncols() - 1
    }

    /// Sum of squares of the target.
    fn squares(&self) -> f64 {
        self.0[(self.target(), self.target())]
    }

    /// Coefficients of some terms, and the sum of squares that they leave.
    fn solved(&self, terms: &[usize]) -> (Vec<f64>, f64) {
        let n = terms.len();
        let own = DMatrix::from_fn(n, n, |i, j| {
            self.0[(terms[i], terms[j])] + f64::from(u8::from(i == j))
        });
        let with = DVector::from_fn(n, |i, _| self.0[(terms[i], self.target())]);
        match own.cholesky() {
            Some(own) => {
                let solution = own.solve(&with);
                let left = self.squares() - with.dot(&solution);
                (solution.iter().map(|c| -c).collect(), left)
            }
            None => (vec![0.0; n], self.squares()),
        }
    }

    /// Groups one after another. Each explains most beside those before, as long as it
    /// takes its share of what is left of `count` residuals.
    fn chosen(&self, groups: &[Vec<usize>], count: usize) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        let mut left = self.squares();
        let terms = |chosen: &[usize]| -> Vec<usize> {
            chosen.iter().flat_map(|g| groups[*g].clone()).collect()
        };
        while chosen.len() < MOST_GROUPS && left > NOISE * NOISE * count as f64 {
            let with = |group: usize| {
                let mut more = chosen.clone();
                more.push(group);
                (group, self.solved(&terms(&more)).1)
            };
            let others = (0..groups.len()).filter(|g| !chosen.contains(g));
            let Some((group, after)) = others.map(with).min_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            if after > (1.0 - EARNED) * left {
                break;
            }
            chosen.push(group);
            left = after;
        }
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    /// Uniform numbers in [-1, 1].
    fn random(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
        let mut numbers = stream(seed, 0, Purpose::Noise);
        let mut next = || 2.0 * (numbers.next_u32() as f64 / u32::MAX as f64) - 1.0;
        DMatrix::from_fn(rows, columns, |_, _| next())
    }

    fn regression(target: impl Fn(&DMatrix<f64>, &DMatrix<f64>) -> DVector<f64>) -> Regression {
        let (nuisance, terms) = (random(400, 2, 1) * 30.0, random(400, 6, 2) * 30.0);
        let noise = random(400, 1, 3) * 3_f64.sqrt();
        let target = target(&nuisance, &terms) + noise.column(0);
        Regression {
            nuisance,
            terms,
            target,
        }
    }

    fn groups() -> Vec<Vec<usize>> {
        vec![vec![0], vec![1], vec![2, 3], vec![4], vec![5]]
    }

    #[test]
    fn the_terms_of_a_law_are_chosen_and_no_other() {
        let law = regression(|nuisance, terms| {
            -(terms.column(1) * 0.5 + terms.column(3) * 0.8) + nuisance.column(0) * 0.9
        });
        assert_eq!(law.stable(&groups()), [1, 2]);
        let coefficients = law.fitted(&[1, 2, 3]);
        for (found, expected) in coefficients.iter().zip([0.5, 0.0, 0.8]) {
            assert!((found - expected).abs() < 0.02, "{found}");
        }
    }

    #[test]
    fn noise_and_what_is_calibrated_have_no_law() {
        let noise = regression(|nuisance, _| nuisance.column(1) * 0.7);
        assert!(noise.stable(&groups()).is_empty());
        // What no term explains has none either, however large.
        let other = regression(|_, _| random(400, 1, 9).column(0) * 100.0);
        assert!(other.stable(&groups()).is_empty());
    }
}
