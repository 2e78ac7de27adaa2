//! The workflow: effects are added one after another while they earn their place.

use crate::candidate::Candidate;
use crate::criteria::{NOISE, Verdict, verdict};
use crate::effort::Effort;
use crate::error::Error;
use crate::finding::{Explained, Found, Tried, added};
use crate::fitter::{Fitter, Watch};
use crate::mains_hum::Hum;
use crate::measuring_chain::{crank_angle_offset, mains_hum};
use crate::model::Model;
use crate::moves::missing_force::MissingForce;
use crate::next_recording::next_recording;
use crate::search::belief::believed;
use crate::search::gas::{OfGas, at_their_ends, of_gas, tell_gas};
use crate::search::last_rivals::with_last_rivals;
use crate::search::one_by_one::{MOST, pruned, while_they_earn};
use crate::search::throw_by_throw::throw_by_throw;
use crate::search::with_force::with_force;
use crate::steps::{Step, steps};
use calibrate::Problem;
use calibrate::fit::{Estimate, Fit};
use nalgebra::DMatrix;

/// Most evaluations of the calibration to begin with.
const CALIBRATION: u64 = 400;

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
    /// What to measure to distinguish effects from their rivals, in a sentence.
    pub next_recording: Option<String>,
    /// What the parameters of the explained model are known to.
    pub estimates: Vec<Estimate>,
    /// The force that is missing where the catalogue explains too little; empty elsewhere.
    pub missing_force: Vec<MissingForce>,
    /// Correlation between each pair of them.
    pub correlations: DMatrix<f64>,
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
    report: &(dyn Fn(&Stage) + Sync),
    watch: Watch,
) -> Result<Explanation, Error> {
    let say = |words: &str, misfit: f64| {
        report(&Stage {
            words: words.to_owned(),
            misfit,
        });
    };
    let fitter = &Fitter {
        effort,
        watch,
        say: &say,
    };
    let (mut baseline, explained) = match of_gas(fitter, problem)? {
        Some(gas) if gas.is_all(problem) => gas.with_joints(problem, effort)?,
        gas => of_all(fitter, problem, gas)?,
    };
    let explained = pruned(fitter, problem, explained)?;
    let with_force = with_force(fitter, problem, &baseline, explained)?;
    let explained = believed(
        fitter,
        problem,
        &baseline,
        with_force.explained,
        with_force.nearer,
    )?;
    let Explained {
        model,
        found,
        refused,
    } = explained;
    let found = with_last_rivals(fitter, problem, &model, found)?;
    say("finding bounds", model.fitted);
    let Fit {
        mut estimates,
        correlations,
        ..
    } = fitter.bounds(&model)?;
    // A parameter that is not identifiable has the value with which the model was found.
    for (estimate, x) in estimates.iter_mut().zip(&model.x) {
        if estimate.interval.is_none() {
            estimate.value = estimate.parameter.value(*x);
        }
    }
    let set_right = || {
        let mut problem = problem.clone();
        problem.parameters.retain(|p| !p.is_crank_angle_offset());
        fitter.fit(problem, &[])
    };
    let mut chain: Vec<Found> = hum.iter().filter_map(|h| mains_hum(h, &model)).collect();
    let explains = |baseline: &Model, effects| verdict(baseline, &model, effects);
    let calibrated = baseline.gap();
    if let Some((offset, without)) = crank_angle_offset(&estimates, set_right, &model)?
        && (offset.effect.evidence.is_sure() || explains(&without, 1) != Verdict::Unexplained)
    {
        chain.push(offset);
        baseline = without;
    }
    // What is left of the effects where the whole stays unexplained is sure by itself.
    let verdict = match explains(&baseline, found.len() + chain.len()) {
        Verdict::Unexplained if !found.is_empty() => Verdict::PartlyExplained,
        verdict => verdict,
    };
    let nominal = Model::at(problem.clone(), &[], effort)?;
    Ok(Explanation {
        steps: steps(&nominal, &baseline, &chain, calibrated, &found, &model),
        next_recording: next_recording(fitter, &found)?,
        nominal,
        chain,
        estimates,
        correlations,
        baseline,
        explained: model,
        found,
        verdict,
        refused,
        missing_force: with_force.missing,
    })
}

/// The calibrated machine, and the same with the effects of the gas and what else is missing.
fn of_all(
    fitter: &Fitter,
    problem: &Problem,
    gas: Option<OfGas>,
) -> Result<(Model, Explained), Error> {
    let known = gas.as_ref().is_some_and(OfGas::is_decided);
    let found = gas.map_or_else(Vec::new, |gas| gas.explained.found);
    let mut found = at_their_ends(fitter, problem, found)?;
    let with_gas = added(problem, found.iter().map(|found| &found.effect))?;
    (fitter.say)("calibrating", f64::NAN);
    let model = fitter.searched(&with_gas, None, CALIBRATION)?;
    tell_gas(fitter, problem, &mut found, &model)?;
    let baseline = match found.is_empty() {
        true => model.clone(),
        false => {
            (fitter.say)("calibrating without an effect", model.fitted);
            fitter.fit(problem.clone(), &[])?
        }
    };
    let candidates = |problem: &Problem| {
        let mut all = Candidate::all(problem);
        all.retain(|candidate| !known || !candidate.is_shown_by_pressures(problem));
        all
    };
    let (model, of_throws) = throw_by_throw(fitter, model, &candidates)?;
    let most = MOST.saturating_sub(of_throws.len());
    let others = while_they_earn(fitter, model, NOISE, most, candidates)?;
    found.extend(of_throws);
    found.extend(others.found);
    Ok((baseline, Explained { found, ..others }))
}
