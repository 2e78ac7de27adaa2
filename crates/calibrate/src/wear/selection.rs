//! Which joints are clear, and whether the contact parameters are as stated: a selection by evidence.

use super::descent::{explored, fit};
use super::effort::Effort;
use super::joint::Joint;
use super::model::Model;
use super::screen::starts;
use crate::error::Error;
use crate::fit::Fit;
use crate::likelihood::Likelihood;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use crate::stages::Stage;

/// Difference of Schwarz's criterion from which it is strong evidence (Raftery 1995).
const STRONG: f64 = 6.0;

/// A model with its fit.
pub(super) struct Found {
    /// The model.
    pub model: Model,
    /// Its fit.
    pub fit: Fit,
    /// Schwarz's criterion: twice the negative logarithm of the likelihood, and ln n for each parameter.
    criterion: f64,
    /// Points from which its descents started.
    starts: Vec<Vec<f64>>,
}

impl Found {
    /// Misfit of all runs.
    pub fn misfit(&self) -> f64 {
        self.fit
            .misfit(false, |run| run.calibrated)
            .unwrap_or(f64::NAN)
    }
}

/// A step of the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// A joint that was ideal becomes clear.
    Clear(usize),
    /// The contact parameters are fitted.
    Contacts,
}

/// The model that the evidence favours.
///
/// # Errors
/// A machine that cannot be simulated.
pub(super) fn selected(
    healthy: &Problem,
    joints: &[Joint],
    x: &[f64],
    effort: &mut Effort,
) -> Result<Found, Error> {
    let stated = (0..joints.len()).filter(|i| joints[*i].stated.is_some());
    let model = Model::new(healthy, joints, stated.collect(), false)?;
    // What else is unknown comes last.
    let mut at = vec![0.0; model.problem.parameters.len() - x.len()];
    at.extend_from_slice(x);
    effort.begins(Stage::Screen);
    let points = starts(&model, joints, &at, None, effort);
    effort.ends();
    let mut best = fitted(model, points?, effort)?;
    while !effort.stopped && !best.fit.is_at_noise() {
        let mut next: Option<Found> = None;
        for step in steps(&best.model, joints) {
            let tried = stepped(healthy, joints, &best, step, effort)?;
            if let Some(tried) = tried
                && next.as_ref().is_none_or(|n| tried.criterion < n.criterion)
            {
                next = Some(tried);
            }
            if effort.stopped {
                break;
            }
        }
        match next {
            Some(next) if next.criterion < best.criterion - STRONG => best = next,
            _ => break,
        }
    }
    Ok(best)
}

fn steps(model: &Model, joints: &[Joint]) -> Vec<Step> {
    let ideal = (0..joints.len()).filter(|i| !model.clear.contains(i));
    let contacts = !model.contacts && !model.clear.is_empty();
    let contacts = contacts.then_some(Step::Contacts);
    contacts.into_iter().chain(ideal.map(Step::Clear)).collect()
}

/// The model one step on; none where it can be simulated nowhere.
fn stepped(
    healthy: &Problem,
    joints: &[Joint],
    best: &Found,
    step: Step,
    effort: &mut Effort,
) -> Result<Option<Found>, Error> {
    let Model {
        mut clear,
        mut contacts,
        ..
    } = best.model.clone();
    match step {
        Step::Clear(joint) => clear.push(joint),
        Step::Contacts => contacts = true,
    }
    let first = clear.len() - 1;
    let model = Model::new(healthy, joints, clear, contacts)?;
    let x = model.coordinates_of(&best.model, &best.fit.coordinates());
    effort.begins(Stage::Screen);
    let points = match step {
        Step::Clear(_) => starts(&model, joints, &x, Some(first), effort),
        Step::Contacts => {
            let earlier = best.starts.iter();
            let earlier = earlier.map(|x| model.coordinates_of(&best.model, x));
            Ok([x].into_iter().chain(earlier).collect())
        }
    };
    effort.ends();
    match fitted(model, points?, effort) {
        Ok(found) => Ok(Some(found)),
        Err(Error::Nothing(_) | Error::Simulation { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

fn fitted(model: Model, starts: Vec<Vec<f64>>, effort: &mut Effort) -> Result<Found, Error> {
    effort.begins(Stage::Clearances);
    let found = explored(&model, &starts, effort).and_then(|x| fit(&model, x, effort));
    effort.ends();
    let fit = found?;
    let likelihood = Likelihood::new(&model.problem);
    let free = fit
        .estimates
        .iter()
        .filter(|e| e.interval.is_some())
        .count();
    let deviance = likelihood.deviance(&fit.coordinates())?;
    let criterion = deviance + free as f64 * (likelihood.count() as f64).ln();
    Ok(Found {
        model,
        fit,
        criterion,
        starts,
    })
}
