//! Some runs first: a way out of local minima.
//!
//! A run that is near a bifurcation or hardly damped fits in a narrow valley of the parameters only. In a sum of
//! squares over all runs it outweighs the others. It keeps them from a much wider valley of their own, in which the
//! narrow one lies. A local minimum of all runs is seldom one of half of them: all parts have only the true one in
//! common.

use crate::likelihood::{Likelihood, misfit};
use crate::problem::Problem;

/// Runs are as near as each other where the furthest leaves less than this times what the nearest does, or
/// than that of the noise.
const AS_NEAR: f64 = 1.5;

/// The problem with parts of its runs alone, as they are at the coordinates `x`. The parts are the better-fitting half,
/// the other half, and every other run from the best on. None for a single run, nor where a run cannot be simulated.
pub(crate) fn halves(problem: &Problem, x: &[f64]) -> Vec<Problem> {
    let parts = misfits(problem, x).map(|misfits| parts(&misfits));
    let parts = parts.unwrap_or_default().into_iter();
    parts.map(|part| with(problem, &part)).collect()
}

/// The problem with the nearer half of its runs alone; none where all are as near.
#[must_use]
pub fn nearer_half(problem: &Problem, x: &[f64]) -> Option<Problem> {
    let misfits = misfits(problem, x).filter(|misfits| are_uneven(misfits))?;
    let nearer = parts(&misfits).into_iter().next()?;
    Some(with(problem, &nearer))
}

fn misfits(problem: &Problem, x: &[f64]) -> Option<Vec<f64>> {
    let by_run = Likelihood::new(problem).by_run(x).ok()?;
    Some(by_run.iter().map(|residuals| misfit(residuals)).collect())
}

fn are_uneven(misfits: &[f64]) -> bool {
    let least = misfits.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = misfits.iter().copied().fold(0.0, f64::max);
    greatest > AS_NEAR * least.max(1.0)
}

fn with(problem: &Problem, runs: &[usize]) -> Problem {
    let mut part = problem.clone();
    part.runs = runs.iter().map(|i| problem.runs[*i].clone()).collect();
    part
}

/// The parts, by the indices of their runs.
fn parts(misfits: &[f64]) -> Vec<Vec<usize>> {
    let mut nearest: Vec<usize> = (0..misfits.len()).collect();
    nearest.sort_by(|i, j| misfits[*i].total_cmp(&misfits[*j]));
    let (count, half) = (misfits.len(), misfits.len().div_ceil(2));
    let mut parts = match count {
        0 | 1 => Vec::new(),
        _ => vec![
            nearest[..half].to_vec(),
            nearest[count - half..].to_vec(),
            nearest.iter().copied().step_by(2).collect(),
        ],
    };
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts.truncate(count);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_half_comes_first() {
        let expected = [vec![1, 2], vec![0, 1], vec![0, 2]];
        assert_eq!(parts(&[19.6, 8.4, 7.5]), expected);
        assert_eq!(parts(&[4.0, 1.0]), [[1], [0]]);
        assert_eq!(parts(&[1.0, 9.0, 2.0, 8.0]), [[0, 2], [1, 3], [0, 3]]);
        assert!(parts(&[7.0]).is_empty() && parts(&[]).is_empty());
    }

    #[test]
    fn runs_are_uneven_where_one_leaves_much_more_than_another_and_than_noise() {
        assert!(are_uneven(&[19.6, 8.4, 7.5]));
        assert!(!are_uneven(&[9.0, 8.0, 7.0]) && !are_uneven(&[0.5, 1.4]) && !are_uneven(&[7.0]));
    }
}
