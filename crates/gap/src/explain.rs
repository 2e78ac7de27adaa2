//! The workflow: effects are added one after another while they earn their place.

use crate::candidate::Candidate;
use crate::confusability::Likeness;
use crate::decision::{Evidence, GAS_NOISE, NOISE, Verdict, earns, verdict};
use crate::error::{Error, possible};
use crate::journal::Finished;
use crate::mains_hum::Hum;
use crate::measuring_chain::{crank_angle_offset, mains_hum};
use crate::missing_force::MissingForce;
use crate::model::{Effort, FIRST_SEARCH, Model, SEARCH, Watch};
use crate::pressures::{OfGas, pressures};
use crate::refit::few;
use crate::replication::shows_in_each;
use crate::screening::screen;
use crate::steps::{Gap, Step, steps};
use calibrate::Problem;
use calibrate::fit::{Estimate, Fit, FitSettings, Optimiser};
use nalgebra::DMatrix;
use std::ops::ControlFlow;

/// Most evaluations of the calibration to begin with.
const CALIBRATION: u64 = 400;
/// Most effects.
pub(crate) const MOST: usize = 3;

/// What the workflow did and found.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The calibrated model without any added effect.
    pub baseline: Model,
    /// The model with the effects that were found.
    pub explained: Model,
    /// The effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// What is wrong with the measuring: it was taken off or fitted to begin with.
    pub chain: Vec<Found>,
    /// What this comes to.
    pub verdict: Verdict,
    /// What was tried last and did not earn its place.
    pub refused: Vec<Tried>,
    /// The machine as it was given.
    pub nominal: Model,
    /// The gap as it shrank, the machine as it was given first.
    pub steps: Vec<Step>,
    /// What to measure to tell effects from their rivals, in a sentence.
    pub next_recording: Option<String>,
    /// What the parameters of the explained model are known to.
    pub estimates: Vec<Estimate>,
    /// The force that is missing where the catalogue explains too little; empty elsewhere.
    pub missing_force: Vec<MissingForce>,
    /// Correlation between each pair of them.
    pub correlations: DMatrix<f64>,
}

/// An effect that was added.
#[derive(Clone, Debug)]
pub struct Found {
    /// The effect.
    pub candidate: Candidate,
    /// Its parameters where it was added, SI.
    pub values: Vec<f64>,
    /// On what it was decided.
    pub evidence: Evidence,
    /// The model with which it was decided; none where its parameters are no model's.
    pub model: Option<Model>,
    /// The misfit that it leaves in each run.
    pub by_run: Vec<(String, f64)>,
    /// Root mean square of simulated less recorded pressure that it leaves in each run, Pa.
    pub pressure_rms: Vec<(String, f64)>,
    /// What the whole was left with once it had been added; none where that was not looked at by
    /// itself.
    pub gap: Option<Gap>,
    /// What else might have been.
    pub rivals: Vec<Tried>,
}

/// A candidate that was looked at.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect.
    pub candidate: Candidate,
    /// Its parameters, SI.
    pub values: Vec<f64>,
    /// How well it did.
    pub evidence: Evidence,
    /// The misfit that it leaves in each of the runs that it was fitted to or held against.
    pub by_run: Vec<(String, f64)>,
    /// How like that of the effect that was added its signature is, where it was compared.
    pub likeness: Option<Likeness>,
    /// The model with it; none where it was not fitted.
    pub model: Option<Model>,
}

/// What is being done, for a progress bar.
#[derive(Clone, Debug)]
pub struct Stage {
    /// In words.
    pub words: String,
    /// The misfit so far.
    pub misfit: f64,
}

/// Explains the gap between the problem's machine and its recordings, which `hum` has been taken off.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub fn explain(
    problem: &Problem,
    hum: &[Hum],
    effort: &Effort,
    tell: &(dyn Fn(&Stage) + Sync),
    watch: Watch,
) -> Result<Explanation, Error> {
    let say = |words: &str, misfit: f64| {
        tell(&Stage {
            words: words.to_owned(),
            misfit,
        });
    };
    let search = Search {
        effort,
        watch,
        say: &say,
    };
    let gas = search.of_gas(problem)?;
    let (baseline, model, found, refused) = match gas {
        Some(gas) if gas.is_all(problem) => (
            OfGas::with_joints(gas.before, problem, effort)?,
            OfGas::with_joints(gas.after, problem, effort)?,
            gas.found,
            gas.refused,
        ),
        gas => search.of_all(problem, gas)?,
    };
    let (model, found) = search.pruned(problem, model, found)?;
    let with_force = search.with_force(problem, &baseline, model, found)?;
    let missing_force = with_force.missing.clone();
    let (model, found, refused) = search.believed(problem, &baseline, with_force, refused)?;
    let found = search.with_last_rivals(problem, &model, found)?;
    say("finding bounds", model.fitted);
    let Fit {
        mut estimates,
        correlations,
        ..
    } = search.bounds(&model)?;
    // What is not told has the value with which the model was found.
    for (estimate, x) in estimates.iter_mut().zip(&model.x) {
        if estimate.interval.is_none() {
            estimate.value = estimate.parameter.value(*x);
        }
    }
    let nothing = vec![0.0; problem.parameters.len()];
    let set_right = || {
        let mut problem = problem.clone();
        problem.parameters.retain(|p| !p.is_crank_angle_offset());
        let start = vec![0.0; problem.parameters.len()];
        Model::fit(problem, &start, effort, watch)
    };
    let mut chain: Vec<Found> = hum.iter().filter_map(|h| mains_hum(h, &model)).collect();
    let mut baseline = baseline;
    let explains = |baseline: &Model, effects| verdict(baseline, &model, effects);
    let calibrated = baseline.gap();
    if let Some((offset, without)) = crank_angle_offset(&estimates, set_right, &model)?
        && (offset.evidence.is_sure() || explains(&without, 1) != Verdict::Unexplained)
    {
        chain.push(offset);
        baseline = without;
    }
    // What is left of the effects where the whole stays unexplained is sure by itself.
    let verdict = match explains(&baseline, found.len() + chain.len()) {
        Verdict::Unexplained if !found.is_empty() => Verdict::PartlyExplained,
        verdict => verdict,
    };
    let nominal = Model::at(problem.clone(), nothing, effort)?;
    Ok(Explanation {
        steps: steps(&nominal, &baseline, &chain, calibrated, &found, &model),
        next_recording: search.next_recording(&found)?,
        nominal,
        chain,
        estimates,
        correlations,
        baseline,
        explained: model,
        found,
        verdict,
        refused,
        missing_force,
    })
}

/// How effects are searched.
pub(crate) struct Search<'a> {
    pub(crate) effort: &'a Effort,
    pub(crate) watch: Watch<'a>,
    pub(crate) say: &'a (dyn Fn(&str, f64) + Sync),
}

impl Search<'_> {
    /// The effects that the pressures show, which hardly depend on the joints.
    fn of_gas(&self, problem: &Problem) -> Result<Option<OfGas>, Error> {
        let Some(pressures) = pressures(problem)? else {
            return Ok(None);
        };
        (self.say)("looking at the pressures", f64::NAN);
        let nominal = vec![0.0; pressures.parameters.len()];
        let before = Model::fit(pressures, &nominal, self.effort, self.watch)?;
        let candidates = |problem: &Problem| {
            let mut all = Candidate::all(problem);
            all.retain(Candidate::is_of_gas);
            all
        };
        let (after, found, refused) =
            self.while_they_earn(before.clone(), GAS_NOISE, MOST, candidates)?;
        Ok(Some(OfGas {
            before,
            after,
            found,
            refused,
        }))
    }

    /// The calibrated machine, the same with the effects of the gas and what else is missing, all
    /// of these effects, and what was refused.
    fn of_all(
        &self,
        problem: &Problem,
        gas: Option<OfGas>,
    ) -> Result<(Model, Model, Vec<Found>, Vec<Tried>), Error> {
        let known = gas.as_ref().is_some_and(OfGas::is_told);
        let found = gas.map_or_else(Vec::new, |gas| gas.found);
        let mut found = self.at_their_ends(problem, found)?;
        let mut with_gas = problem.clone();
        for gas in &found {
            with_gas = gas.candidate.added(&with_gas, &gas.values)?;
        }
        (self.say)("calibrating", f64::NAN);
        let model = self.searched(&with_gas, None, CALIBRATION)?;
        self.tell_gas(problem, &mut found, &model)?;
        let baseline = match found.is_empty() {
            true => model.clone(),
            false => {
                (self.say)("calibrating without an effect", model.fitted);
                let nominal = vec![0.0; problem.parameters.len()];
                Model::fit(problem.clone(), &nominal, self.effort, self.watch)?
            }
        };
        let candidates = |problem: &Problem| {
            let mut all = Candidate::all(problem);
            all.retain(|candidate| !known || !candidate.is_told_by_pressures(problem));
            all
        };
        let (model, of_throws) = self.throw_by_throw(model, &candidates)?;
        let most = MOST.saturating_sub(of_throws.len());
        let (model, others, refused) = self.while_they_earn(model, NOISE, most, candidates)?;
        found.extend(of_throws);
        found.extend(others);
        Ok((baseline, model, found, refused))
    }

    /// The effects of the gas, each at the one end of its cylinder alone whose pressure was recorded where
    /// the whole is nearer to the recordings with that.
    fn at_their_ends(&self, problem: &Problem, mut found: Vec<Found>) -> Result<Vec<Found>, Error> {
        let fitted = |found: &[Found]| -> Result<f64, Error> {
            let mut with = problem.clone();
            for gas in found {
                with = gas.candidate.added(&with, &gas.values)?;
            }
            let start = vec![0.0; with.parameters.len()];
            let model = possible(self.rough(with, &start))?;
            Ok(model.map_or(f64::INFINITY, |model| model.fitted))
        };
        let mut least = None;
        for i in 0..found.len() {
            let Some(alone) = found[i].candidate.at_recorded_end(problem) else {
                continue;
            };
            (self.say)("looking at one end of the cylinder", f64::NAN);
            let before = match least {
                Some(least) => least,
                None => fitted(&found)?,
            };
            let both = std::mem::replace(&mut found[i].candidate, alone);
            let after = fitted(&found)?;
            if after >= before {
                found[i].candidate = both;
            }
            least = Some(before.min(after));
        }
        Ok(found)
    }

    /// What the whole is left with after each effect of the gas, the last of which leaves `model`.
    fn tell_gas(&self, problem: &Problem, found: &mut [Found], model: &Model) -> Result<(), Error> {
        let last = found.len().saturating_sub(1);
        for i in 0..found.len() {
            found[i].gap = if i == last {
                Some(model.gap())
            } else if self.effort.goes_on() {
                (self.say)("calibrating with a part of the effects", model.fitted);
                Some(self.with_only(problem, model, &found[..=i])?.gap())
            } else {
                None
            };
        }
        Ok(())
    }

    /// The problem's machine, calibrated as well as it can be with so many evaluations.
    pub(crate) fn searched(
        &self,
        problem: &Problem,
        start: Option<Vec<f64>>,
        evaluations: u64,
    ) -> Result<Model, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::Default,
            seed: 0,
            evaluations,
            held_out: self.effort.held_out.clone(),
            start,
        };
        let metered = problem.metered();
        let most = match settings.start {
            None => FIRST_SEARCH,
            Some(_) => SEARCH,
        };
        let watch = |_: &_| match metered.meter.steps() < most {
            true => (self.watch)(),
            false => ControlFlow::Break(()),
        };
        let search = || {
            let fit = calibrate::calibrate(&metered, &settings, watch)?;
            if !fit.complete && (self.watch)().is_break() {
                return Err(Error::Stopped);
            }
            let coordinate = |e: &Estimate| e.parameter.coordinate(e.value);
            Ok(Finished {
                numbers: fit.estimates.iter().map(coordinate).collect(),
                cost: metered.meter.steps(),
            })
        };
        let x = self.effort.journal.once(&(problem, &settings), search)?;
        Model::at(problem.clone(), x, self.effort)
    }

    /// The model without those of its effects that no longer earn their place beside the others.
    fn pruned(
        &self,
        problem: &Problem,
        mut model: Model,
        mut found: Vec<Found>,
    ) -> Result<(Model, Vec<Found>), Error> {
        let mut i = 0;
        while found.len() > 1 && i < found.len() {
            let label = found[i].candidate.label();
            (self.say)(&format!("without {label}"), model.fitted);
            let (without, x) = without(problem, &model, &found, i)?;
            let without = possible(Model::fit(without, &x, self.effort, self.watch))?;
            match without.filter(|without| !earns(without, &model)) {
                None => i += 1,
                Some(without) => {
                    found.remove(i);
                    // What later ones were left with was with this one.
                    found[i..].iter_mut().for_each(|later| later.gap = None);
                    model = without;
                }
            }
        }
        Ok((model, found))
    }

    /// The model with these effects and no others.
    pub(crate) fn with_only(
        &self,
        problem: &Problem,
        baseline: &Model,
        effects: &[Found],
    ) -> Result<Model, Error> {
        if effects.is_empty() {
            return Ok(baseline.clone());
        }
        let mut with = problem.clone();
        for found in effects {
            with = found.candidate.added(&with, &found.values)?;
        }
        let mut x = baseline.x[..problem.parameters.len()].to_vec();
        x.resize(with.parameters.len(), 0.0);
        Model::fit(with, &x, self.effort, self.watch)
    }

    /// The parameters of a model with their bounds.
    pub(crate) fn bounds(&self, model: &Model) -> Result<Fit, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::LevenbergMarquardt,
            seed: 0,
            evaluations: self.effort.evaluations,
            held_out: self.effort.held_out.clone(),
            start: Some(model.x.clone()),
        };
        let fit = calibrate::calibrate(&model.problem, &settings, |_| (self.watch)())?;
        Ok(fit)
    }

    /// The model with one candidate after another until it is at `noise` or none earns its place;
    /// and what was refused at last.
    pub(crate) fn while_they_earn(
        &self,
        mut model: Model,
        noise: f64,
        most: usize,
        candidates: impl Fn(&Problem) -> Vec<Candidate>,
    ) -> Result<(Model, Vec<Found>, Vec<Tried>), Error> {
        let mut found = Vec::new();
        while model.fitted > noise && found.len() < most {
            let effort = &self.effort.having(found.len());
            if !effort.goes_on() {
                break;
            }
            let search = Search { effort, ..*self };
            (self.say)("screening", model.fitted);
            let few = few(&model, effort)?;
            let candidates = candidates(&model.problem);
            let screened = screen(&few, candidates, effort, self.watch)?;
            let rough = search.roughly(&few, screened.clone())?;
            let goes_on = effort.goes_on();
            if found.len() + 1 < most
                && let Some((pair, both)) = search.beside_wear(&model, &few, &rough, &screened)?
            {
                found.extend(pair);
                model = both;
                continue;
            }
            let rough = match goes_on {
                true => search.further(&few, rough)?,
                false => rough,
            };
            let mut tried = search.refit(&model, &few, rough)?;
            if tried.is_empty() {
                break;
            }
            // Those fitted to all runs come first.
            let shows = |(tried, after): &(Tried, Model)| {
                let whole = after.problem.runs.len() == model.problem.runs.len();
                whole && shows_in_each(&tried.candidate, &model, after)
            };
            let (mut best, mut after) = tried.remove(tried.iter().position(shows).unwrap_or(0));
            let others = tried.into_iter().map(|(tried, _)| tried);
            if !(earns(&model, &after) && shows_in_each(&best.candidate, &model, &after)) {
                let refused = std::iter::once(best).chain(others).collect();
                return Ok((model, found, refused));
            }
            let mut others: Vec<Tried> = others.collect();
            let rivals = |best: &Tried, after: &Model, others: &[Tried]| {
                let (candidate, others) = (&best.candidate, others.to_vec());
                search.rivals(&few, after, candidate, &best.evidence, &screened, others)
            };
            let mut like = rivals(&best, &after, &others)?;
            let models = [&model, &few, &after];
            if let Some((better, nearer)) = search.look_alike(models, &others, &like)? {
                others.push(std::mem::replace(&mut best, better));
                after = nearer;
                like = rivals(&best, &after, &others)?;
            }
            found.push(Found {
                rivals: like,
                values: best.values,
                model: Some(after.clone()),
                by_run: best.by_run,
                pressure_rms: after.pressure_rms()?,
                gap: Some(after.gap()),
                candidate: best.candidate,
                evidence: best.evidence,
            });
            model = after;
        }
        Ok((model, found, Vec::new()))
    }
}

/// Index of the first item of the effect `found[which]` in a machine of `problem` that has them all.
pub fn first_item(problem: &Problem, found: &[Found], which: usize) -> usize {
    let before = found[..which].iter();
    effects(problem) + before.map(|f| f.candidate.items().len()).sum::<usize>()
}

/// The machine of `problem` with the effects of `model` but `found[which]`, and its coordinates there: the
/// others stand at what they were found to be, which is their coordinates' 0.
pub(crate) fn without(
    problem: &Problem,
    model: &Model,
    found: &[Found],
    which: usize,
) -> Result<(Problem, Vec<f64>), Error> {
    let mut without = problem.clone();
    for (i, other) in found.iter().enumerate().filter(|(i, _)| *i != which) {
        let values = other.candidate.values(model, first_item(problem, found, i));
        without = other.candidate.added(&without, &values)?;
    }
    let mut x = model.x[..problem.parameters.len()].to_vec();
    x.resize(without.parameters.len(), 0.0);
    Ok((without, x))
}

/// How many effects a problem's machine has.
pub(crate) fn effects(problem: &Problem) -> usize {
    problem.tree["effects"].as_array().map_or(0, Vec::len)
}
