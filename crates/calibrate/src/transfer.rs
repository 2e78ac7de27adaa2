//! From one clearance to another: what a calibrated machine shows there under each relation, and
//! which relation the recordings favour.
//!
//! - Recordings at one clearance do not determine the relation: every one fits them equally well, and
//!   the predictions stand side by side.
//! - With recordings at two clearances or more the machine is fitted again under each relation, from the
//!   calibrated values. The relations are compared by Schwarz's criterion (1978), the sum of squared residuals
//!   plus ln N for every exponent that was fitted, N being the number of residuals.
//! - Where the fitted runs have one clearance and those held out others, the held-out runs decide, by how
//!   well they are predicted.

pub(crate) mod case;
pub(crate) mod refit;

use crate::bounded::Bounded;
use crate::error::Error;
use crate::fit::Fit;
use crate::forecast::{Forecast, forecast};
use crate::likelihood::{Likelihood, misfit};
use crate::normal::QUANTILE;
use crate::observation::Observation;
use crate::optimiser::{LeastSquares, Progress};
use crate::problem::Problem;
use crate::relation::{ClearJoint, Relation, clearances, several};
use case::{Case, cases};
use rayon::prelude::*;
use refit::{Fitted, is_exponent, refitted, under};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Difference of the criterion from which it counts as strong (Kass and Raftery 1995).
pub(crate) const STRONG: f64 = 6.0;
/// What the relations between clearances come to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transfer {
    /// Each relation held against the recordings.
    pub relations: Vec<Hypothesis>,
    /// Which of them the recordings decide for.
    pub decision: Decision,
    /// What each shows at other clearances.
    pub predictions: Vec<Forecast>,
}

/// A relation, and how the machine fits the recordings under it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hypothesis {
    /// The relation.
    pub relation: Relation,
    /// The exponents that were fitted, by their paths; none for a relation that has none.
    pub exponents: BTreeMap<String, Bounded>,
    /// Root mean square of the misfits of the fitted runs, in standard deviations of the noise.
    pub fitted: f64,
    /// The same of the runs that were held out; `None` without such runs.
    pub held_out: Option<f64>,
    /// Each run's misfit.
    pub runs: BTreeMap<String, f64>,
    /// The criterion less that of the best relation; none where the recordings have no say.
    pub criterion: Option<f64>,
}

/// What the recordings say about the relation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// The relations that the recordings favour, the best first. One where they decide, several where the criterion
    /// differs by less than 6, none where every run has the same clearances.
    pub relations: Vec<Relation>,
    /// What that rests on.
    pub runs: Basis,
}

/// What a decision rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// The fitted runs have several clearances.
    Fitted,
    /// The fitted runs have one, and those held out have others.
    HeldOut,
    /// Every run has the same clearances.
    None,
}

/// Compares the relations for a calibrated machine, and predicts what it shows at other clearances. These are:
///
/// 1. Each clear bearing in turn at three times its normal clearance, at the conditions of each fitted run
///    without wear.
/// 2. The runs held out that have other clearances than the fitted ones.
///
/// `watch` gets each step of the fits. None where it stops one.
///
/// # Errors
/// A machine that is invalid under some relation, or a run that cannot be simulated.
pub fn transfer(
    problem: &Problem,
    fit: &Fit,
    mut watch: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Option<Transfer>, Error> {
    let mut stopped = false;
    let mut watch = |progress: &Progress| {
        let answer = watch(progress);
        stopped |= answer.is_break();
        answer
    };
    let settings = problem.runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::in_runs(&problem.tree, settings)?;
    let held_out = |run: &Observation| fit.runs.iter().any(|r| r.id == run.id && r.held_out);
    let in_run = |run: &Observation| clearances(&problem.tree, &joints, &run.settings);
    let states: Vec<_> = problem.runs.iter().map(in_run).collect::<Result<_, _>>()?;
    let of_fitted = problem.runs.iter().zip(&states);
    let of_fitted: Vec<Vec<Option<f64>>> = of_fitted
        .filter(|(run, _)| !held_out(run))
        .map(|(_, state)| state.clone())
        .collect();
    let basis = if several(&of_fitted) {
        Basis::Fitted
    } else if several(&states) {
        Basis::HeldOut
    } else {
        Basis::None
    };
    let mut machines = Vec::new();
    for relation in Relation::ALL {
        // Exponents are identifiable from several clearances only.
        if relation == Relation::Fitted && basis != Basis::Fitted {
            continue;
        }
        let start = under(problem, fit, relation, &joints)?;
        let parameters = &start.problem.parameters;
        let as_fitted = start.problem.tree == problem.tree && *parameters == problem.parameters;
        machines.push(if basis == Basis::Fitted && !as_fitted {
            refitted(start, &held_out, &mut watch)?
        } else {
            start
        });
    }
    if stopped {
        return Ok(None);
    }
    let compared = machines.iter().map(|m| hypothesis(m, &held_out, basis));
    let mut compared: Vec<(Hypothesis, Evidence)> = compared.collect();
    let decision = decide(&mut compared, basis);
    let relations: Vec<Hypothesis> = compared.into_iter().map(|(h, _)| h).collect();
    let runs: Vec<(&Observation, &Vec<Option<f64>>)> = problem.runs.iter().zip(&states).collect();
    // A clearance that was fitted holds in every run.
    let places = || problem.parameters.iter().flat_map(|p| &p.places);
    let fixed = |joint: &ClearJoint| places().any(|place| *place == joint.clearance_path());
    let cases = cases(&runs, &joints, held_out, fixed, &of_fitted);
    let pairs: Vec<(&Case, &Fitted)> = cases
        .iter()
        .flat_map(|case| machines.iter().map(move |machine| (case, machine)))
        .collect();
    let predictions = pairs
        .par_iter()
        .map(|(case, machine)| forecast(case, machine));
    let mut predictions: Vec<Forecast> = predictions.collect();
    for prediction in predictions.iter_mut().filter(|p| p.recorded) {
        let mut all = relations.iter();
        let hypothesis = all.find(|h| h.relation == prediction.relation);
        prediction.misfit = hypothesis.and_then(|h| h.runs.get(&prediction.run).copied());
    }
    Ok(Some(Transfer {
        relations,
        decision,
        predictions,
    }))
}

fn hypothesis(
    machine: &Fitted,
    held_out: &impl Fn(&Observation) -> bool,
    basis: Basis,
) -> (Hypothesis, Evidence) {
    let runs = machine.problem.runs.par_iter().map(|run| {
        let alone = machine.problem.with_runs(|other| other.id == run.id);
        (run, Likelihood::new(&alone).residuals(&machine.x))
    });
    let runs: Vec<(&Observation, Vec<f64>)> = runs.collect();
    let of = |held: bool| {
        let chosen = runs.iter().filter(|(run, _)| held_out(run) == held);
        let squares: Vec<f64> = chosen.map(|(_, r)| misfit(r).powi(2)).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        (!squares.is_empty()).then(|| mean.sqrt())
    };
    let mut exponents = BTreeMap::new();
    for (i, parameter) in machine.problem.parameters.iter().enumerate() {
        if is_exponent(parameter) {
            let [value, low, high] = [0.0, -QUANTILE, QUANTILE]
                .map(|q| parameter.value(machine.x[i] + q * machine.covariance[(i, i)].sqrt()));
            exponents.insert(parameter.path.clone(), Bounded { value, low, high });
        }
    }
    let decides = |run: &Observation| held_out(run) == (basis == Basis::HeldOut);
    let deciding = runs.iter().filter(|(run, _)| decides(run));
    let deciding: Vec<f64> = deciding.flat_map(|(_, r)| r.iter().copied()).collect();
    let evidence = Evidence {
        squares: deciding.iter().map(|r| r * r).sum(),
        count: deciding.len() as f64,
        exponents: exponents.len() as f64,
    };
    let hypothesis = Hypothesis {
        relation: machine.relation,
        exponents,
        fitted: of(false).unwrap_or(f64::NAN),
        held_out: of(true),
        runs: runs
            .iter()
            .map(|(run, r)| (run.id.clone(), misfit(r)))
            .collect(),
        criterion: None,
    };
    (hypothesis, evidence)
}

/// What the criterion is made of.
struct Evidence {
    /// Sum of the squares of the residuals.
    squares: f64,
    /// Their number.
    count: f64,
    /// Number of exponents that were fitted to them.
    exponents: f64,
}

/// Ranks the relations by the criterion.
fn decide(compared: &mut [(Hypothesis, Evidence)], basis: Basis) -> Decision {
    let mut left = Vec::new();
    if basis != Basis::None {
        // Where even the best leaves more than noise, differences are worth less.
        let shares = compared.iter().map(|(_, e)| e.squares / e.count.max(1.0));
        let excess = shares.fold(f64::INFINITY, f64::min).max(1.0);
        let criterion = |e: &Evidence| e.squares / excess + e.exponents * e.count.ln();
        let criteria = compared.iter().map(|(_, e)| criterion(e));
        let best = criteria.fold(f64::INFINITY, f64::min);
        for (hypothesis, evidence) in compared {
            let above = criterion(evidence) - best;
            hypothesis.criterion = Some(above);
            if above < STRONG {
                left.push((above, hypothesis.relation));
            }
        }
    }
    left.sort_by(|a, b| a.0.total_cmp(&b.0));
    Decision {
        relations: left.into_iter().map(|(_, relation)| relation).collect(),
        runs: basis,
    }
}
