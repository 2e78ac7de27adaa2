//! Which joints are clear, and whether the contact parameters are as stated: a selection by evidence.

use super::descent::{Led, finely, fit, roughly};
use super::effort::Effort;
use super::joint::Joint;
use super::model::Model;
use super::screen::{along, few, starts};
use crate::error::Error;
use crate::fit::{Fit, Optimiser};
use crate::likelihood::Likelihood;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use crate::stages::Stage;
use crate::transfer::STRONG;

/// Points from which descents with the contact parameters of the machine file start. All points are followed only where
/// these do not lead to the noise.
const FIRST: usize = 12;

/// A model with its fit.
pub(super) struct Found {
    /// The model.
    pub model: Model,
    /// Its fit.
    pub fit: Fit,
    /// Schwarz's criterion: twice the negative logarithm of the likelihood, and ln n for each parameter.
    criterion: f64,
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
    let model = Model::new(healthy, joints, initially(joints), false)?;
    // What else is unknown comes last.
    let mut at = vec![0.0; model.problem.parameters.len() - x.len()];
    at.extend_from_slice(x);
    effort.begins(Stage::Screen);
    let points = starts(&model, joints, &at, effort);
    effort.ends();
    let points = points?;
    effort.begins(Stage::Clearances);
    let first = &points[..points.len().min(FIRST)];
    let led = roughly(&model, first, effort);
    let mut best = fitted(model, led, effort)?;
    while !effort.stopped && !best.fit.is_at_noise() {
        let Some((model, led)) = best_step(healthy, joints, &best, &points, effort)? else {
            break;
        };
        match fitted(model, led, effort) {
            Ok(next) if next.criterion < best.criterion - STRONG => best = next,
            Ok(_) | Err(Error::Nothing(_) | Error::Simulation { .. }) => break,
            Err(error) => return Err(error),
        }
    }
    if !effort.stopped && !best.fit.is_at_noise() {
        best = searched(best, effort)?;
    }
    effort.ends();
    Ok(best)
}

/// The step that short descents favour, and where they have led; none where there is no step.
fn best_step(
    healthy: &Problem,
    joints: &[Joint],
    best: &Found,
    points: &[Vec<f64>],
    effort: &mut Effort,
) -> Result<Option<(Model, Vec<Led>)>, Error> {
    let mut next: Option<(f64, Model, Vec<Led>)> = None;
    for step in steps(&best.model, joints) {
        let model = stepped(healthy, joints, best, step)?;
        let x = model.coordinates_of(&best.model, &best.fit.coordinates());
        let starts = match step {
            Step::Clear(joint) => {
                let place = model.clear.len() - 1;
                along(&model, &joints[joint], place, &x, effort)
            }
            Step::Contacts => {
                let first = Model::new(healthy, joints, initially(joints), false)?;
                let earlier = points.iter().map(|x| model.coordinates_of(&first, x));
                [x].into_iter().chain(earlier).collect()
            }
        };
        let led = roughly(&model, &starts, effort);
        let left = led.first().map_or(f64::INFINITY, |led| led.left);
        let count = Likelihood::new(&few(&model.problem)).count();
        let criterion = left + model.problem.parameters.len() as f64 * (count as f64).ln();
        if next.as_ref().is_none_or(|(least, ..)| criterion < *least) {
            next = Some((criterion, model, led));
        }
        if effort.stopped {
            return Ok(None);
        }
    }
    Ok(next.map(|(_, model, led)| (model, led)))
}

/// The joints that are clear in the machine file.
fn initially(joints: &[Joint]) -> Vec<usize> {
    let all = 0..joints.len();
    all.filter(|i| joints[*i].stated.is_some()).collect()
}

fn steps(model: &Model, joints: &[Joint]) -> Vec<Step> {
    let ideal = (0..joints.len()).filter(|i| !model.clear.contains(i));
    let contacts = !model.contacts && !model.clear.is_empty();
    let contacts = contacts.then_some(Step::Contacts);
    contacts.into_iter().chain(ideal.map(Step::Clear)).collect()
}

/// The model one step on.
fn stepped(healthy: &Problem, joints: &[Joint], best: &Found, step: Step) -> Result<Model, Error> {
    let mut clear = best.model.clear.clone();
    let contacts = match step {
        Step::Clear(joint) => {
            clear.push(joint);
            best.model.contacts
        }
        Step::Contacts => true,
    };
    Model::new(healthy, joints, clear, contacts)
}

/// A fit that stopped above the noise, continued by the search of a calibration: kicks, and starts elsewhere.
fn searched(found: Found, effort: &mut Effort) -> Result<Found, Error> {
    let x = found.fit.coordinates();
    let searched = fit(&found.model, x, Optimiser::Default, effort)?;
    let continued = judged(found.model.clone(), searched)?;
    Ok(match continued.criterion < found.criterion {
        true => continued,
        false => found,
    })
}

fn fitted(model: Model, led: Vec<Led>, effort: &mut Effort) -> Result<Found, Error> {
    let x = finely(&model, led, effort)?;
    let fit = fit(&model, x, Optimiser::LevenbergMarquardt, effort)?;
    judged(model, fit)
}

/// A fit with its criterion.
fn judged(model: Model, fit: Fit) -> Result<Found, Error> {
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
    })
}
