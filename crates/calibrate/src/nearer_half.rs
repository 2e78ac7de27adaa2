//! Some runs first: a way out of local minima.
//!
//! A run whose motion hardly bears a change (it is near a bifurcation, or hardly damped) fits in a narrow
//! valley of the parameters and nowhere else. In a sum of squares over all runs it outweighs the others and
//! keeps them from a valley of their own that is much wider, and in which the narrow one lies. Fitted by
//! themselves, the runs that are nearer lead there.

use crate::likelihood::{Likelihood, misfit};
use crate::problem::Problem;

/// Runs are as near as each other where the furthest leaves less than this times what the nearest does, or
/// than that of the noise.
const UNEVEN: f64 = 1.5;

/// The problem with that half of its runs alone that is nearer to the recordings at the coordinates `x`; none
/// where all are as near, and where one cannot be simulated.
#[must_use]
pub fn nearer_half(problem: &Problem, x: &[f64]) -> Option<Problem> {
    let by_run = Likelihood::new(problem).by_run(x).ok()?;
    let misfits: Vec<f64> = by_run.iter().map(|r| misfit(r)).collect();
    let limit = limit(&misfits)?;
    let mut each = misfits.iter();
    let mut half = problem.clone();
    half.runs
        .retain(|_| each.next().is_some_and(|m| *m <= limit));
    Some(half)
}

/// The greatest misfit of the nearer half.
fn limit(misfits: &[f64]) -> Option<f64> {
    let mut sorted = misfits.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (least, greatest) = (sorted.first()?, sorted.last()?);
    let uneven = *greatest > UNEVEN * least.max(1.0);
    uneven.then(|| sorted[sorted.len().div_ceil(2) - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_runs_lead_where_some_are_much_nearer() {
        assert_eq!(limit(&[19.6, 8.4, 7.5]), Some(8.4));
        assert_eq!(limit(&[4.0, 1.0]), Some(1.0));
        assert_eq!(limit(&[1.0, 9.0, 2.0, 8.0, 3.0]), Some(3.0));
        assert_eq!(limit(&[9.0, 8.0, 7.0]), None);
        assert_eq!(limit(&[0.5, 1.4]), None);
        assert_eq!(limit(&[7.0]), None);
        assert_eq!(limit(&[]), None);
    }
}
