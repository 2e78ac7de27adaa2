//! What recordings of a motion that scatters determine: the means of its lines, and of its energies.
//!
//! Revolutions that differ have a mean in which what differs is lost. How strongly a machine knocks, and where, does not show there,
//! but in the mean of their energies.

use crate::energies::Energies;
use crate::likelihood::Likelihood;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use nalgebra::DMatrix;

/// The residuals of lines, then those of energies.
pub(crate) struct Statistics<'a> {
    lines: Likelihood<'a>,
    energies: Energies<'a>,
}

impl<'a> Statistics<'a> {
    /// Of this problem.
    pub fn new(problem: &'a Problem) -> Self {
        Self {
            lines: Likelihood::new(problem),
            energies: Energies::new(problem),
        }
    }
}

impl LeastSquares for Statistics<'_> {
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.lines.bounds()
    }

    fn count(&self) -> usize {
        self.lines.count() + self.energies.count()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.residuals_of_all(&[x.to_vec()]).concat()
    }

    fn residuals_of_all(&self, all: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let lines = self.lines.residuals_of_all(all).into_iter();
        let both = lines.zip(self.energies.residuals_of_all(all));
        both.map(|(lines, energies)| [lines, energies].concat())
            .collect()
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let [lines, energies] = [self.lines.jacobian(x), self.energies.jacobian(x)];
        let rows: Vec<_> = lines.row_iter().chain(energies.row_iter()).collect();
        DMatrix::from_rows(&rows)
    }
}
