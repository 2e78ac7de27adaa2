//! Which joints are clear, and whether the contact parameters are as stated: a selection by evidence.

use super::cell::around;
use super::descent::{Led, finely, fit, roughly};
use super::discrepancy::{FAR, TIMINGS};
use super::effort::Effort;
use super::joint::Joint;
use super::model::{Contacts, Model};
use super::parts::{joined, parts};
use super::screen::{Point, best_of, by_lines, few, screened, with_one_more};
use crate::error::Error;
use crate::fit::Fit;
use crate::likelihood::Likelihood;
use crate::observation::Observation;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use crate::stages::Stage;
use crate::transfer::STRONG;
use std::collections::BTreeMap;

/// Points of the grid whose cells are searched: the best by the relation of the machine file, then the best of the others and
/// by all known relations.
const FOLLOWED: [usize; 2] = [4, 12];
/// Points that are searched where one more joint is clear, over all such joints, and points from which they are screened.
const CLEAR_POINTS: usize = 4;
const STARTS: usize = 3;

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

/// What a step of the selection may change.
#[derive(Clone, Copy)]
struct Steps {
    /// A joint that was ideal becomes clear.
    joints: bool,
    /// Each contact parameter is fitted.
    contacts: bool,
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
    // Fits of motions that scatter take long: the best cells are all that is searched.
    let repeats = healthy.runs.iter().all(Observation::repeats);
    let rounds = if repeats { FOLLOWED.len() } else { 1 };
    let parts = parts(&model)?;
    let mut points = vec![Vec::new(); parts.len()];
    let mut ends = vec![Vec::new(); parts.len()];
    for (round, count) in FOLLOWED.into_iter().enumerate().take(rounds) {
        for (part, (points, ends)) in parts.iter().zip(points.iter_mut().zip(&mut ends)) {
            let at = part.of_whole(&at);
            let starts = match round {
                0 => vec![at],
                _ => part.model.related(&at),
            };
            effort.begins(Stage::Screen);
            for x in starts {
                points.extend(screened(&part.model, joints, &x, effort));
            }
            effort.ends();
            effort.begins(Stage::Clearances);
            let found = around(&part.model, &best_of(points, count), effort);
            effort.ends();
            ends.extend(found?);
            ends.sort_by(|a: &Led, b| a.left.total_cmp(&b.left));
        }
        let led = joined(&parts, &ends, &at);
        // What a search of other joints has led to may only make up for the one that is worn: the healthy machine is a start, too.
        let ends = led.iter().map(|led| led.x.clone());
        let starts: Vec<Vec<f64>> = [at.clone()].into_iter().chain(ends).collect();
        effort.begins(Stage::Clearances);
        let before = best.criterion;
        let found = search.better(best, &model, led, effort).and_then(|best| {
            // Joints that are ideal in the file come before all that is less likely, and are not tried twice.
            let steps = Steps {
                joints: round == 0 || best.criterion < before,
                contacts: round > 0,
            };
            search.stepped(best, (&model, &starts), steps, effort)
        });
        effort.ends();
        best = found?;
        if effort.stopped || best.fit.is_at_noise() {
            break;
        }
    }
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
        // Of motions that scatter, sums of squares differ by chance by more than with such models.
        if found.misfit() > FAR || !model.problem.runs.iter().all(Observation::repeats) {
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

    /// The fit after as many steps as the evidence favours. `ends` are points of a model from which they lead, the best one
    /// first.
    fn stepped(
        &self,
        mut best: Found,
        ends: (&Model, &[Vec<f64>]),
        mut steps: Steps,
        effort: &mut Effort,
    ) -> Result<Found, Error> {
        while !effort.stopped && !best.fit.is_at_noise() {
            let Some((model, led)) = self.best_step(&best, ends, steps, effort)? else {
                break;
            };
            let before = best.criterion;
            steps.joints = true;
            best = self.better(best, &model, led, effort)?;
            if best.criterion >= before - STRONG {
                break;
            }
        }
        Ok(best)
    }

    /// The step that short descents favour, and where they have led; none where there is no step.
    fn best_step(
        &self,
        best: &Found,
        (first, ends): (&Model, &[Vec<f64>]),
        steps: Steps,
        effort: &mut Effort,
    ) -> Result<Option<(Model, Vec<Led>)>, Error> {
        let mut led = match steps.joints {
            true => self.cleared(best, (first, ends), effort)?,
            false => Vec::new(),
        };
        if steps.contacts && best.model.contacts != Contacts::Fitted && !best.model.clear.is_empty()
        {
            let clear = best.model.clear.clone();
            let model = Model::new(self.healthy, self.joints, clear, Contacts::Fitted)?;
            let x = model.coordinates_of(&best.model, &best.fit.coordinates());
            let earlier = ends.iter().map(|x| model.coordinates_of(first, x));
            let starts: Vec<Vec<f64>> = [x].into_iter().chain(earlier).collect();
            let found = roughly(&model, &starts, effort);
            led.push((model, found));
        }
        if effort.stopped {
            return Ok(None);
        }
        let criterion = |(model, led): &(Model, Vec<Led>)| {
            let part = few(&model.problem);
            let likelihood = Likelihood::new(&part);
            let x = &led.first()?.x;
            let (_, left) = likelihood.likeliest(x, &TIMINGS).ok()?;
            Some(left + model.problem.parameters.len() as f64 * (likelihood.count() as f64).ln())
        };
        let judged = led
            .into_iter()
            .map(|led| (criterion(&led).unwrap_or(f64::INFINITY), led));
        let next = judged.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(next.map(|(_, led)| led))
    }

    /// Models in which one more joint is clear, with the ends of the best cells of their grids: these are chosen over all
    /// such joints.
    fn cleared(
        &self,
        best: &Found,
        (first, ends): (&Model, &[Vec<f64>]),
        effort: &mut Effort,
    ) -> Result<Vec<(Model, Vec<Led>)>, Error> {
        let mut models = Vec::new();
        let (mut energies, mut lines) = (Vec::new(), Vec::new());
        for joint in (0..self.joints.len()).filter(|i| !best.model.clear.contains(i)) {
            let mut clear = best.model.clear.clone();
            clear.push(joint);
            let place = clear.len() - 1;
            let contacts = best.model.contacts;
            let model = Model::new(self.healthy, self.joints, clear, contacts)?;
            let x = model.coordinates_of(&best.model, &best.fit.coordinates());
            let earlier = ends.iter().map(|x| model.coordinates_of(first, x));
            let starts: Vec<Vec<f64>> = [x].into_iter().chain(earlier).take(STARTS).collect();
            let of_model =
                |points: Vec<Point>| points.into_iter().map(|point| (models.len(), point));
            energies.extend(of_model(with_one_more(
                &model,
                self.joints,
                place,
                &starts,
                effort,
            )));
            lines.extend(of_model(by_lines(
                &model,
                self.joints,
                place,
                &starts,
                effort,
            )));
            models.push(model);
        }
        let (energies, lines) = (best_points(energies), best_points(lines));
        let mut led = Vec::new();
        for (i, model) in models.into_iter().enumerate() {
            if let Some(own) = energies.get(&i) {
                let own: Vec<Vec<f64>> = own.iter().map(|point| point.x.clone()).collect();
                led.push((model.clone(), around(&model, &own, effort)?));
            }
            if let Some(own) = lines.get(&i) {
                let at = |Point { x, left, .. }: &Point| Led {
                    x: x.clone(),
                    left: *left,
                };
                led.push((model, own.iter().map(at).collect()));
            }
        }
        Ok(led)
    }
}

/// The best of these points over all models, by the model.
fn best_points(mut points: Vec<(usize, Point)>) -> BTreeMap<usize, Vec<Point>> {
    points.sort_by(|a, b| a.1.left.total_cmp(&b.1.left));
    let mut best: BTreeMap<usize, Vec<Point>> = BTreeMap::new();
    for (model, point) in points.into_iter().take(CLEAR_POINTS) {
        best.entry(model).or_default().push(point);
    }
    best
}

/// The joints that are clear in the machine file.
fn initially(joints: &[Joint]) -> Vec<usize> {
    let all = 0..joints.len();
    all.filter(|i| joints[*i].stated.is_some()).collect()
}

/// A fit with its criterion.
fn judged(model: Model, fit: Fit) -> Result<Found, Error> {
    let likelihood = Likelihood::new(&model.problem);
    let free = fit
        .estimates
        .iter()
        .filter(|e| e.interval.is_some())
        .count();
    let (deviance, _) = likelihood.mean_deviance(&fit.coordinates())?;
    let criterion = deviance + free as f64 * (likelihood.count() as f64).ln();
    Ok(Found {
        model,
        fit,
        criterion,
    })
}
