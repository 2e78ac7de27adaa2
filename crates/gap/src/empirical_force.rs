//! A force law found in the recordings, where no effect of the catalogue explains them.
//!
//! The terms of the effect `empirical_force` are a library, as in sparse regression of dynamics
//! (Brunton, Proctor and Kutz 2016; Kaheman and others 2019, for the mismatch of a model). The
//! response is far from linear in a force as large as one that is missing. The force is therefore
//! estimated first, by a fit with all terms; there, what the terms do to the predicted lines is their
//! exact derivative by the coefficient, contacts included, and the force is regressed sparsely on
//! them, on resamples. The terms that are stable are fitted in full, and the library is regressed
//! again at that fit, until the same terms come out.

use crate::candidate::{Candidate, throws};
use crate::decision::{NOISE, Verdict, earns, evidence, verdict};
use crate::error::Error;
use crate::explain::{Found, Search, effects};
use crate::linearised::{Linearised, groups};
use crate::missing_force::{MissingForce, missing_force};
use crate::model::{Effort, Model, Watch};
use crate::pressures::{is_of_pressures, shows_pressure};
use crate::refit::few;
use calibrate::Problem;
use input::effects::entry;

/// The effect's name.
pub const NAME: &str = "empirical_force";
/// Most groups of terms: what needs more is no law.
pub(crate) const MOST: usize = 3;
/// Most evaluations of the fit with all terms.
const DENSE: u64 = 400;
/// The same of a search out of the local minimum in which that has ended.
const FURTHER: u64 = 1000;
/// By how much more an effect with a name may leave than a law without one.
const HARDLY_MORE: f64 = 1.1;
/// Rounds in which terms may still be exchanged.
const ROUNDS: usize = 4;

/// A law.
#[derive(Clone, Debug)]
pub struct Law {
    /// The effect at its throw, with the terms that it has free.
    pub candidate: Candidate,
    /// The model with it.
    pub model: Model,
}

impl Law {
    /// It as an effect that was added to `start`, and the model with it.
    fn found(self, start: &Model) -> Result<(Found, Model), Error> {
        let Self { candidate, model } = self;
        let score = 1.0 - (model.fitted / start.fitted).powi(2);
        let found = Found {
            values: candidate.values(&model, effects(&start.problem)),
            candidate,
            evidence: evidence(start, &model, score),
            by_run: model.misfits(),
            model: Some(model.clone()),
            pressure_rms: model.pressure_rms()?,
            gap: Some(model.gap()),
            rivals: Vec::new(),
        };
        Ok((found, model))
    }
}

/// A force that is missing.
#[derive(Clone, Debug)]
pub struct Force {
    /// As a fit with all terms has it, in every run.
    pub missing: Vec<MissingForce>,
    /// That fit, to a few runs.
    all: Model,
    /// Its law.
    pub law: Option<Law>,
}

/// What the terms are in a formula, by their keys.
const SYMBOLS: [(&str, &str); 21] = [
    ("constant", ""),
    ("cos_1", "cos α"),
    ("sin_1", "sin α"),
    ("cos_2", "cos 2α"),
    ("sin_2", "sin 2α"),
    ("cos_3", "cos 3α"),
    ("sin_3", "sin 3α"),
    ("cos_4", "cos 4α"),
    ("sin_4", "sin 4α"),
    ("displacement", "x/r"),
    ("displacement_cubed", "(x/r)³"),
    ("velocity", "v/(1 m/s)"),
    ("velocity_squared", "v|v|/(1 m/s)²"),
    ("velocity_cubed", "(v/(1 m/s))³"),
    ("velocity_sign", "sign v"),
    ("pressure_sign", "p/(1 bar) sign v"),
    ("side_force_sign", "|G tan φ| sign v"),
    ("acceleration", "a/g"),
    ("gas_force", "G"),
    ("big_end_offset", "e_b/c_b"),
    ("small_end_offset", "e_s/c_s"),
];

/// A law in words of the model: its terms by their keys, with their coefficients in N. α is the crank
/// angle since top dead centre; x, v and a are displacement from mid-stroke, velocity and acceleration
/// of the crosshead toward the head; p is the head-end pressure, G the gas force over that of 1 bar on
/// the piston, φ the rod's angle; e/c are the offsets of big and small end over their clearances.
pub fn expression<'a>(terms: impl IntoIterator<Item = (&'a str, f64)>) -> String {
    let mut text = String::new();
    for (key, coefficient) in terms {
        let Some((_, symbol)) = SYMBOLS.iter().find(|(known, _)| *known == key) else {
            continue;
        };
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let size = coefficient.abs();
        // Four digits; more is never known.
        let digits = (3.0 - size.max(1e-9).log10().floor()).clamp(0.0, 12.0) as usize;
        text.push_str(&format!("{sign}{size:.digits$} N"));
        if !symbol.is_empty() {
            text.push_str(&format!(" {symbol}"));
        }
    }
    text
}

/// The effect with all its terms free, at each throw that does not have it.
pub(crate) fn libraries(problem: &Problem) -> Vec<Candidate> {
    let Some(entry) = entry(NAME) else {
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
            ends: &[],
        }
        .restricted(&groups(entry).concat())
    };
    let mut libraries: Vec<Candidate> = places.into_iter().map(of).collect();
    libraries.retain(|library| library.added(problem, &usual).is_ok());
    libraries
}

/// The force that `model` lacks at the throw where it explains most, with a law of no more than a few
/// terms where the recordings show one that is stable; none where no throw can have one. Whether the
/// law explains enough is another question.
///
/// # Errors
/// [`Error::Stopped`]; a machine that cannot be simulated.
pub fn empirical_force(
    model: &Model,
    effort: &Effort,
    watch: Watch,
    say: &(dyn Fn(&str, f64) + Sync),
) -> Result<Option<Force>, Error> {
    let search = Search { effort, watch, say };
    let mut best: Option<(Candidate, Dense)> = None;
    for library in libraries(&model.problem) {
        if best.is_some() && !effort.goes_on_for_force() {
            break;
        }
        let Some(dense) = search.dense(&few(model, effort)?, &library)? else {
            continue;
        };
        let better = |(_, best): &(Candidate, Dense)| dense.model.fitted < best.model.fitted;
        if best.as_ref().is_none_or(better) {
            best = Some((library, dense));
        }
    }
    let Some((library, dense)) = best else {
        return Ok(None);
    };
    let missing = missing_force(&dense.model.problem, &dense.model.x, &model.problem.runs)?;
    let all = dense.model.clone();
    let law = search.law(model, &library, dense)?;
    Ok(Some(Force { missing, all, law }))
}

/// A few runs, fitted with all terms that they show.
struct Dense {
    model: Model,
    /// The values of the effect's parameters, SI.
    values: Vec<f64>,
}

/// Whether a model leaves hardly more than another, of fitted and of held-out runs.
fn does_as_well(model: &Model, other: &Model) -> bool {
    let held_out = model.held_out.zip(other.held_out);
    model.fitted <= HARDLY_MORE * other.fitted
        && held_out.is_none_or(|(model, other)| model <= HARDLY_MORE * other)
}

/// Whether what a force `leaves` in its runs is less than the `misfits` in most of these.
fn is_nearer(leaves: &[(String, f64)], misfits: &[(String, f64)]) -> bool {
    let nearer = leaves.iter().filter(|(run, leaves)| {
        let mut same = misfits.iter().filter(|(id, _)| id == run);
        same.any(|(_, misfit)| leaves < misfit)
    });
    2 * nearer.count() > leaves.len()
}

/// What the search of a force made of an explanation.
pub(crate) struct WithForce {
    /// The model, with a law of the force where there is one.
    pub model: Model,
    /// Its effects.
    pub found: Vec<Found>,
    /// The force that is missing; empty where none was looked for.
    pub missing: Vec<MissingForce>,
    /// Whether a force of no name in the place of the effects comes nearer to most recordings.
    pub nearer: bool,
}

impl Search<'_> {
    /// The law of the force that was estimated with all terms of a library.
    fn law(&self, model: &Model, library: &Candidate, dense: Dense) -> Result<Option<Law>, Error> {
        let groups = groups(library.entry);
        let index = effects(&model.problem);
        let mut x = dense.model.x[..model.x.len()].to_vec();
        let mut values = dense.values;
        let fitted_to = model
            .problem
            .with_runs(|run| !self.effort.held_out.contains(&run.id));
        let mut chosen: Option<(Candidate, Model)> = None;
        for _ in 0..ROUNDS {
            let linear = Linearised::at(&fitted_to, &x, library, &values)?;
            let stable = linear.regression.stable(&groups);
            let each = stable.iter().flat_map(|group| &groups[*group]);
            let candidate = library.restricted(&each.copied().collect::<Vec<_>>());
            if stable.is_empty() {
                return Ok(None);
            }
            if let Some((before, model)) = &chosen
                && *before == candidate
            {
                let (candidate, model) = (candidate, model.clone());
                return Ok(Some(Law { candidate, model }));
            }
            let start = linear.fitted(&candidate);
            let added = candidate.added(&model.problem, &start)?;
            let mut from = x;
            from.resize(added.parameters.len(), 0.0);
            (self.say)("fitting a law of the force", dense.model.fitted);
            let after = Model::fit(added, &from, self.effort, self.watch)?;
            x = after.x[..model.x.len()].to_vec();
            values = candidate.values(&after, index);
            chosen = Some((candidate, after));
        }
        Ok(None)
    }

    /// A few runs fitted with all terms of the library that they show; none where they show none.
    fn dense(&self, few: &Model, library: &Candidate) -> Result<Option<Dense>, Error> {
        let nothing = vec![0.0; library.entry.parameters.len()];
        let nominal = vec![0.0; few.x.len()];
        (self.say)("estimating the force", few.fitted);
        let linear = Linearised::at(&few.problem, &nominal, library, &nothing)?;
        let seen = linear.seen();
        if seen.is_empty() {
            return Ok(None);
        }
        let library = library.restricted(&seen);
        let added = library.added(&few.problem, &linear.values)?;
        let effort = Effort {
            evaluations: DENSE,
            ..self.effort.clone()
        };
        let from = |x: &[f64]| {
            let mut x = x.to_vec();
            x.resize(added.parameters.len(), 0.0);
            Model::fit(added.clone(), &x, &effort, self.watch)
        };
        let mut model = from(&nominal)?;
        // Without the force the calibration may have gone far astray, and often has.
        if model.fitted > NOISE {
            model = model.better(from(&few.x)?);
        }
        if model.fitted > NOISE && self.effort.goes_on_for_force() {
            (self.say)("estimating the force further", model.fitted);
            let start = Some(model.x.clone());
            let further = self.searched(&model.problem, start, FURTHER)?;
            model = model.better(further);
        }
        let values = library.values(&model, effects(&few.problem));
        Ok(Some(Dense { model, values }))
    }

    /// The model with an empirical force in place of the effects that were found beside the gas, or
    /// on top of them, where they leave too much and the force predicts what they do not.
    pub(crate) fn with_force(
        &self,
        problem: &Problem,
        baseline: &Model,
        model: Model,
        found: Vec<Found>,
    ) -> Result<WithForce, Error> {
        let explained = verdict(baseline, &model, found.len());
        // Where a part is left the force must have its chance whatever was spent before, or whatever of
        // the catalogue comes nearest stands for it.
        let settled = matches!(explained, Verdict::NoGap | Verdict::Explained);
        // Pressures do not feel it, and without derivatives there is no regression.
        if settled || is_of_pressures(problem) || self.effort.chaotic {
            return Ok(WithForce {
                model,
                found,
                missing: Vec::new(),
                nearer: false,
            });
        }
        let effort = &self.effort.having(found.len());
        let (start, kept) = self.gas_alone(problem, baseline, &model, &found)?;
        let mut starts = vec![(start, kept)];
        if starts[0].1.len() < found.len() {
            starts.push((model.clone(), found.clone()));
        }
        let (mut model, mut found) = (model, found);
        let (mut missing, mut nearer) = (Vec::new(), false);
        for (i, (start, mut effects)) in starts.into_iter().enumerate() {
            if i > 0 && !effort.goes_on_for_force() {
                break;
            }
            let Some(force) = empirical_force(&start, effort, self.watch, self.say)? else {
                continue;
            };
            // On top of all effects it is always nearer.
            let in_their_place = effects.len() < found.len();
            nearer |= in_their_place && is_nearer(&force.all.misfits(), &model.misfits());
            missing = force.missing;
            let explains = |after: &Model| verdict(baseline, after, effects.len() + 1);
            let with_force = force.law.as_ref().map_or(&force.all, |law| &law.model);
            let named = self.named_instead(&start, with_force, |after| {
                let law = force.law.as_ref();
                explains(after) == Verdict::Explained
                    || law.is_some_and(|law| does_as_well(after, &law.model))
            })?;
            let Some((added, after)) = (match (named, force.law) {
                // What the catalogue has a name for needs no law.
                (Some(named), _) => Some(named),
                (None, Some(law)) => Some(law.found(&start)?),
                (None, None) => None,
            }) else {
                continue;
            };
            let verdict = explains(&after);
            let closes = matches!(verdict, Verdict::Explained | Verdict::PartlyExplained);
            let predicts = after.held_out.is_some() && earns(&start, &after);
            if !(closes && predicts && earns(&model, &after)) {
                continue;
            }
            effects.push(added);
            (model, found, nearer) = (after, effects, false);
            if verdict == Verdict::Explained {
                break;
            }
        }
        Ok(WithForce {
            model,
            found,
            missing,
            nearer,
        })
    }

    /// The model with those of its effects alone that the pressures show whatever acts on the
    /// crosshead.
    fn gas_alone(
        &self,
        problem: &Problem,
        baseline: &Model,
        model: &Model,
        found: &[Found],
    ) -> Result<(Model, Vec<Found>), Error> {
        let mut kept = found.to_vec();
        kept.retain(|f| shows_pressure(problem) && f.candidate.is_of_gas());
        match kept.len() == found.len() {
            true => Ok((model.clone(), kept)),
            false => Ok((self.with_only(problem, baseline, &kept)?, kept)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_told_in_words_of_the_model() {
        let terms = [
            ("constant", 12.5),
            ("velocity_sign", -120.04),
            ("cos_2", 35.0),
        ];
        assert_eq!(
            expression(terms),
            "12.50 N - 120.0 N sign v + 35.00 N cos 2α"
        );
        assert_eq!(
            expression([("velocity_cubed", -0.25)]),
            "-0.2500 N (v/(1 m/s))³"
        );
        assert_eq!(expression([]), "");
    }

    #[test]
    fn a_force_is_nearer_where_it_leaves_less_in_most_of_its_runs() {
        let runs = |misfits: &[(&str, f64)]| -> Vec<(String, f64)> {
            let named = misfits
                .iter()
                .map(|(run, misfit)| ((*run).to_owned(), *misfit));
            named.collect()
        };
        let force = runs(&[("a", 15.8), ("b", 3.0), ("c", 2.6)]);
        let model = runs(&[("a", 6.7), ("x", 1.0), ("b", 5.5), ("c", 5.3)]);
        assert!(is_nearer(&force, &model));
        assert!(!is_nearer(&force, &model[..3]));
        assert!(!is_nearer(&force, &runs(&[("b", 2.9), ("c", 5.3)])));
    }

    #[test]
    fn every_term_of_the_effect_has_a_symbol() {
        let keys = entry(NAME).unwrap().amplitudes().map(|p| p.key);
        assert!(keys.eq(SYMBOLS.iter().map(|(key, _)| *key)));
    }
}
