//! Gradient boosting for two classes.

use crate::Matrix;
use crate::bins::Bins;
use crate::tree::{Derivatives, Tree};
use std::collections::BTreeSet;

/// Trees. This, the rate below, the leaves and the rows of a leaf are the defaults of scikit-learn's
/// `HistGradientBoostingClassifier`, so that areas can be compared.
const TREES: usize = 100;

/// Share of each step that is taken.
const RATE: f64 = 0.1;

/// A sum of trees whose value is the logarithm of the odds that a row is of the class (Friedman 2001, algorithm 5, with
/// steps of Newton's method).
#[derive(Clone, Debug)]
pub struct Boosting {
    base: f64,
    trees: Vec<Tree>,
}

impl Boosting {
    /// Trains on all rows. Columns may have missing values, any scale and any distribution.
    ///
    /// # Panics
    /// If `of_class` has not an entry for each row.
    pub fn fit(matrix: &Matrix, of_class: &[bool]) -> Self {
        assert_eq!(of_class.len(), matrix.rows(), "a class for each row");
        let inside = of_class.iter().filter(|inside| **inside).count() as f64;
        let outside = of_class.len() as f64 - inside;
        if inside == 0.0 || outside == 0.0 {
            let base = if inside > 0.0 {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            };
            return Self {
                base,
                trees: Vec::new(),
            };
        }
        let bins = Bins::new(matrix);
        let base = (inside / outside).ln();
        let mut scores = vec![base; of_class.len()];
        let trees = (0..TREES).map(|_| {
            let derivatives: Vec<Derivatives> = scores
                .iter()
                .zip(of_class)
                .map(|(score, inside)| derivatives(*score, *inside))
                .collect();
            Tree::grow(&bins, &derivatives, RATE, &mut scores)
        });
        let trees = trees.collect();
        Self { base, trees }
    }

    /// The logarithm of the odds that each row is of the class.
    pub fn scores(&self, matrix: &Matrix) -> Vec<f64> {
        let mut scores = vec![self.base; matrix.rows()];
        for tree in &self.trees {
            for (score, more) in scores.iter_mut().zip(tree.values(matrix)) {
                *score += more;
            }
        }
        scores
    }

    /// The scores that rows would have with the values of `column` in another order: row i has those of row `order[i]`.
    pub fn scores_with_shuffled(
        &self,
        matrix: &Matrix,
        column: usize,
        order: &[usize],
    ) -> Vec<f64> {
        let rows = order.iter().enumerate();
        let score = rows.map(|(row, other)| {
            let of = |c: usize| matrix.value(if c == column { *other } else { row }, c);
            self.trees
                .iter()
                .fold(self.base, |sum, tree| sum + tree.value(of))
        });
        score.collect()
    }

    /// The columns that a tree looks at.
    pub fn columns(&self) -> BTreeSet<usize> {
        self.trees.iter().flat_map(Tree::columns).collect()
    }
}

/// Of the logistic loss.
fn derivatives(score: f64, inside: bool) -> Derivatives {
    let probability = 1.0 / (1.0 + (-score).exp());
    Derivatives {
        slope: probability - f64::from(u8::from(inside)),
        curvature: probability * (1.0 - probability),
    }
}
