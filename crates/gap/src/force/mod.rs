//! A force law found in the recordings, where no effect of the catalogue explains them.
//!
//! The terms of the effect `empirical_force` are a library, as in sparse regression of dynamics
//! (Brunton, Proctor and Kutz 2016; Kaheman and others 2019, for the mismatch of a model).
//!
//! 1. The response is far from linear in a force as large as one that is missing. The force is therefore
//!    estimated first, by a fit with all terms.
//! 2. There, the effect of each term on the predicted lines is its exact derivative by the coefficient, contacts
//!    included. The force is regressed sparsely on the terms, on resamples.
//! 3. The terms that are stable are fitted in full, and the library is regressed again at that fit, until the
//!    same terms come out.

pub(crate) mod linearised;
pub(crate) mod missing_force;
pub(crate) mod stability_selection;

use crate::amendment::candidate::Candidate;
use crate::amendment::places::throws;
use crate::criteria::evidence;
use crate::error::Error;
use crate::finding::{Tried, effects};
use crate::fitter::Fitter;
use crate::force::linearised::{Linearised, groups};
use crate::force::missing_force::{MissingForce, missing_force};
use crate::model::Model;
use calibrate::Problem;
use input::effects::{Proposal, proposed};

/// Rounds in which terms may still be exchanged.
const EXCHANGES: usize = 4;

/// A force that is missing.
pub(crate) struct Force {
    /// As a fit with all terms has it, in every run.
    pub missing: Vec<MissingForce>,
    /// Its law: the effect at its throw, with the terms that it has free, and the model with it.
    pub law: Option<(Tried, Model)>,
}

/// The effect with all its terms free, at each throw that does not have it.
fn libraries(problem: &Problem) -> Vec<Candidate> {
    let Some(entry) = proposed(Proposal::ForceLaw) else {
        return Vec::new();
    };
    let names = throws(&problem.tree).into_iter();
    let mut places: Vec<_> = names.map(|name| vec![("throw", name)]).collect();
    if places.is_empty() {
        places.push(Vec::new());
    }
    let usual: Vec<f64> = entry.parameters.iter().map(|p| p.start).collect();
    let of = |place| {
        let fixed = Vec::new();
        Candidate {
            entry,
            place,
            fixed,
            each: Vec::new(),
            shared: false,
            formed: false,
        }
        .restricted(&groups(entry).concat())
    };
    let mut libraries: Vec<Candidate> = places.into_iter().map(of).collect();
    libraries.retain(|library| library.added(problem, &usual).is_ok());
    libraries
}

/// The force that `model` lacks at the throw where it explains most, with a law of no more than a few
/// terms where the recordings show one that is stable. None where no throw can have one. Whether the
/// law explains enough is decided elsewhere.
///
/// # Errors
/// [`Error::Stopped`]; a machine that cannot be simulated.
pub(crate) fn empirical_force(fitter: &Fitter, model: &Model) -> Result<Option<Force>, Error> {
    let mut best: Option<(Candidate, Dense)> = None;
    for library in libraries(&model.problem) {
        if best.is_some() && !fitter.effort.goes_on() {
            break;
        }
        let few = Model::at(
            fitter.few(&model.problem)?.different,
            &model.x,
            model.timing,
            fitter.effort,
        )?;
        let Some(dense) = estimated(fitter, &few, &library)? else {
            continue;
        };
        let better = |(_, best): &(Candidate, Dense)| dense.model.deviance < best.model.deviance;
        if best.as_ref().is_none_or(better) {
            best = Some((library, dense));
        }
    }
    let Some((library, dense)) = best else {
        return Ok(None);
    };
    let missing = missing_force(&dense.model.problem, &dense.model.x, &model.problem.runs)?;
    let law = law(fitter, model, &library, dense)?;
    Ok(Some(Force { missing, law }))
}

/// A few runs, fitted with all terms that they show.
struct Dense {
    model: Model,
    /// The values of the effect's parameters, SI.
    values: Vec<f64>,
}

/// The law of the force that was estimated with all terms of a library.
fn law(
    fitter: &Fitter,
    model: &Model,
    library: &Candidate,
    dense: Dense,
) -> Result<Option<(Tried, Model)>, Error> {
    let groups = groups(library.entry);
    let index = effects(&model.problem);
    let mut x = dense.model.x[..model.x.len()].to_vec();
    let mut values = dense.values;
    let fitted_to = model.problem.with_runs(|run| fitter.effort.fits(&run.id));
    let mut chosen: Option<(Candidate, Model)> = None;
    for _ in 0..EXCHANGES {
        let linear = Linearised::at(&fitted_to, &x, library, &values)?;
        let stable = linear.regression.stable(&groups);
        let each = stable.iter().flat_map(|group| &groups[*group]);
        let candidate = library.restricted(&each.copied().collect::<Vec<_>>());
        if stable.is_empty() {
            return Ok(None);
        }
        if let Some((_, after)) = chosen.take_if(|(before, _)| *before == candidate) {
            return Ok(Some((tried(candidate, model, &after), after)));
        }
        let start = linear.fitted(&candidate);
        let added = candidate.added(&model.problem, &start)?;
        (fitter.say)("fitting a law of the force", dense.model.fitted);
        let mut start = x.clone();
        start.resize(added.parameters.len(), 0.0);
        let Some((after, _)) = fitter.explored(&[(added, start)])? else {
            return Ok(None);
        };
        x = after.x[..model.x.len()].to_vec();
        values = candidate.values(&after, index);
        chosen = Some((candidate, after));
    }
    Ok(None)
}

/// A few runs fitted with all terms of the library that they show; none where they show none.
fn estimated(fitter: &Fitter, few: &Model, library: &Candidate) -> Result<Option<Dense>, Error> {
    let nothing = vec![0.0; library.entry.parameters.len()];
    let nominal = vec![0.0; few.x.len()];
    (fitter.say)("estimating the force", few.fitted);
    let linear = Linearised::at(&few.problem, &nominal, library, &nothing)?;
    let seen = linear.seen();
    if seen.is_empty() {
        return Ok(None);
    }
    let library = library.restricted(&seen);
    let added = library.added(&few.problem, &linear.values)?;
    let from = |x: &[f64]| {
        let mut start = x.to_vec();
        start.resize(added.parameters.len(), 0.0);
        (added.clone(), start)
    };
    // Without the force the calibration may have gone far astray, and often has.
    let Some((model, _)) = fitter.explored(&[from(&nominal), from(&few.x)])? else {
        return Ok(None);
    };
    let values = library.values(&model, effects(&few.problem));
    Ok(Some(Dense { model, values }))
}

/// A law of the force, as an effect that was tried.
fn tried(candidate: Candidate, before: &Model, after: &Model) -> Tried {
    Tried {
        values: candidate.values(after, effects(&before.problem)),
        candidate,
        evidence: evidence(before, after),
        probability: 1.0,
        model: Some(after.clone()),
    }
}
