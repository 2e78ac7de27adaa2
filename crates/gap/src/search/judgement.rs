//! What a search comes to: which of its sets is believed, how probable each of its amendments is, and what else
//! might have been.

use crate::amendment::Amendment;
use crate::criteria::{Evidence, NAMED, evidence, left, probability};
use crate::error::{Error, possible};
use crate::finding::{Found, Tried};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::recorded::is_of_pressures;
use crate::search::hypothesis::{Amended, Hypothesis, View, added, of_kinds};
use crate::search::{MOST, Search, Sets, leaves_little};
use calibrate::Problem;
use calibrate::energies::TIMING;
use calibrate::likelihood::Likelihood;
use rayon::prelude::*;

/// Sets of one amendment, and of more, that are fitted to all runs.
const SINGLES: usize = 4;
const LARGER: usize = 2;
/// Rivals less probable than this are left out.
const NEGLIGIBLE: f64 = 0.01;
/// Most evaluations of the calibration where a first descent leaves more than noise.
const CALIBRATION: u64 = 400;

/// What was found in a problem.
pub(crate) struct Judgement {
    /// The machine without amendments, fitted to all runs.
    pub nothing: Hypothesis,
    /// The one that is believed.
    pub believed: Hypothesis,
    /// Probability of each of its amendments.
    pub probabilities: Vec<f64>,
    /// Sets fitted to all runs, the least costly first.
    pub others: Vec<Hypothesis>,
}

/// What comes of the forms of the laws that are believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Forms {
    /// They stay free: something in the machine was left out, and what that does may look like another form.
    Free,
    /// They are the usual ones where the recordings do not need others.
    UsualWhereTheySuffice,
}

/// What is missing in the machine of `problem` of these amendments.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub(crate) fn judged(
    fitter: &Fitter,
    problem: &Problem,
    start: &[f64],
    amendments: &[Amendment],
    forms: Forms,
) -> Result<Judgement, Error> {
    let nothing = calibrated(fitter, problem, start)?;
    if Fitter::is_at_noise(&nothing.model) {
        return Ok(Judgement {
            believed: nothing.clone(),
            nothing,
            probabilities: Vec::new(),
            others: Vec::new(),
        });
    }
    let few = fitter.few(problem)?;
    let own = problem.parameters.len();
    let first = match fitter.settled(&(few.different.clone(), nothing.model.x.clone()))? {
        Some(model) => Hypothesis::new(Vec::new(), model, own),
        None => nothing.clone(),
    };
    let search = Search {
        fitter,
        few: &few,
        amendments,
    };
    let Sets { fitted, far } = search.sets(first)?;
    let chosen = (1..=MOST).flat_map(|count| {
        let of_size = fitted.iter().filter(move |set| set.set.len() == count);
        of_kinds(of_size)
            .into_iter()
            .take(if count == 1 { SINGLES } else { LARGER })
    });
    let chosen: Vec<&Hypothesis> = chosen.collect();
    (fitter.say)("fitting to all runs", nothing.model.fitted);
    let settled = chosen
        .into_par_iter()
        .map(|set| set.settled(fitter, problem));
    let settled = settled.collect::<Result<Vec<_>, Error>>()?;
    let mut compared = Compared::new(nothing, settled.into_iter().flatten().collect());
    let mut believed = compared.believed()?;
    if !leaves_little(&compared.nothing, &believed.set)
        && let Some(by_energies) = by_energies(fitter, problem, far, &compared.nothing)?
        && let found = by_energies.believed()?
        && !found.set.set.is_empty()
    {
        (compared, believed) = (by_energies, found);
    }
    let Believed { set, without } = believed;
    let set = match forms {
        Forms::Free => set,
        Forms::UsualWhereTheySuffice => {
            let count = set.set.len();
            set.of_usual_form(count, fitter, problem)?
        }
    };
    let believed = set.finished(fitter, problem)?;
    let (before, added) = (without.set.len(), believed.set.len() - without.set.len());
    let sure = probability(left(&without.gap, &believed.gap), before, added);
    let Compared { nothing, others } = compared;
    let probabilities = (0..believed.set.len()).map(|i| {
        let rivals = rivals(&believed, i, &others).map(|rival| (believed.cost - rival.cost).exp());
        sure / (1.0 + rivals.sum::<f64>())
    });
    Ok(Judgement {
        probabilities: probabilities.collect(),
        nothing,
        believed,
        others,
    })
}

/// Sets that are judged by the same view of the recordings.
struct Compared {
    /// The machine without amendments.
    nothing: Hypothesis,
    /// Sets with some, the least costly first.
    others: Vec<Hypothesis>,
}

/// A set that is believed, and the one that was believed before its last amendments.
struct Believed {
    set: Hypothesis,
    without: Hypothesis,
}

impl Compared {
    fn new(nothing: Hypothesis, mut others: Vec<Hypothesis>) -> Self {
        others.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        Self { nothing, others }
    }

    /// The largest set that is more probable than not.
    fn believed(&self) -> Result<Believed, Error> {
        let (mut set, mut without) = (&self.nothing, &self.nothing);
        for count in 1..=MOST {
            let Some(best) = self.others.iter().find(|other| other.set.len() == count) else {
                continue;
            };
            let others = set.set.len();
            let probable = probability(left(&set.gap, &best.gap), others, count - others);
            if probable > NAMED && best.cost < set.cost && shows_in_each(set, best)? {
                (set, without) = (best, set);
            }
        }
        Ok(Believed {
            set: set.clone(),
            without: without.clone(),
        })
    }
}

/// The machines of the lowest energies, judged by these: where no fit follows the ringing of any set, what lines leave says little
/// of them. None where sets were not searched far away.
fn by_energies(
    fitter: &Fitter,
    problem: &Problem,
    far: Vec<Hypothesis>,
    nothing: &Hypothesis,
) -> Result<Option<Compared>, Error> {
    let (effort, own) = (fitter.effort, problem.parameters.len());
    let judged = far.into_iter().map(|far| {
        let with = added(problem, &far.set)?;
        let model = possible(Model::at(with, &far.model.x, TIMING, effort))?;
        let judged = model.map(|model| Hypothesis::new(far.set, model, own));
        Ok(judged.map(|one| one.by_energies(own, effort)))
    });
    let judged = judged.collect::<Result<Vec<_>, Error>>()?;
    let (without, others): (Vec<_>, Vec<_>) = judged
        .into_iter()
        .flatten()
        .partition(|one| one.set.is_empty());
    let as_fitted = nothing.clone().by_energies(own, effort);
    let lowest = without
        .into_iter()
        .fold(as_fitted, |a, b| if b.cost < a.cost { b } else { a });
    // The machine is the one whose lines were fitted: its gap is the one that is shown.
    let nothing = Hypothesis {
        model: nothing.model.clone(),
        ..lowest
    };
    Ok((!others.is_empty()).then(|| Compared::new(nothing, others)))
}

/// The machine without amendments, calibrated to all runs.
fn calibrated(fitter: &Fitter, problem: &Problem, start: &[f64]) -> Result<Hypothesis, Error> {
    let own = problem.parameters.len();
    (fitter.say)("calibrating", f64::NAN);
    let at = |x: &[f64]| fitter.explored(&[(problem.clone(), x.to_vec())]);
    let first = at(start)?.map(|(model, _)| model);
    let model = match first {
        Some(model) if Fitter::is_at_noise(&model) || is_of_pressures(problem) => model,
        first => {
            let x = fitter.searched(problem, start, CALIBRATION)?;
            let further = fitter.settled(&(problem.clone(), x))?;
            let all = first.into_iter().chain(further);
            let best = all.min_by(|a, b| a.deviance.total_cmp(&b.deviance));
            best.ok_or(Error::Nothing)?
        }
    };
    Ok(Hypothesis::new(Vec::new(), model, own))
}

/// The sets that have an amendment of another kind in the place of `believed.set[which]`.
fn rivals<'a>(
    believed: &'a Hypothesis,
    which: usize,
    others: &'a [Hypothesis],
) -> impl Iterator<Item = &'a Hypothesis> {
    let kept: Vec<&Amended> = believed
        .set
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != which)
        .map(|(_, one)| one)
        .collect();
    let own = believed.set[which].amendment.kind();
    others.iter().filter(move |other| {
        other.set.len() == believed.set.len()
            && kept.iter().all(|one| other.has(&one.amendment))
            && other.set.iter().all(|one| one.amendment.kind() != own)
    })
}

impl Judgement {
    /// What speaks for a set.
    fn evidence(&self, set: &Hypothesis) -> Evidence {
        let by_lines = evidence(&self.nothing.model, &set.model);
        match set.view {
            View::Lines => by_lines,
            View::Energies => Evidence {
                log_odds: self.nothing.cost - set.cost,
                energies: Some([self.nothing.gap, set.gap]),
                ..by_lines
            },
        }
    }

    /// The effects that are believed, with their rivals. `problem` is the machine without them.
    pub fn named_effects(&self, problem: &Problem) -> Vec<Found> {
        let values = self.believed.values(problem);
        let all = self
            .believed
            .set
            .iter()
            .enumerate()
            .zip(values)
            .zip(&self.probabilities);
        let found = all.filter_map(|(((i, one), values), probability)| {
            let candidate = one.amendment.effect()?.clone();
            Some(Found {
                effect: Tried {
                    candidate,
                    values,
                    evidence: self.evidence(&self.believed),
                    probability: *probability,
                    model: Some(self.believed.model.clone()),
                },
                after: None,
                rivals: self.rivals(problem, i),
            })
        });
        let mut found: Vec<Found> = found.collect();
        if let Some(last) = found.last_mut() {
            last.after = Some(self.believed.model.clone());
        }
        found
    }

    /// What else might stand in the place of an amendment.
    fn rivals(&self, problem: &Problem, which: usize) -> Vec<Tried> {
        let tried = rivals(&self.believed, which, &self.others).filter_map(|rival| {
            let probability = self.probabilities[which] * (self.believed.cost - rival.cost).exp();
            let values = rival.values(problem);
            let new = rival
                .set
                .iter()
                .zip(values)
                .find(|(one, _)| !self.believed.has(&one.amendment));
            let (one, values) = new?;
            Some(Tried {
                candidate: one.amendment.effect()?.clone(),
                values,
                evidence: self.evidence(rival),
                probability,
                model: Some(rival.model.clone()),
            })
        });
        tried
            .filter(|tried| tried.probability > NEGLIGIBLE)
            .collect()
    }

    /// Effects that were fitted to all runs by themselves, and are not believed.
    pub fn refused(&self, problem: &Problem) -> Vec<Tried> {
        let singles = self.others.iter().filter(|set| set.set.len() == 1);
        let singles = singles.filter(|set| !self.believed.has(&set.set[0].amendment));
        let tried = singles.filter_map(|set| {
            let values = set.values(problem).pop()?;
            let share = (self.believed.cost - set.cost).exp().min(1.0);
            Some(Tried {
                candidate: set.set[0].amendment.effect()?.clone(),
                values,
                evidence: self.evidence(set),
                probability: probability(left(&self.nothing.gap, &set.gap), 0, 1) * share,
                model: Some(set.model.clone()),
            })
        });
        tried.collect()
    }
}

/// Whether a set reduces the residual of every recording of pressures, where none of them could be held out. Of a few
/// recordings one may be off by itself: what is true of the machine has to show in each.
fn shows_in_each(before: &Hypothesis, after: &Hypothesis) -> Result<bool, Error> {
    let problem = &after.model.problem;
    if after.model.held_out.is_some() || !is_of_pressures(problem) {
        return Ok(true);
    }
    let deviances = |hypothesis: &Hypothesis| -> Result<Vec<f64>, Error> {
        let model = &hypothesis.model;
        let of_run = |run: &calibrate::Observation| {
            let alone = model.problem.with_runs(|other| other.id == run.id);
            Ok(Likelihood::coarse(&alone, model.timing).deviance(&model.x)?)
        };
        model.problem.runs.iter().map(of_run).collect()
    };
    let (before, after_each) = (deviances(before)?, deviances(after)?);
    let added = after.set.last().and_then(|one| one.amendment.effect());
    let mut each = before.iter().zip(after_each).zip(&problem.runs);
    Ok(each.all(|((before, now), run)| {
        now < *before || added.is_some_and(|effect| !effect.acts_on(run))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::amendment::candidate::Candidate;
    use crate::fixture::{effort, fitter, problem, problem_of};
    use serde_json::json;

    fn of_kinds_named(problem: &Problem, names: &[&str]) -> Vec<Amendment> {
        let all = Candidate::all(problem).into_iter();
        let named = all.filter(|candidate| names.contains(&candidate.entry.name));
        named.map(Amendment::Effect).collect()
    }

    /// What is believed of the effects of these names.
    fn judged_of(problem: &Problem, names: &[&str]) -> Judgement {
        let effort = effort();
        let amendments = of_kinds_named(problem, names);
        let forms = Forms::UsualWhereTheySuffice;
        judged(&fitter(&effort), problem, &[0.0], &amendments, forms).unwrap()
    }

    #[test]
    fn the_right_kind_is_believed_among_others() {
        let problem = problem();
        let judged = judged_of(&problem, &["ring_friction", "misalignment"]);
        let labels = judged.believed.labels();
        assert_eq!(labels, ["ring_friction"]);
        assert!(judged.probabilities[0] > 0.9, "{:?}", judged.probabilities);
        let found = judged.named_effects(&problem);
        let force = found[0].effect.values[0];
        assert!((force / 150.0 - 1.0).abs() < 0.02, "{force}");
        // It needs no allowance for a law that is off.
        assert!(judged.believed.model.timing < 1e-3);
    }

    #[test]
    fn energies_name_what_they_fall_with_and_nothing_else() {
        let hidden =
            json!([{"sensor_gain": {"measure": "crosshead_acceleration", "error": "40 %"}}]);
        let problem = problem_of(hidden);
        let effort = effort();
        let nothing = Model::at(problem.clone(), &[0.0], 0.0, &effort).unwrap();
        let nothing = Hypothesis::new(Vec::new(), nothing, 1);
        // The machine with what was hidden, and one with something else.
        let far = |name: &str, first: f64| {
            let amendment = of_kinds_named(&problem, &[name]).swap_remove(0);
            let mut values = amendment.effect().unwrap().usual();
            values[0] = first;
            let set = vec![Amended { amendment, values }];
            let with = added(&problem, &set).unwrap();
            let model = Model::at(with, &[], TIMING, &effort).unwrap();
            Hypothesis::new(set, model, 1)
        };
        let believed = |far: Vec<Hypothesis>| {
            let judged = by_energies(&fitter(&effort), &problem, far, &nothing);
            let compared = judged.unwrap().unwrap();
            let Believed { set, without } = compared.believed().unwrap();
            (set.labels(), set.gap.fitted / without.gap.fitted)
        };
        let [right, wrong] =
            [("sensor_gain", 0.4), ("extra_clearance", 1e-5)].map(|(name, first)| far(name, first));
        let label = right.labels();
        let (labels, share) = believed(vec![right, wrong.clone(), nothing.clone()]);
        assert_eq!(labels, label);
        assert!(share < 0.2, "{share}");
        assert_eq!(
            believed(vec![wrong, nothing.clone()]).0,
            Vec::<String>::new()
        );
        let without = by_energies(&fitter(&effort), &problem, Vec::new(), &nothing);
        assert!(without.unwrap().is_none());
    }

    #[test]
    fn what_is_in_none_of_the_candidates_is_not_named() {
        let effect = json!([{"squeeze_film": {"joint": "small_end", "viscosity": "0.05 Pa s"}}]);
        let problem = problem_of(effect);
        let judged = judged_of(&problem, &["sensor_gain"]);
        assert!(
            judged.believed.set.is_empty(),
            "{:?}",
            judged.believed.labels()
        );
        assert!(judged.nothing.model.fitted > 2.0);
    }
}
