//! Which joints are clear, and whether the contact parameters are as stated: a selection by evidence.

use super::descent::{finely, fit, roughly};
use super::discrepancy::FAR;
use super::effort::Effort;
use super::joint::Joint;
use super::model::{Contacts, Model};
use super::sets::{Ends, Sets};
use crate::cloud_descent::Led;
use crate::error::Error;
use crate::fit::Fit;
use crate::likelihood::Likelihood;
use crate::observation::Observation;
use crate::optimiser::LeastSquares;
use crate::problem::Problem;
use crate::stages::Stage;

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
    let mut sets = Sets::new(healthy, joints, x);
    let (model, at) = sets.model(&[])?;
    effort.begins(Stage::Clearances);
    let found = search.near_file(&model, &at, effort);
    effort.ends();
    let mut best = found?;
    let mut ended: Vec<Ends> = Vec::new();
    if search.goes_on(&best, effort) {
        best = search.with_set(best, sets.ends(&[], effort)?, &mut ended, effort)?;
    }
    if search.goes_on(&best, effort) {
        for more in sets.likely(effort)? {
            if search.goes_on(&best, effort) {
                best = search.with_set(best, sets.ends(&more, effort)?, &mut ended, effort)?;
            }
        }
    }
    if !search.goes_on(&best, effort) {
        return Ok(best);
    }
    effort.begins(Stage::Clearances);
    let found = search.with_contacts(best, &ended, effort);
    effort.ends();
    found
}

/// A search under way.
struct Search<'a> {
    healthy: &'a Problem,
    joints: &'a [Joint],
}

impl Search<'_> {
    /// Whether more than noise is left, and nobody has stopped it.
    fn goes_on(&self, best: &Found, effort: &Effort) -> bool {
        !effort.stopped && !best.fit.is_at_noise()
    }

    /// The fit that descents from the clearances of the machine file lead to, by its relation between clearances.
    fn near_file(&self, first: &Model, at: &[f64], effort: &mut Effort) -> Result<Found, Error> {
        let clear = first.clear.clone();
        let model = Model::new(self.healthy, self.joints, clear, Contacts::Stated)?;
        let at = model.coordinates_of(first, at);
        let led = roughly(&model, &[at], effort);
        let x = finely(&model, led, effort)?;
        self.settled(&model, x, effort)
    }

    /// The better one of `best` and the fits that descents from the ends of a set lead to, which are added to `ended`.
    fn with_set(
        &self,
        best: Found,
        ends: Ends,
        ended: &mut Vec<Ends>,
        effort: &mut Effort,
    ) -> Result<Found, Error> {
        effort.begins(Stage::Clearances);
        let found = self.better(best, &ends.model, ends.led.clone(), effort);
        effort.ends();
        ended.push(ends);
        found
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
        let found = judged(model.clone(), x, effort)?;
        // Of motions that scatter, sums of squares differ by chance by more than with such models.
        if found.misfit() > FAR || !model.problem.runs.iter().all(Observation::repeats) {
            return Ok(found);
        }
        let from = found.fit.coordinates();
        let at_noise = found.fit.is_at_noise();
        let on = found.model.clone();
        let mut best = found;
        for contacts in [Contacts::Stated, Contacts::Related, Contacts::Fitted] {
            // What is simpler leaves at least as much.
            let hopeless = contacts < model.contacts && !at_noise;
            if effort.stopped || contacts == model.contacts || hopeless {
                continue;
            }
            let clear = model.clear.clone();
            let mut other = Model::new(self.healthy, self.joints, clear, contacts)?;
            other.problem.take_over_branches(&on.problem);
            let x = other.coordinates_of(model, &from);
            match judged(other, x, effort) {
                Ok(other) => {
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

    /// The better one of `best` and the fit with each contact parameter free, from there and from where the search of the same
    /// joints has led. Of motions that scatter, sums of squares differ by chance by more than with such models.
    fn with_contacts(
        &self,
        best: Found,
        ended: &[Ends],
        effort: &mut Effort,
    ) -> Result<Found, Error> {
        let repeats = best.model.problem.runs.iter().all(Observation::repeats);
        if best.model.contacts == Contacts::Fitted || best.model.clear.is_empty() || !repeats {
            return Ok(best);
        }
        let clear = best.model.clear.clone();
        let model = Model::new(self.healthy, self.joints, clear, Contacts::Fitted)?;
        let same = ended.iter().filter(|ends| ends.model.clear == model.clear);
        let earlier = same.flat_map(|ends| {
            let led = ends.led.iter();
            led.map(|led| model.coordinates_of(&ends.model, &led.x))
        });
        let x = model.coordinates_of(&best.model, &best.fit.coordinates());
        let starts: Vec<Vec<f64>> = [x].into_iter().chain(earlier).collect();
        let led = roughly(&model, &starts, effort);
        self.better(best, &model, led, effort)
    }
}

/// The fit of a model from `x`, with its criterion.
fn judged(mut model: Model, x: Vec<f64>, effort: &mut Effort) -> Result<Found, Error> {
    let fit = fit(&mut model, x, effort)?;
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
