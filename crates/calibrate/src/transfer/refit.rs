//! A calibrated machine under another relation, fitted again where the recordings decide.

use crate::error::Error;
use crate::fit::Fit;
use crate::identifiability::information;
use crate::likelihood::Likelihood;
use crate::normal::QUANTILE;
use crate::observation::Observation;
use crate::optimiser::{Watch, levenberg_marquardt};
use crate::parameter::Parameter;
use crate::problem::Problem;
use crate::relation::{ClearJoint, Relation, exponents};
use crate::search;
use nalgebra::DMatrix;

/// Most evaluations of the model for a fit under another relation: some ten steps. One that needs
/// more is far off.
const EVALUATIONS: u64 = 80;

/// A machine as it was fitted under a relation.
pub(crate) struct Fitted {
    pub relation: Relation,
    pub problem: Problem,
    /// The coordinates of its parameters.
    pub x: Vec<f64>,
    /// Their covariance, a row and a column per parameter; 0 for one that is not identifiable.
    pub covariance: DMatrix<f64>,
}

/// The calibrated machine with another relation in its place.
pub(super) fn under(
    problem: &Problem,
    fit: &Fit,
    relation: Relation,
    joints: &[ClearJoint],
) -> Result<Fitted, Error> {
    let exponent = |i: &usize| is_exponent(&problem.parameters[*i]);
    let all = 0..problem.parameters.len();
    // Exponents that were fitted stay as they are.
    let found = relation == Relation::Fitted && all.clone().any(|i| exponent(&i));
    let keep: Vec<usize> = all.filter(|i| found || !exponent(i)).collect();
    let mut kept = problem.with_parameters(&keep);
    if !found {
        relation.set(&mut kept.tree, joints)?;
    }
    let mut x = Vec::new();
    let mut intervals = Vec::new();
    for i in &keep {
        let estimate = &fit.estimates[*i];
        let coordinate = |value| estimate.parameter.coordinate(value);
        let value = coordinate(estimate.value);
        x.push(value);
        intervals.push(estimate.interval.map_or([value; 2], |i| i.map(coordinate)));
    }
    let correlations = DMatrix::from_fn(keep.len(), keep.len(), |i, j| {
        fit.correlations[(keep[i], keep[j])]
    });
    let mut covariance = covariance(&intervals, &correlations);
    if relation == Relation::Fitted && !found {
        let exponents = exponents(&kept.tree)?;
        x.resize(x.len() + exponents.len(), 0.0);
        covariance = covariance.resize(x.len(), x.len(), 0.0);
        kept.parameters.extend(exponents);
    }
    Ok(Fitted {
        relation,
        problem: kept,
        x,
        covariance,
    })
}

pub(super) fn is_exponent(parameter: &Parameter) -> bool {
    parameter.path.contains(".relation.")
}

fn covariance(intervals: &[[f64; 2]], correlations: &DMatrix<f64>) -> DMatrix<f64> {
    let deviation = |i: usize| {
        let [low, high] = intervals[i];
        0.5 * (high - low).abs() / QUANTILE
    };
    DMatrix::from_fn(intervals.len(), intervals.len(), |i, j| {
        correlations[(i, j)] * deviation(i) * deviation(j)
    })
}

/// The machine fitted again from where it stands. A parameter that is not identifiable keeps its value.
pub(super) fn refitted(
    start: Fitted,
    held_out: &impl Fn(&Observation) -> bool,
    watch: Watch,
) -> Result<Fitted, Error> {
    let identifiable =
        |i: &usize| is_exponent(&start.problem.parameters[*i]) || start.covariance[(*i, *i)] > 0.0;
    let free: Vec<usize> = (0..start.x.len()).filter(identifiable).collect();
    // A parameter that is not identifiable keeps the value that the file has.
    let problem = start.problem.with_parameters(&free);
    let fitted = problem.with_runs(|run| !held_out(run));
    let likelihood = Likelihood::new(&fitted);
    let from: Vec<f64> = free.iter().map(|i| start.x[*i]).collect();
    let found = levenberg_marquardt(&likelihood, &from, search::CHANGE, EVALUATIONS, watch)?;
    let information = information(&likelihood, &found.x);
    Ok(Fitted {
        relation: start.relation,
        problem,
        x: found.x,
        covariance: covariance(&information.intervals, &information.correlations),
    })
}
