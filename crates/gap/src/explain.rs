//! The workflow: effects are added one after another while they earn their place.

use crate::candidate::Candidate;
use crate::error::Error;
use crate::mains_hum::Hum;
use crate::measuring_chain::{crank_angle_offset, mains_hum};
use crate::model::{Effort, Model, Watch};
use crate::pressures::{pressures, shows_pressure};
use crate::screening::{Screened, screen};
use calibrate::Problem;
use calibrate::fit::{Estimate, FitSettings, Optimiser};
use rayon::prelude::*;
use serde::Serialize;

/// A misfit below this is noise.
pub const NOISE: f64 = 1.15;
/// Pressures this near to the noise show no effect.
const GAS_NOISE: f64 = 2.0;
/// Most evaluations of the calibration to begin with.
const CALIBRATION: u64 = 200;
/// A model this near to the noise explains what was missing.
pub const EXPLAINED: f64 = 1.5;
/// Candidates that are fitted, of those that were screened: the linear score may be wrong.
const FITTED: usize = 8;
/// How many are fitted at once, before it is looked whether one has reached the noise.
const TOGETHER: usize = 2;
/// Of these, how many are fitted to all runs.
const FINAL: usize = 3;
/// Runs that the first fits of candidates use.
const FEW: usize = 3;
/// Candidates whose misfit is within this factor of the best one's are its rivals.
const RIVAL: f64 = 3.0;
/// An effect earns its place where it takes this share of the misfit, squared above the noise, of
/// fitted and of held-out runs.
const EARNED: f64 = 0.3;
/// Most effects.
const MOST: usize = 3;
/// Share of the distance to the noise that must be gone for a part to count as an explanation.
const PARTLY: f64 = 0.8;

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
    /// What the parameters of the explained model are known to.
    pub estimates: Vec<Estimate>,
}

/// What an explanation comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The calibrated model is at the noise.
    NoGap,
    /// With the effects it is.
    Explained,
    /// With the effects it is much nearer, and something is left.
    PartlyExplained,
    /// Nothing in the catalogue brings it near.
    Unexplained,
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
    /// The misfit that it leaves in each run.
    pub by_run: Vec<(String, f64)>,
    /// What else might have been.
    pub rivals: Vec<Tried>,
}

/// A candidate that was fitted.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect.
    pub candidate: Candidate,
    /// How well it did.
    pub evidence: Evidence,
    /// The misfit that it leaves in each of the runs that it was fitted to or held against.
    pub by_run: Vec<(String, f64)>,
}

/// What speaks for an effect.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// Share of the residual that the score test lets it explain.
    pub score: f64,
    /// Misfit of the fitted runs without and with it, in standard deviations of the noise.
    pub misfit: [f64; 2],
    /// The same of the held-out runs.
    pub heldout_misfit: Option<[f64; 2]>,
    /// Bayesian information criterion with it less that without it, revolutions' lines counted as
    /// one observation each: below −10 is strong evidence.
    pub delta_bic: f64,
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
    let mut found = search.of_gas(problem)?;
    let mut with_gas = problem.clone();
    for gas in &found {
        with_gas = gas.candidate.added(&with_gas, &gas.values)?;
    }
    let model = search.calibrated(&with_gas)?;
    let baseline = match found.is_empty() {
        true => model.clone(),
        false => {
            say("calibrating without an effect", model.fitted);
            Model::fit(
                problem.clone(),
                &vec![0.0; problem.parameters.len()],
                effort,
                watch,
            )?
        }
    };
    let known = shows_pressure(problem);
    let candidates = |problem: &Problem| {
        let mut all = Candidate::all(problem);
        all.retain(|candidate| !known || !candidate.is_of_gas());
        all
    };
    let (model, others, refused) = search.while_they_earn(model, NOISE, MOST, candidates)?;
    found.extend(others);
    let (model, found) = search.pruned(problem, model, found)?;
    say("finding bounds", model.fitted);
    let estimates = search.bounds(&model)?;
    let nothing = vec![0.0; problem.parameters.len()];
    let set_right = || {
        let mut problem = problem.clone();
        problem.parameters.retain(|p| !p.is_crank_angle_offset());
        let start = vec![0.0; problem.parameters.len()];
        Model::fit(problem, &start, effort, watch)
    };
    let mut chain: Vec<Found> = hum.iter().filter_map(|h| mains_hum(h, &model)).collect();
    let mut baseline = baseline;
    if let Some((offset, without)) = crank_angle_offset(&estimates, set_right, &model)? {
        chain.push(offset);
        baseline = without;
    }
    let verdict = verdict(&baseline, &model, found.len() + chain.len());
    Ok(Explanation {
        nominal: Model::at(problem.clone(), nothing, effort)?,
        chain,
        estimates,
        baseline,
        explained: model,
        found,
        verdict,
        refused,
    })
}

/// How effects are searched.
struct Search<'a> {
    effort: &'a Effort,
    watch: Watch<'a>,
    say: &'a (dyn Fn(&str, f64) + Sync),
}

impl Search<'_> {
    /// The effects that the pressures show, which hardly depend on the joints.
    fn of_gas(&self, problem: &Problem) -> Result<Vec<Found>, Error> {
        let Some(pressures) = pressures(problem)? else {
            return Ok(Vec::new());
        };
        (self.say)("looking at the pressures", f64::NAN);
        let nominal = vec![0.0; pressures.parameters.len()];
        let model = Model::fit(pressures, &nominal, self.effort, self.watch)?;
        let candidates = |problem: &Problem| {
            let mut all = Candidate::all(problem);
            all.retain(Candidate::is_of_gas);
            all
        };
        Ok(self.while_they_earn(model, GAS_NOISE, MOST, candidates)?.1)
    }

    /// The problem's machine, calibrated as well as it can be.
    fn calibrated(&self, problem: &Problem) -> Result<Model, Error> {
        (self.say)("calibrating", f64::NAN);
        let settings = FitSettings {
            optimiser: Optimiser::Default,
            seed: 0,
            evaluations: CALIBRATION,
            held_out: self.effort.held_out.clone(),
            start: None,
        };
        let fit = calibrate::calibrate(problem, &settings, |_| (self.watch)())?;
        if !fit.complete && (self.watch)().is_break() {
            return Err(Error::Stopped);
        }
        let x = fit
            .estimates
            .iter()
            .map(|e| e.parameter.coordinate(e.value));
        Model::at(problem.clone(), x.collect(), self.effort)
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
            let others = found.iter().enumerate().filter(|(j, _)| *j != i);
            let mut without = problem.clone();
            for (j, other) in others {
                let values = other.candidate.values(&model, effects(problem) + j);
                without = other.candidate.added(&without, &values)?;
            }
            // The others stand at what they were found to be, which is their coordinates' 0.
            let mut x = model.x[..problem.parameters.len()].to_vec();
            x.resize(without.parameters.len(), 0.0);
            let without = Model::fit(without, &x, self.effort, self.watch)?;
            if earns(&without, &model) {
                i += 1;
            } else {
                found.remove(i);
                model = without;
            }
        }
        Ok((model, found))
    }

    /// The parameters of a model with their bounds.
    fn bounds(&self, model: &Model) -> Result<Vec<Estimate>, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::LevenbergMarquardt,
            seed: 0,
            evaluations: self.effort.evaluations,
            held_out: self.effort.held_out.clone(),
            start: Some(model.x.clone()),
        };
        let fit = calibrate::calibrate(&model.problem, &settings, |_| (self.watch)())?;
        Ok(fit.estimates)
    }

    /// The model with one candidate after another until it is at `noise` or none earns its place;
    /// and what was refused at last.
    fn while_they_earn(
        &self,
        mut model: Model,
        noise: f64,
        most: usize,
        candidates: impl Fn(&Problem) -> Vec<Candidate>,
    ) -> Result<(Model, Vec<Found>, Vec<Tried>), Error> {
        let mut found = Vec::new();
        while model.fitted > noise && found.len() < most {
            (self.say)("screening", model.fitted);
            let few = few(&model, self.effort);
            let screened = screen(&few, candidates(&model.problem), self.watch)?;
            let mut tried = self.refit(&model, screened)?;
            if tried.is_empty() {
                break;
            }
            let (best, after) = tried.remove(0);
            let others = tried.into_iter().map(|(tried, _)| tried);
            if !earns(&model, &after) {
                let refused = std::iter::once(best).chain(others).collect();
                return Ok((model, found, refused));
            }
            let near = |tried: &Tried| tried.evidence.misfit[1] < RIVAL * after.fitted;
            found.push(Found {
                rivals: others.filter(near).collect(),
                values: best.candidate.values(&after, effects(&model.problem)),
                by_run: best.by_run,
                candidate: best.candidate,
                evidence: best.evidence,
            });
            model = after;
        }
        Ok((model, found, Vec::new()))
    }

    /// The most promising candidates, fitted together with everything else, the best first.
    fn refit(&self, model: &Model, screened: Vec<Screened>) -> Result<Vec<(Tried, Model)>, Error> {
        let few = few(model, self.effort);
        let mut rough: Vec<(Screened, Model)> = Vec::new();
        let mut chosen = screened.into_iter().take(FITTED).peekable();
        while chosen.peek().is_some() {
            let together: Vec<Screened> = chosen.by_ref().take(TOGETHER).collect();
            let mut fits = rough.iter().map(|(_, fitted)| fitted);
            let near = fits.find(|fitted| fitted.fitted < NOISE).cloned();
            let fitted = together.into_par_iter().map(|screened| {
                let fitted = self.candidate(&few, &screened, near.as_ref())?;
                Ok((screened, fitted))
            });
            rough.extend(fitted.collect::<Result<Vec<_>, Error>>()?);
        }
        rough.sort_by(|a, b| a.1.fitted.total_cmp(&b.1.fitted));
        let least = rough.first().map_or(f64::NAN, |(_, fitted)| fitted.fitted);
        let before = Model::at(few.problem.clone(), few.x.clone(), self.effort)?;
        let mut tried = Vec::new();
        for (i, (screened, fitted)) in rough.into_iter().enumerate() {
            let Screened {
                candidate,
                score,
                values,
            } = screened;
            let close = fitted.fitted < RIVAL * least.max(1.0);
            let (before, after) = if i == 0 || (i < FINAL && close) {
                (self.say)(&candidate.label(), fitted.fitted);
                let added = candidate.added(&model.problem, &values)?;
                let after = Model::fit(added, &fitted.x, self.effort, self.watch)?;
                (model, after)
            } else {
                (&before, fitted)
            };
            let evidence = evidence(before, &after, score);
            tried.push((
                Tried {
                    candidate,
                    evidence,
                    by_run: after.misfits(),
                },
                after,
            ));
        }
        let order = |tried: &(Tried, Model)| tried.0.evidence.misfit[1];
        let whole =
            |tried: &&(Tried, Model)| tried.1.problem.runs.len() == model.problem.runs.len();
        let last = tried.iter().take_while(whole).count();
        tried[..last].sort_by(|a, b| order(a).total_cmp(&order(b)));
        Ok(tried)
    }

    /// A candidate fitted to `few` runs together with everything else. Where another one has reached
    /// the noise, what the calibrated parameters are is known from it.
    fn candidate(
        &self,
        few: &Model,
        screened: &Screened,
        near: Option<&Model>,
    ) -> Result<Model, Error> {
        let label = screened.candidate.label();
        (self.say)(&label, few.fitted);
        let added = screened.candidate.added(&few.problem, &screened.values)?;
        let from = |x: &[f64]| {
            let mut x = x[..few.x.len()].to_vec();
            x.resize(added.parameters.len(), 0.0);
            Model::fit(added.clone(), &x, self.effort, self.watch)
        };
        let fitted = match near {
            Some(near) => from(&near.x)?,
            // Without the effect the calibration may have gone far astray.
            None => from(&few.x)?.better(from(&vec![0.0; few.x.len()])?),
        };
        (self.say)(&format!("{label} fitted"), fitted.fitted);
        Ok(fitted)
    }
}

/// How many effects a problem's machine has.
fn effects(problem: &Problem) -> usize {
    problem.tree["effects"].as_array().map_or(0, Vec::len)
}

/// The model with a few of the runs that it is fitted to, of speeds as different as there are.
fn few(model: &Model, effort: &Effort) -> Model {
    let fitted = |id: &str| !effort.held_out.iter().any(|held| held == id);
    let mut runs: Vec<_> = model
        .problem
        .runs
        .iter()
        .filter(|run| fitted(&run.id))
        .collect();
    runs.sort_by(|a, b| a.crank.speed.total_cmp(&b.crank.speed));
    let last = runs.len().saturating_sub(1);
    let parts = FEW.saturating_sub(1).max(1);
    let chosen: Vec<&str> = (0..FEW)
        .filter_map(|i| runs.get(i * last / parts))
        .map(|r| r.id.as_str())
        .collect();
    Model {
        problem: model
            .problem
            .with_runs(|run| chosen.contains(&run.id.as_str())),
        ..model.clone()
    }
}

fn evidence(before: &Model, after: &Model, score: f64) -> Evidence {
    let held_out = before.held_out.zip(after.held_out);
    Evidence {
        score,
        misfit: [before.fitted, after.fitted],
        heldout_misfit: held_out.map(|(before, after)| [before, after]),
        delta_bic: before.bic_to(after),
    }
}

/// Whether the effect that `after` has and `before` has not earns its place.
fn earns(before: &Model, after: &Model) -> bool {
    let excess = |misfit: f64| (misfit * misfit - 1.0).max(0.0);
    let takes = |before: f64, after: f64| excess(after) <= (1.0 - EARNED) * excess(before);
    let held_out = before.held_out.zip(after.held_out);
    takes(before.fitted, after.fitted)
        && held_out.is_none_or(|(before, after)| after < NOISE || takes(before, after))
}

fn verdict(baseline: &Model, model: &Model, effects: usize) -> Verdict {
    if effects == 0 && baseline.fitted <= NOISE {
        return Verdict::NoGap;
    }
    let worst = model
        .held_out
        .map_or(model.fitted, |held| held.max(model.fitted));
    if effects == 0 {
        Verdict::Unexplained
    } else if worst <= EXPLAINED {
        Verdict::Explained
    } else if worst - 1.0 <= (1.0 - PARTLY) * (baseline.fitted - 1.0) {
        Verdict::PartlyExplained
    } else {
        Verdict::Unexplained
    }
}
