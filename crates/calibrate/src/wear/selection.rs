//! Which joints are clear, and whether the contact parameters are as stated: a selection by evidence.

use super::cell::around;
use super::descent::{Led, TIMINGS, finely, fit, roughly};
use super::discrepancy::FAR;
use super::effort::Effort;
use super::joint::Joint;
use super::model::{Contacts, Model};
use super::parts::{joined, parts};
use super::screen::{along, best_of, few, screened};
use crate::error::Error;
use crate::fit::Fit;
use crate::likelihood::Likelihood;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use crate::stages::Stage;
use crate::transfer::STRONG;

/// Points of the grid whose cells are searched: the best by the relation of the machine file, then the best of the others and
/// by all known relations.
const FOLLOWED: [usize; 2] = [4, 12];

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
    /// Whether every clearance is identifiable.
    fn is_identifiable(&self) -> bool {
        let clearances = self.fit.estimates.iter().take(self.model.clear.len());
        clearances.into_iter().all(|e| e.interval.is_some())
    }

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
    /// Each contact parameter is fitted.
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
    let search = Search { healthy, joints };
    let model = Model::new(healthy, joints, initially(joints), Contacts::Related)?;
    // What else is unknown comes last.
    let mut at = vec![0.0; model.problem.parameters.len() - x.len()];
    at.extend_from_slice(x);
    effort.begins(Stage::Clearances);
    let found = search.near_file(&model, &at, effort);
    effort.ends();
    let mut best = found?;
    if effort.stopped || best.fit.is_at_noise() {
        return Ok(best);
    }
    let parts = parts(&model)?;
    let mut points = vec![Vec::new(); parts.len()];
    let mut ends = vec![Vec::new(); parts.len()];
    for (round, count) in FOLLOWED.into_iter().enumerate() {
        for (part, (points, ends)) in parts.iter().zip(points.iter_mut().zip(&mut ends)) {
            let at = part.of_whole(&at);
            let relations = match round {
                0 => vec![at],
                _ => part.model.related(&at),
            };
            effort.begins(Stage::Screen);
            for x in relations {
                points.extend(screened(&part.model, joints, &x, effort));
            }
            effort.ends();
            effort.begins(Stage::Clearances);
            ends.extend(around(&part.model, best_of(points, count), effort));
            effort.ends();
            ends.sort_by(|a: &Led, b| a.left.total_cmp(&b.left));
        }
        effort.begins(Stage::Clearances);
        let found = search.better(best, &model, joined(&parts, &ends, &at), effort);
        effort.ends();
        best = found?;
        if effort.stopped || best.fit.is_at_noise() {
            return Ok(best);
        }
    }
    let ends: Vec<Vec<f64>> = joined(&parts, &ends, &at)
        .into_iter()
        .map(|led| led.x)
        .collect();
    effort.begins(Stage::Clearances);
    while !effort.stopped && !best.fit.is_at_noise() {
        let Some((model, led)) = search.best_step(&best, (&model, &ends), &at, effort)? else {
            break;
        };
        let before = best.criterion;
        best = search.better(best, &model, led, effort)?;
        if best.criterion >= before - STRONG {
            break;
        }
    }
    effort.ends();
    Ok(best)
}

/// A search under way.
struct Search<'a> {
    healthy: &'a Problem,
    joints: &'a [Joint],
}

impl Search<'_> {
    /// The fit that descents from the clearances of the machine file lead to, by its relation between clearances.
    fn near_file(&self, first: &Model, at: &[f64], effort: &mut Effort) -> Result<Found, Error> {
        let clear = first.clear.clone();
        let model = Model::new(self.healthy, self.joints, clear, Contacts::Stated)?;
        let at = model.coordinates_of(first, at);
        let led = roughly(&model, &[at], effort);
        let x = finely(&model, led, effort)?;
        self.settled(&model, x, effort)
    }

    /// The better one of `best` and the fits that descents from these ends lead to.
    fn better(
        &self,
        best: Found,
        model: &Model,
        led: Vec<Led>,
        effort: &mut Effort,
    ) -> Result<Found, Error> {
        let found = finely(model, led, effort).and_then(|x| self.settled(model, x, effort));
        match found {
            Ok(next) if next.criterion < best.criterion => Ok(next),
            Ok(_) | Err(Error::Nothing(_) | Error::Simulation { .. }) => Ok(best),
            Err(error) => Err(error),
        }
    }

    /// The fit of a model from `x`. Where that leads near the noise, the models with less and with more unknown of the contacts
    /// are fitted too, and the evidence decides.
    fn settled(&self, model: &Model, x: Vec<f64>, effort: &mut Effort) -> Result<Found, Error> {
        let found = judged(model.clone(), fit(model, x, effort)?)?;
        if found.misfit() > FAR {
            return Ok(found);
        }
        let from = found.fit.coordinates();
        let at_noise = found.fit.is_at_noise();
        let mut best = found;
        for contacts in [Contacts::Stated, Contacts::Related, Contacts::Fitted] {
            // What is simpler leaves at least as much.
            let hopeless = contacts < model.contacts && !at_noise;
            if effort.stopped || contacts == model.contacts || hopeless {
                continue;
            }
            let other = Model::new(self.healthy, self.joints, model.clear.clone(), contacts)?;
            let x = other.coordinates_of(model, &from);
            match fit(&other, x, effort) {
                Ok(fit) => {
                    let other = judged(other, fit)?;
                    if other.criterion < best.criterion && other.is_identifiable() {
                        best = other;
                    }
                }
                Err(Error::Nothing(_) | Error::Simulation { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(best)
    }

    /// The step that short descents favour, and where they have led; none where there is no step. `ends` are points of a
    /// model from which descents with other contact parameters start.
    fn best_step(
        &self,
        best: &Found,
        (first, ends): (&Model, &[Vec<f64>]),
        at: &[f64],
        effort: &mut Effort,
    ) -> Result<Option<(Model, Vec<Led>)>, Error> {
        let mut next: Option<(f64, Model, Vec<Led>)> = None;
        for step in steps(&best.model, self.joints) {
            let model = stepped(self.healthy, self.joints, best, step)?;
            let x = model.coordinates_of(&best.model, &best.fit.coordinates());
            let led = match step {
                Step::Clear(joint) => {
                    let place = model.clear.len() - 1;
                    let joint = &self.joints[joint];
                    let mut points = along(&model, joint, place, &x, effort);
                    let at = model.coordinates_of(first, at);
                    points.extend(along(&model, joint, place, &at, effort));
                    around(&model, points, effort)
                }
                Step::Contacts => {
                    let earlier = ends.iter().map(|x| model.coordinates_of(first, x));
                    let starts: Vec<Vec<f64>> = [x].into_iter().chain(earlier).collect();
                    roughly(&model, &starts, effort)
                }
            };
            let part = few(&model.problem);
            let likelihood = Likelihood::new(&part);
            let left = led
                .first()
                .and_then(|led| likelihood.likeliest(&led.x, &TIMINGS).ok());
            let left = left.map_or(f64::INFINITY, |(_, left)| left);
            let count = likelihood.count() as f64;
            let criterion = left + model.problem.parameters.len() as f64 * count.ln();
            if next.as_ref().is_none_or(|(least, ..)| criterion < *least) {
                next = Some((criterion, model, led));
            }
            if effort.stopped {
                return Ok(None);
            }
        }
        Ok(next.map(|(_, model, led)| (model, led)))
    }
}

/// The joints that are clear in the machine file.
fn initially(joints: &[Joint]) -> Vec<usize> {
    let all = 0..joints.len();
    all.filter(|i| joints[*i].stated.is_some()).collect()
}

fn steps(model: &Model, joints: &[Joint]) -> Vec<Step> {
    let ideal = (0..joints.len()).filter(|i| !model.clear.contains(i));
    let contacts = model.contacts != Contacts::Fitted && !model.clear.is_empty();
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
        Step::Contacts => Contacts::Fitted,
    };
    Model::new(healthy, joints, clear, contacts)
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
