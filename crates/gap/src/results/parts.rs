//! What each channel of each run says of the effects by itself.
//!
//! At the accepted fit the residuals are r + J δ to the first order. One value of the effect is given a step of its own in every
//! part, and all other values of the model are shared by all parts: a Gauss-Newton step of
//!
//! ```text
//! r + J_others δ + Σ_p (j on the rows of part p) s_p
//! ```
//!
//! The standard error of s_p is that of this regression, times what the part is left with where that is more than noise. How much the
//! sum of squares falls by letting the parts differ, over the mean square that is left, is distributed as χ² where they agree.

use crate::amendment::candidate::Candidate;
use crate::error::Error;
use crate::explain::{Explanation, by_energies};
use crate::finding::{Found, effects};
use crate::model::Model;
use calibrate::Parameter;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::optimiser::LeastSquares;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Eigenvalue of the normalised normal equations below which a direction is not identifiable.
const FLAT: f64 = 1e-9;
/// Standard deviations from which parts differ: chance does as much once in a hundred.
const DIFFER: f64 = 2.33;

/// What the parts of the recordings say of some effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByPart {
    /// The effects, with their places.
    pub effects: Vec<String>,
    /// Whether they are named; the nearest of those that were refused elsewhere.
    pub named: bool,
    /// A channel of a run each.
    pub parts: Vec<Part>,
    /// The values of the effects.
    pub values: Vec<Values>,
}

/// A channel of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub channel: String,
    /// True where the run was predicted and not fitted to.
    pub held_out: bool,
    /// Misfit of the calibrated machine without the effects, in standard deviations of the noise; none where that was not looked
    /// at.
    pub before: Option<f64>,
    /// The same with them.
    pub after: f64,
}

/// A value of an effect, as each part has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// Its path in the machine file.
    pub path: String,
    /// What was fitted to all runs together, SI.
    pub value: f64,
    /// What each part alone asks for; none where it does not show it.
    pub by_part: Vec<Option<Own>>,
    /// Whether the parts agree; none where they add nothing to it.
    pub agreement: Option<Agreement>,
}

/// A value by itself, SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Own {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// Whether parts agree about a value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// By how much the sum of squares falls where each part has a value of its own, over the mean square that is left.
    pub chi_squared: f64,
    /// Directions that this adds to those in which all can go together.
    pub degrees: usize,
    /// False where chance explains their differences once in a hundred or less.
    pub agree: bool,
}

impl ByPart {
    /// What the parts say of the effects that were found, or of the most probable one that was refused; none where nothing was
    /// tried.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub(crate) fn from_explanation(
        explanation: &Explanation,
        held_out: &[String],
    ) -> Result<Option<Self>, Error> {
        let before = &explanation.baseline;
        let named = !explanation.found.is_empty();
        if named {
            let candidates = explanation.found.iter().map(Found::candidate);
            // Where no fit follows the ringing, a step from there says nothing of a value.
            let items = match by_energies(&explanation.found) {
                true => 0,
                false => candidates.clone().map(|one| one.items().len()).sum(),
            };
            let labels = candidates.map(Candidate::label).collect();
            let models = [before, &explanation.explained];
            let parts = Self::compare(models, items, labels, held_out)?;
            return Ok(Some(Self { named, ..parts }));
        }
        let refused = explanation.refused.iter();
        let Some(nearest) = refused.max_by(|a, b| a.probability.total_cmp(&b.probability)) else {
            return Ok(None);
        };
        let Some(model) = &nearest.model else {
            return Ok(None);
        };
        let items = nearest.candidate.items().len();
        let labels = vec![nearest.candidate.label()];
        Self::compare([before, model], items, labels, held_out).map(Some)
    }

    /// What the parts say of the last `items` effects of the machine of `after`. `before` is without them.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    fn compare(
        [before, after]: [&Model; 2],
        items: usize,
        labels: Vec<String>,
        held_out: &[String],
    ) -> Result<Self, Error> {
        let known = misfits(before)?;
        let parts = misfits(after)?.into_iter().map(|(run, channel, after)| {
            let same = |part: &&(String, String, f64)| part.0 == run && part.1 == channel;
            Part {
                held_out: held_out.contains(&run),
                before: known.iter().find(same).map(|part| part.2),
                run,
                channel,
                after,
            }
        });
        Ok(Self {
            effects: labels,
            named: false,
            parts: parts.collect(),
            values: values(after, items)?,
        })
    }
}

/// Run, column and misfit of every channel.
fn misfits(model: &Model) -> Result<Vec<(String, String, f64)>, Error> {
    let by_run = Likelihood::new(&model.problem).by_run(&model.x)?;
    let mut all = Vec::new();
    for (run, residuals) in model.problem.runs.iter().zip(by_run) {
        let mut first = 0;
        for channel in &run.channels {
            let next = first + 2 * channel.orders.len();
            let own = misfit(&residuals[first..next]);
            all.push((run.id.clone(), channel.column.clone(), own));
            first = next;
        }
    }
    Ok(all)
}

/// The values of the last `items` effects, as each part has them.
fn values(model: &Model, items: usize) -> Result<Vec<Values>, Error> {
    let problem = &model.problem;
    let first = effects(problem).saturating_sub(items);
    let is_of_them = |parameter: &Parameter| {
        let index = parameter.path.strip_prefix("effects.");
        let index = index.and_then(|rest| rest.split('.').next()?.parse::<usize>().ok());
        index.is_some_and(|index| index >= first)
    };
    let own: Vec<usize> = (0..problem.parameters.len())
        .filter(|i| is_of_them(&problem.parameters[*i]))
        .collect();
    if own.is_empty() {
        return Ok(Vec::new());
    }
    let likelihood = Likelihood::coarse(problem, model.timing);
    let residuals = DVector::from_vec(likelihood.residuals(&model.x));
    let regression = Regression {
        jacobian: likelihood.jacobian(&model.x),
        residuals,
        parts: rows(model),
    };
    let of = |i: usize| {
        let (parameter, x) = (&problem.parameters[i], model.x[i]);
        let steps = regression.steps(i);
        let value = |step: f64| {
            let [low, high] = parameter.box_bounds();
            parameter.value((x + step).clamp(low, high))
        };
        let own = |step: &Step| Own {
            value: value(step.size),
            standard_error: parameter.error(value(step.size), step.error),
        };
        Values {
            path: parameter.path.clone(),
            value: parameter.value(x),
            by_part: steps.iter().map(|step| step.as_ref().map(own)).collect(),
            agreement: regression.agreement(i),
        }
    };
    Ok(own.into_iter().map(of).collect())
}

/// The rows of every channel of every run.
fn rows(model: &Model) -> Vec<Range<usize>> {
    let channels = model.problem.runs.iter().flat_map(|run| &run.channels);
    let mut first = 0;
    let ranges = channels.map(|channel| {
        let start = first;
        first += 2 * channel.orders.len();
        start..first
    });
    ranges.collect()
}

/// Residuals and their derivatives, in parts.
struct Regression {
    jacobian: DMatrix<f64>,
    residuals: DVector<f64>,
    parts: Vec<Range<usize>>,
}

/// A step of a coordinate in one part.
#[derive(Clone, Copy, Debug)]
struct Step {
    size: f64,
    error: f64,
}

/// The solution of a linear regression.
struct Solution {
    steps: DVector<f64>,
    /// Variance of each, with noise of 1; none where it is not identifiable.
    variances: Vec<Option<f64>>,
    /// Sum of squares that is left.
    left: f64,
    /// In how many directions a step changes anything.
    rank: usize,
}

impl Regression {
    /// The step of column `which` in each part; none in a part that does not show it.
    fn steps(&self, which: usize) -> Vec<Option<Step>> {
        let solution = self.solved(&self.split(which));
        let first = self.jacobian.ncols() - 1;
        let of_part = |(p, rows): (usize, &Range<usize>)| {
            let variance = solution.variances[first + p]?;
            let left = misfit(&self.residuals.as_slice()[rows.clone()]);
            Some(Step {
                size: solution.steps[first + p],
                error: variance.sqrt() * left.max(1.0),
            })
        };
        self.parts.iter().enumerate().map(of_part).collect()
    }

    /// Whether the parts agree about column `which`.
    fn agreement(&self, which: usize) -> Option<Agreement> {
        let alike = self.solved(&self.jacobian);
        let apart = self.solved(&self.split(which));
        let degrees = apart.rank.saturating_sub(alike.rank);
        if degrees == 0 {
            return None;
        }
        let free = self.residuals.len().saturating_sub(apart.rank);
        let mean_square = (apart.left / free.max(1) as f64).max(1.0);
        let chi_squared = ((alike.left - apart.left) / mean_square).max(0.0);
        Some(Agreement {
            chi_squared,
            degrees,
            agree: deviations(chi_squared, degrees) < DIFFER,
        })
    }

    /// The Jacobian without column `which`, and then that column on the rows of each part.
    fn split(&self, which: usize) -> DMatrix<f64> {
        let others = self.jacobian.clone().remove_column(which);
        // A derivative that is next to nothing beside the others is their rounding.
        let least = FLAT.sqrt() * self.jacobian.column(which).norm();
        let first = others.ncols();
        let mut split = others.resize_horizontally(first + self.parts.len(), 0.0);
        for (p, rows) in self.parts.iter().enumerate() {
            let own = self.jacobian.view((rows.start, which), (rows.len(), 1));
            if own.norm() > least {
                split
                    .view_mut((rows.start, first + p), (rows.len(), 1))
                    .copy_from(&own);
            }
        }
        split
    }

    /// The steps that leave the least; directions that change nothing are not taken.
    fn solved(&self, jacobian: &DMatrix<f64>) -> Solution {
        let count = jacobian.ncols();
        let sizes: Vec<f64> = jacobian.column_iter().map(|c| c.norm()).collect();
        let over = |i: usize| if sizes[i] > 0.0 { 1.0 / sizes[i] } else { 0.0 };
        let mut scaled = jacobian.clone();
        for (i, mut column) in scaled.column_iter_mut().enumerate() {
            column *= over(i);
        }
        let SymmetricEigen {
            eigenvalues,
            eigenvectors,
        } = SymmetricEigen::new(scaled.tr_mul(&scaled));
        let gradient = scaled.tr_mul(&self.residuals);
        let mut steps = DVector::zeros(count);
        let (mut variances, mut flat) = (vec![0.0; count], vec![0.0; count]);
        for (value, vector) in eigenvalues.iter().zip(eigenvectors.column_iter()) {
            let steep = *value > FLAT;
            if steep {
                steps -= vector * (vector.dot(&gradient) / value);
            }
            for i in 0..count {
                let square = vector[i] * vector[i];
                match steep {
                    true => variances[i] += square / value,
                    false => flat[i] += square,
                }
            }
        }
        let left = (&self.residuals + &scaled * &steps).norm_squared();
        let identifiable = |i: usize| sizes[i] > 0.0 && flat[i] < FLAT.sqrt();
        Solution {
            variances: (0..count)
                .map(|i| identifiable(i).then(|| variances[i] * over(i) * over(i)))
                .collect(),
            steps: DVector::from_fn(count, |i, _| steps[i] * over(i)),
            rank: eigenvalues.iter().filter(|value| **value > FLAT).count(),
            left,
        }
    }
}

/// How many standard deviations of a normal distribution a χ² lies above its median (Wilson and Hilferty 1931).
fn deviations(chi_squared: f64, degrees: usize) -> f64 {
    let ninth = 2.0 / (9.0 * degrees as f64);
    ((chi_squared / degrees as f64).cbrt() - (1.0 - ninth)) / ninth.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three parts of two rows with one shared value beside the one that is looked at.
    fn regression() -> Regression {
        Regression {
            jacobian: DMatrix::from_row_slice(
                6,
                2,
                &[3.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 4.0, 2.0, 0.0, 0.0, 0.0],
            ),
            residuals: DVector::from_vec(vec![1.0, -2.0, 1.0, -8.0, 1.0, 0.0]),
            parts: vec![0..2, 2..4, 4..6],
        }
    }

    #[test]
    fn a_value_that_shares_nothing_with_the_others_is_that_of_its_part() {
        // −j·r/j·j and 1/√(j·j): the second column is (0, 2), (0, 4) and nothing in the parts.
        let steps = regression().steps(1);
        let [a, b] = [steps[0].unwrap(), steps[1].unwrap()];
        assert!((a.size - 1.0).abs() < 1e-12 && (b.size - 2.0).abs() < 1e-12);
        let left = [2.5_f64, 32.5].map(f64::sqrt);
        assert!((a.error - left[0] / 2.0).abs() < 1e-12, "{a:?}");
        assert!((b.error - left[1] / 4.0).abs() < 1e-12, "{b:?}");
        assert!(steps[2].is_none());
    }

    #[test]
    fn what_parts_gain_by_differing_is_their_chi_squared() {
        let regression = regression();
        let agreement = regression.agreement(1).unwrap();
        // Together the step is (4 + 32)/(4 + 16) = 1.8, which leaves (−2 + 3.6)² + (−8 + 7.2)² = 3.2; apart nothing is left. The
        // first column takes −6/14 and leaves 3 − 36/14; the mean square over three degrees is below 1, and counts as 1.
        assert!((agreement.chi_squared - 3.2).abs() < 1e-9, "{agreement:?}");
        assert_eq!((agreement.degrees, agreement.agree), (1, true));
    }

    #[test]
    fn a_value_that_another_one_imitates_is_not_identifiable() {
        let regression = Regression {
            jacobian: DMatrix::from_row_slice(4, 2, &[1.0, 1.0, 2.0, 2.0, 0.0, 1.0, 0.0, 3.0]),
            residuals: DVector::from_vec(vec![1.0, 0.0, 0.5, 0.1]),
            parts: vec![0..2, 2..4],
        };
        let steps = regression.steps(1);
        assert!(steps[0].is_none() && steps[1].is_some());
        assert!(regression.agreement(1).is_none());
    }

    #[test]
    fn a_part_whose_derivatives_are_rounding_shows_nothing_and_counts_for_nothing() {
        let regression = Regression {
            jacobian: DMatrix::from_column_slice(6, 1, &[1.0, 2.0, 2.0, 1.0, 1e-12, -1e-12]),
            residuals: DVector::from_vec(vec![0.5, 1.0, 1.0, 0.5, 3.0, 1.0]),
            parts: vec![0..2, 2..4, 4..6],
        };
        let steps = regression.steps(0);
        assert!(steps[0].is_some() && steps[1].is_some() && steps[2].is_none());
        assert_eq!(regression.agreement(0).unwrap().degrees, 1);
    }

    #[test]
    fn what_no_part_shows_of_two_values_each_by_itself_counts_as_one_disagreement() {
        // In each of three parts the two values act alike, by different shares: together they have two directions, apart three.
        let regression = Regression {
            jacobian: DMatrix::from_row_slice(
                6,
                2,
                &[1.0, 1.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0],
            ),
            residuals: DVector::from_vec(vec![4.0, 0.0, -8.0, 0.0, 4.0, 0.0]),
            parts: vec![0..2, 2..4, 4..6],
        };
        for which in [0, 1] {
            assert!(regression.steps(which).iter().all(Option::is_none));
            // (1, −2, 1) is at right angles to both columns: all of 4² + 8² + 4² = 96 is left together, nothing apart.
            let agreement = regression.agreement(which).unwrap();
            assert!((agreement.chi_squared - 96.0).abs() < 1e-9, "{agreement:?}");
            assert_eq!((agreement.degrees, agreement.agree), (1, false));
        }
    }

    #[test]
    fn a_chi_squared_that_chance_exceeds_once_in_a_hundred_is_the_limit() {
        // Quantiles of 99 %: 6.635 of one degree, 23.209 of ten.
        for (chi_squared, degrees) in [(6.635, 1), (23.209, 10)] {
            let found = deviations(chi_squared, degrees);
            assert!((found - 2.326).abs() < 0.1, "{found}");
        }
    }
}
