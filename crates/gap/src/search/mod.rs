//! The search for what is missing: a beam search (Lowerre 1976) over sets of amendments.
//!
//! A set is a node. From the best nodes that were not looked at further, every amendment is tried beside those that they have:
//! an effect that shows only in a worn joint is found beside the wear, although wear by itself leaves much. Of two effects
//! neither may explain as much by itself as a third that imitates both, so that several nodes are looked at further at the
//! same time. A set of which one amendment is exchanged for another is reached from it, and from the set without it.

pub mod far_starts;
pub(crate) mod hypothesis;
pub(crate) mod judgement;
pub(crate) mod probes;
pub(crate) mod projector;
pub(crate) mod recorded_values;
pub(crate) mod screen;
pub(crate) mod trial;

use crate::amendment::Amendment;
use crate::criteria::{explains, left};
use crate::error::{Error, possible};
use crate::fitter::{Few, Fitter, Start};
use crate::model::Model;
use crate::recorded::is_of_pressures;
use crate::search::far_starts::{FarStart, far_starts};
use crate::search::hypothesis::{Hypothesis, added, of_kinds};
use crate::search::screen::{Screened, screen};
use crate::search::trial::{Trial, is_at_noise, likelier, settled, trials};
use calibrate::cloud_descent::KEPT;
use calibrate::energies::TIMING;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Most amendments of a set.
pub(crate) const MOST: usize = 3;
/// Amendments of one kind (its places and orders) that are fitted beside an empty set, the most promising first.
const OF_A_KIND: usize = 3;
/// Amendments that are fitted beside each node, the most promising first: what shows only beside another is not among the
/// first by its score, and stands out once it is fitted roughly.
const TRIED: usize = 16;
/// How many of those that were fitted roughly are fitted further, beside an empty set and beside others (successive
/// halving, Jamieson and Talwalkar 2016).
const REFINED: usize = 8;
const REFINED_BESIDE: usize = 4;
/// Other kinds that are fitted in the place of an amendment, the most promising first.
const EXCHANGED: usize = 3;
/// Share of the gap that the law of the right effect may be off by. Where every set leaves more, descents may have ended in a wrong
/// ringing.
const LITTLE: f64 = 0.2;
/// How many times nodes are looked at further, and how many of different kinds at the same time.
const ROUNDS: usize = 2;
const WIDTH: usize = 2;

/// What a search looks for, and in what.
pub(crate) struct Search<'a> {
    pub fitter: &'a Fitter<'a>,
    /// The machine without amendments.
    pub few: &'a Few,
    /// What may be amended.
    pub amendments: &'a [Amendment],
}

impl Search<'_> {
    /// All sets that were fitted; `nothing` is the empty one. The search ends where the best of them explains the recordings.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn sets(&self, nothing: Hypothesis) -> Result<Sets, Error> {
        let mut nodes = vec![nothing.clone()];
        let mut far: Vec<Hypothesis> = Vec::new();
        let mut lowest: Vec<Hypothesis> = Vec::new();
        let mut expanded: Vec<Vec<String>> = Vec::new();
        for round in 0..ROUNDS {
            if explains(&nodes[0].model) || !self.fitter.effort.goes_on() {
                break;
            }
            let beam = beam(&nodes, &lowest, &expanded);
            expanded.extend(beam.iter().map(Hypothesis::labels));
            let beside = self.beside(&beam, &nothing)?;
            for set in beside.fitted {
                add(&mut nodes, set);
            }
            nodes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            lowest = match leaves_little(&nothing, &nodes[0]) {
                true => Vec::new(),
                false => amended(&beside.far),
            };
            far.extend(beside.far);
            let is_last = round + 1 == ROUNDS || !self.fitter.effort.goes_on();
            // What is looked at further is none of the nodes then.
            if !lowest.is_empty() && !is_last {
                continue;
            }
            for moved in [Self::varied, Self::exchanged] {
                let sets = moved(self, &nodes[0])?;
                for set in sets {
                    add(&mut nodes, set);
                }
                nodes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            }
        }
        Ok(Sets { fitted: nodes, far })
    }

    /// The node with one of its amendments at one place alone, as what acts at two places imitates what acts at one; with
    /// values of each place's own; or without one of them: it may have been no more than a way to the others.
    fn varied(&self, node: &Hypothesis) -> Result<Vec<Hypothesis>, Error> {
        let own = self.few.different.parameters.len();
        let mut varied = node.at_places_alone(&self.few.different)?;
        varied.extend(node.of_each_place(&self.few.different)?);
        if node.set.len() > 1 {
            varied.extend(node.without_one(&self.few.different)?);
        }
        let fitted = varied.into_par_iter().map(|(set, start)| {
            (self.fitter.say)(&words(node, "variations"), node.model.fitted);
            let model = self.fitter.explored(&[start])?;
            Ok(model.map(|(model, _)| Hypothesis::new(set, model, own)))
        });
        let fitted = fitted.collect::<Result<Vec<_>, Error>>()?;
        Ok(fitted.into_iter().flatten().collect())
    }

    /// The node with one of its amendments exchanged for the most promising of other kinds, which are looked at in the machine
    /// as the node has it: without what is missing a fit goes astray, and what two kinds have in common does not show there.
    fn exchanged(&self, node: &Hypothesis) -> Result<Vec<Hypothesis>, Error> {
        let own = self.few.different.parameters.len();
        let mut others = Vec::new();
        for (one, (set, (problem, x))) in
            node.set.iter().zip(node.without_one(&self.few.different)?)
        {
            let timing = node.model.timing;
            let Some(model) = possible(Model::at(problem, &x, timing, self.fitter.effort))? else {
                continue;
            };
            let without = Hypothesis::new(set, model, own);
            let of_other_kind =
                |other: &&Amendment| other.kind() != one.amendment.kind() && !without.has(other);
            let rivals = self.amendments.iter().filter(of_other_kind).cloned();
            (self.fitter.say)(&words(node, "rivals"), node.model.fitted);
            let screened = self.screened(&without, false, rivals.collect())?;
            let screened = best_of_each_kind(screened, 1);
            let screened = screened.into_iter().take(EXCHANGED);
            others.extend(screened.map(|screened| (without.clone(), screened)));
        }
        let fitted = others.into_par_iter().map(|(without, screened)| {
            let forms = trials(self.fitter, self.few, &without, &screened)?;
            settled(self.fitter, &forms, own)
        });
        let fitted = fitted.collect::<Result<Vec<_>, Error>>()?;
        Ok(fitted.into_iter().flatten().collect())
    }

    /// The sets of these nodes with each of the most promising other amendments; `nothing` is the machine without any. Where none
    /// of them leaves little, they are fitted from far away, too.
    fn beside(&self, beam: &[Hypothesis], nothing: &Hypothesis) -> Result<Sets, Error> {
        let alone = beam.iter().all(|node| node.set.is_empty());
        let so_far = beam.first().map_or(f64::NAN, |best| best.model.fitted);
        let mut of_each = Vec::new();
        for node in beam {
            (self.fitter.say)(&words(node, "screening"), node.model.fitted);
            let others = self.amendments.iter().filter(|one| !node.has(one));
            let screened = self.screened(node, alone, others.cloned().collect())?;
            let of_a_kind = if alone { OF_A_KIND } else { 1 };
            of_each.push(best_of_each_kind(screened, of_a_kind).into_iter());
        }
        let chosen = in_turn(beam, of_each, TRIED * beam.len());
        let rough = chosen.into_par_iter().map(|(node, screened)| {
            (self.fitter.say)(&words(node, "fitting roughly"), node.model.fitted);
            trials(self.fitter, self.few, node, &screened)
        });
        let mut rough = rough.collect::<Result<Vec<_>, Error>>()?;
        rough.retain(|forms| !forms.is_empty());
        // What a freer law costs counts once it has been fitted.
        rough.sort_by(|a, b| a[0].deviance.total_cmp(&b[0].deviance));
        let count = if alone { REFINED } else { REFINED_BESIDE };
        let mut fitted = self.refined(&rough[..count.min(rough.len())], so_far)?;
        let mut far = Vec::new();
        let of_pressures = is_of_pressures(&self.few.different);
        let goes_on = self.fitter.effort.goes_on() && !of_pressures;
        if goes_on && !fitted.iter().any(|set| leaves_little(nothing, set)) {
            (self.fitter.say)("searching far away", so_far);
            rough.truncate(TRIED);
            let mut first: Vec<&Trial> = rough.iter().filter_map(|forms| forms.first()).collect();
            // What energies leave without an effect is what they are judged beside.
            let nothing = Trial::of_nothing(&self.few.different);
            if alone {
                first.push(&nothing);
            }
            far = self.far_away(&first)?;
            fitted.extend(self.descended(&amended(&far))?);
        }
        Ok(Sets { fitted, far })
    }

    /// These sets fitted from where rough descents of the forms of their last law have led, and where that leaves more than noise in the
    /// machine as it was given.
    fn refined(&self, rough: &[Vec<Trial>], so_far: f64) -> Result<Vec<Hypothesis>, Error> {
        let own = self.few.different.parameters.len();
        let fitted = rough.par_iter().map(|forms| {
            let [first, ..] = &forms[..] else {
                return Ok(None);
            };
            (self.fitter.say)(&first.words(), so_far);
            let best = settled(self.fitter, forms, own)?;
            if best.as_ref().is_some_and(is_at_noise) {
                return Ok(best);
            }
            let given = self.fitter.explored(&[as_given(&first.start, own)])?;
            let given = given.map(|(model, _)| Hypothesis::new(first.set.clone(), model, own));
            Ok(likelier(best, given))
        });
        let fitted = fitted.collect::<Result<Vec<_>, Error>>()?;
        Ok(fitted.into_iter().flatten().collect())
    }

    /// These sets where descents lead from the machines as they are.
    fn descended(&self, sets: &[Hypothesis]) -> Result<Vec<Hypothesis>, Error> {
        let own = self.few.different.parameters.len();
        let fitted = sets.par_iter().map(|Hypothesis { set, model, .. }| {
            let led = (self.fitter).settled(&(model.problem.clone(), model.x.clone()))?;
            Ok(led.map(|model| Hypothesis::new(set.clone(), model, own)))
        });
        let fitted = fitted.collect::<Result<Vec<_>, Error>>()?;
        Ok(fitted.into_iter().flatten().collect())
    }

    /// The machines of those of these trials whose energies are the lowest, however far away that is, the lowest first, and that to which
    /// nothing is added. What rough descents left of them does not count: it is the ringing in which they ended.
    fn far_away(&self, trials: &[&Trial]) -> Result<Vec<Hypothesis>, Error> {
        let own = self.few.different.parameters.len();
        let starts: Vec<FarStart> = trials.iter().map(|trial| trial.far()).collect();
        let far = far_starts(self.fitter, &starts, own)?.into_iter();
        let kept = starts.len().div_ceil(KEPT);
        let far = far.enumerate().filter_map(|(rank, (index, x))| {
            (rank < kept || trials[index].set.is_empty()).then_some((index, x))
        });
        let machines = far.map(|(index, x)| {
            let Trial { set, start, .. } = trials[index];
            let at = Model::at(start.0.clone(), &x, TIMING, self.fitter.effort);
            Ok(possible(at)?.map(|model| Hypothesis::new(set.clone(), model, own)))
        });
        let machines = machines.collect::<Result<Vec<_>, Error>>()?;
        Ok(machines.into_iter().flatten().collect())
    }

    /// The amendments that a node may get, the most promising first.
    fn screened(
        &self,
        node: &Hypothesis,
        alone: bool,
        amendments: Vec<Amendment>,
    ) -> Result<Vec<Screened>, Error> {
        let alike = added(&self.few.alike, &node.set)?;
        let (x, timing) = (&node.model.x, node.model.timing);
        let model = possible(Model::at(alike, x, timing, self.fitter.effort))?;
        let model = model.as_ref().unwrap_or(&node.model);
        screen(self.fitter, model, alone, amendments)
    }
}

/// Whether a set leaves no more than what the law of the right effect may be off by.
pub(crate) fn leaves_little(nothing: &Hypothesis, set: &Hypothesis) -> bool {
    left(&nothing.gap, &set.gap) < LITTLE
}

/// Those of these sets that are not empty.
fn amended(sets: &[Hypothesis]) -> Vec<Hypothesis> {
    let amended = sets.iter().filter(|set| !set.set.is_empty());
    amended.cloned().collect()
}

/// The nodes to look at further: the first of different kinds that were not. Where none that was `fitted` leaves little, what is
/// left of them is the ringing in which each fit ended, and those whose energies are the `lowest` come first.
fn beam(fitted: &[Hypothesis], lowest: &[Hypothesis], expanded: &[Vec<String>]) -> Vec<Hypothesis> {
    let open = |node: &&Hypothesis| node.set.len() < MOST && !expanded.contains(&node.labels());
    let beam = of_kinds(lowest.iter().chain(fitted).filter(open)).into_iter();
    beam.take(WIDTH).cloned().collect()
}

/// The first of each node, then the second of each, and so on; no set twice.
fn in_turn(
    beam: &[Hypothesis],
    mut of_each: Vec<impl Iterator<Item = Screened>>,
    most: usize,
) -> Vec<(&Hypothesis, Screened)> {
    let mut chosen: Vec<(&Hypothesis, Screened)> = Vec::new();
    let mut known: Vec<Vec<String>> = Vec::new();
    loop {
        let before = chosen.len();
        for (node, screened) in beam.iter().zip(&mut of_each) {
            let next = screened.find_map(|screened| {
                let labels = node.labels_with(&screened.amendment);
                (!known.contains(&labels)).then_some((labels, screened))
            });
            if let Some((labels, screened)) = next {
                known.push(labels);
                chosen.push((node, screened));
            }
        }
        if chosen.len() == before || chosen.len() >= most {
            chosen.truncate(most);
            return chosen;
        }
    }
}

/// No more than `most` of a kind, the first ones.
fn best_of_each_kind(mut screened: Vec<Screened>, most: usize) -> Vec<Screened> {
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    screened.retain(|screened| {
        let kind = screened.amendment.kind().to_owned();
        let count = kinds.entry(kind).or_default();
        *count += 1;
        *count <= most
    });
    screened
}

/// Adds a set to others, or puts it in the place of the same one that was fitted worse.
fn add(nodes: &mut Vec<Hypothesis>, set: Hypothesis) {
    let labels = set.labels();
    match nodes.iter_mut().find(|node| node.labels() == labels) {
        Some(same) if set.cost < same.cost => *same = set,
        Some(_) => {}
        None => nodes.push(set),
    }
}

/// The same amendments in the machine as it was given: without them its parameters may have been led far astray.
fn as_given((problem, x): &Start, own: usize) -> Start {
    let mut x = x.clone();
    x[..own].fill(0.0);
    (problem.clone(), x)
}

/// What was found.
pub(crate) struct Sets {
    /// Sets that were fitted.
    pub fitted: Vec<Hypothesis>,
    /// Where sets were searched far away, the machines in which their energies are the lowest, the lowest first, and that of
    /// the empty set.
    pub far: Vec<Hypothesis>,
}

fn words(node: &Hypothesis, what: &str) -> String {
    match node.set.is_empty() {
        true => what.to_owned(),
        false => format!("{what} beside {}", node.labels().join(" and ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{effort, problem};
    use crate::search::hypothesis::Amended;
    use calibrate::Problem;

    fn amendments(problem: &Problem) -> [Amendment; 3] {
        let all = Amendment::all(problem).unwrap();
        ["ring_friction", "misalignment", "sensor_gain"].map(|kind| {
            let found = all.iter().find(|one| one.kind() == kind);
            found.unwrap().clone()
        })
    }

    fn node(problem: &Problem, amendment: &Amendment) -> Hypothesis {
        let values = amendment.effect().unwrap().usual();
        let set = vec![Amended {
            amendment: amendment.clone(),
            values,
        }];
        let model = Model::at(added(problem, &set).unwrap(), &[], 0.0, &effort()).unwrap();
        Hypothesis::new(set, model, problem.parameters.len())
    }

    #[test]
    fn where_no_fit_leaves_little_those_of_low_energies_are_looked_at_further() {
        let problem = problem();
        let [a, b, c] = amendments(&problem).map(|one| node(&problem, &one));
        let [of_a, of_b, of_c] = [&a, &b, &c].map(Hypothesis::labels);
        let fitted = [a, b];
        let labels = |lowest: &[Hypothesis], expanded: &[Vec<String>]| -> Vec<Vec<String>> {
            let beam = beam(&fitted, lowest, expanded);
            beam.iter().map(Hypothesis::labels).collect()
        };
        let lowest = std::slice::from_ref(&c);
        assert_eq!(labels(lowest, &[]), [of_c.clone(), of_a.clone()]);
        let once = [of_c];
        assert_eq!(labels(lowest, &once), [of_a.clone(), of_b.clone()]);
        assert_eq!(labels(&[], &[]), [of_a, of_b]);
    }

    #[test]
    fn nodes_are_served_in_turn_and_no_set_is_fitted_twice() {
        let problem = problem();
        let [a, b, c] = amendments(&problem);
        let beam = [node(&problem, &a), node(&problem, &b)];
        let screened = |all: [&Amendment; 2]| {
            let of = |amendment: &Amendment| Screened {
                amendment: amendment.clone(),
                starts: Vec::new(),
            };
            all.map(of).into_iter()
        };
        let of_each = || vec![screened([&b, &c]), screened([&a, &c])];
        let sets = |most: usize| -> Vec<Vec<String>> {
            let chosen = in_turn(&beam, of_each(), most);
            let labels = chosen
                .iter()
                .map(|(node, one)| node.labels_with(&one.amendment));
            labels.collect()
        };
        let [a, b, c] = [&a, &b, &c].map(Amendment::label);
        let pair = |x: &String, y: &String| {
            let mut pair = vec![x.clone(), y.clone()];
            pair.sort_unstable();
            pair
        };
        let expected = [pair(&a, &b), pair(&b, &c), pair(&a, &c)];
        assert_eq!(sets(16), expected);
        assert_eq!(sets(2), expected[..2]);
    }
}
