//! A set of amendments, and the machine that was fitted with them.

use crate::amendment::Amendment;
use crate::criteria::{freedom, nats, nats_of_energies};
use crate::error::Error;
use crate::finding::effects;
use crate::fitter::effort::Effort;
use crate::fitter::{Fitter, Start};
use crate::model::{Gap, Model};
use calibrate::Problem;
use calibrate::energies::Energies;
use calibrate::likelihood::misfit;
use calibrate::optimiser::LeastSquares;

/// Nats that an amendment costs for being one of many that were tried.
const CHOSEN: f64 = 4.0;

/// An amendment, and the values (SI) at which its coordinates are 0; nothing for a correction.
#[derive(Clone, Debug)]
pub(crate) struct Amended {
    pub amendment: Amendment,
    pub values: Vec<f64>,
}

/// What of the recordings a set is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// Their lines, with the phases of ringing.
    Lines,
    /// How strongly they ring in each band and sector.
    Energies,
}

/// A set of amendments of a machine.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    pub set: Vec<Amended>,
    pub model: Model,
    /// What it is judged by.
    pub view: View,
    /// What it leaves of that.
    pub gap: Gap,
    /// How unlikely it is with its prior, in nats.
    pub cost: f64,
}

impl Hypothesis {
    /// `own` is how many parameters the machine has without the set.
    pub fn new(set: Vec<Amended>, model: Model, own: usize) -> Self {
        Self {
            view: View::Lines,
            gap: model.gap(),
            cost: nats(&model) + improbability(&set, &model, own),
            set,
            model,
        }
    }

    /// The same judged by the energies of its machine, in which what is quieter than the noise of a revolution does not count.
    pub fn by_energies(self, own: usize, effort: &Effort) -> Self {
        let Model { problem, x, .. } = &self.model;
        let leaves = |fitted: bool| {
            let part = problem.with_runs(|run| effort.fits(&run.id) == fitted);
            let residuals = (!part.runs.is_empty()).then(|| Energies::loud(&part).residuals(x));
            residuals.unwrap_or_default()
        };
        let [fitted, held_out] = [true, false].map(leaves);
        let gap = Gap {
            fitted: misfit(&fitted),
            held_out: (!held_out.is_empty()).then(|| misfit(&held_out)),
        };
        let nats = nats_of_energies(problem, misfit(&[fitted, held_out].concat()));
        Self {
            view: View::Energies,
            gap,
            cost: nats + improbability(&self.set, &self.model, own),
            ..self
        }
    }

    /// Whether it has this amendment, of whichever form.
    pub fn has(&self, amendment: &Amendment) -> bool {
        let label = amendment.label();
        self.set.iter().any(|one| one.amendment.label() == label)
    }

    /// Its amendments in words, in their alphabetical order: the same for the same set.
    pub fn labels(&self) -> Vec<String> {
        let mut labels: Vec<String> = self.set.iter().map(|one| one.amendment.label()).collect();
        labels.sort_unstable();
        labels
    }

    /// The same of the set with one amendment more.
    pub fn labels_with(&self, amendment: &Amendment) -> Vec<String> {
        let mut labels = self.labels();
        labels.push(amendment.label());
        labels.sort_unstable();
        labels
    }

    /// The kinds of its amendments, in their alphabetical order.
    pub fn kinds(&self) -> Vec<&str> {
        let mut kinds: Vec<&str> = self.set.iter().map(|one| one.amendment.kind()).collect();
        kinds.sort_unstable();
        kinds
    }

    /// It fitted to all runs of `problem`, from where a few have led: with the allowance that they needed, and with greater
    /// ones first; the likelier of the two.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn settled(&self, fitter: &Fitter, problem: &Problem) -> Result<Option<Self>, Error> {
        let with = added(problem, &self.set)?;
        let start = (with, self.model.x.clone());
        let near = fitter.settled_from(&start, self.model.timing)?;
        let far = fitter.settled(&start)?;
        let both = near.into_iter().chain(far);
        let model = both.min_by(|a, b| a.deviance.total_cmp(&b.deviance));
        Ok(model.map(|model| Self::new(self.set.clone(), model, problem.parameters.len())))
    }

    /// The same with the usual forms of the laws of its first `count` amendments, where the recordings are less likely so by no
    /// more than what the freedom of another form costs.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn of_usual_form(
        self,
        count: usize,
        fitter: &Fitter,
        problem: &Problem,
    ) -> Result<Self, Error> {
        if self.view == View::Energies {
            return Ok(self);
        }
        let values = self.values(problem);
        let all = self.set.iter().zip(&values);
        let mut usual: Vec<_> = all
            .map(|(one, values)| one.amendment.of_usual_form(values))
            .collect();
        usual[count..].fill(None);
        if usual.iter().all(Option::is_none) {
            return Ok(self);
        }
        let (set, start) = self.exchanged(problem, usual)?;
        let usual = fitter.settled_from(&start, self.model.timing)?;
        let own = problem.parameters.len();
        let usual = usual.map(|model| Self::new(set, model, own));
        Ok(usual.filter(|usual| usual.cost < self.cost).unwrap_or(self))
    }

    /// The same where a last, longer fit ends, if the recordings are likelier there. Its cost stays that at which it was compared with
    /// others, whose fits were no longer; and so does the machine without amendments.
    ///
    /// # Errors
    /// A machine that cannot be simulated; [`Error::Stopped`].
    pub fn finished(self, fitter: &Fitter, problem: &Problem) -> Result<Self, Error> {
        if self.set.is_empty() || self.view == View::Energies {
            return Ok(self);
        }
        let own = problem.parameters.len();
        let further = fitter.finished(&self.model)?;
        let further = further.map(|model| Self::new(self.set.clone(), model, own));
        Ok(match further {
            Some(further) if further.cost < self.cost => Self {
                cost: self.cost,
                ..further
            },
            _ => self,
        })
    }

    /// The sets that have one of its amendments at one of its places alone, each with the start of a fit.
    ///
    /// # Errors
    /// A machine that cannot be so.
    pub fn at_places_alone(&self, problem: &Problem) -> Result<Vec<(Vec<Amended>, Start)>, Error> {
        let mut all = Vec::new();
        for (i, values) in self.values(problem).iter().enumerate() {
            for alone in self.set[i].amendment.at_places_alone(values) {
                let mut new = vec![None; self.set.len()];
                new[i] = Some(alone);
                all.push(self.exchanged(problem, new)?);
            }
        }
        Ok(all)
    }

    /// The sets that have values of each place's own for one of its amendments, each with the start of a fit.
    ///
    /// # Errors
    /// A machine that cannot be so.
    pub fn of_each_place(&self, problem: &Problem) -> Result<Vec<(Vec<Amended>, Start)>, Error> {
        let mut all = Vec::new();
        for (i, values) in self.values(problem).iter().enumerate() {
            if let Some(own) = self.set[i].amendment.of_each_place(values) {
                let mut new = vec![None; self.set.len()];
                new[i] = Some(own);
                all.push(self.exchanged(problem, new)?);
            }
        }
        Ok(all)
    }

    /// The sets that lack one of its amendments, each with the start of a fit.
    ///
    /// # Errors
    /// A machine that cannot be so.
    pub fn without_one(&self, problem: &Problem) -> Result<Vec<(Vec<Amended>, Start)>, Error> {
        let own = problem.parameters.len();
        let firsts = firsts(&self.model.problem, &self.set, own);
        let without = |left_out: usize| {
            let mut x = self.model.x[..own].to_vec();
            let mut set = Vec::new();
            for (i, one) in self.set.iter().enumerate().filter(|(i, _)| *i != left_out) {
                x.extend(&self.model.x[firsts[i]..firsts[i] + one.amendment.free()]);
                set.push(one.clone());
            }
            Ok((set.clone(), (added(problem, &set)?, x)))
        };
        (0..self.set.len()).map(without).collect()
    }

    /// Its set with some amendments exchanged for others at these values, and the start of a fit with it.
    fn exchanged(
        &self,
        problem: &Problem,
        new: Vec<Option<(Amendment, Vec<f64>)>>,
    ) -> Result<(Vec<Amended>, Start), Error> {
        let own = problem.parameters.len();
        let (mut set, mut with) = (Vec::new(), problem.clone());
        let mut x = self.model.x[..own].to_vec();
        let firsts = firsts(&self.model.problem, &self.set, own);
        for ((one, first), new) in self.set.iter().zip(firsts).zip(new) {
            let one = match new {
                Some((amendment, values)) => {
                    x.extend(vec![0.0; amendment.free()]);
                    Amended { amendment, values }
                }
                None => {
                    x.extend(&self.model.x[first..first + one.amendment.free()]);
                    one.clone()
                }
            };
            with = one.amendment.added(&with, &one.values)?;
            set.push(one);
        }
        Ok((set, (with, x)))
    }

    /// The values of its amendments as they were fitted, SI.
    pub fn values(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let own = problem.parameters.len();
        let mut index = effects(problem);
        let firsts = firsts(&self.model.problem, &self.set, own);
        let values = self.set.iter().zip(firsts).map(|(one, first)| {
            let values = one.amendment.values(&self.model, first, index);
            index += one.amendment.items();
            values
        });
        values.collect()
    }
}

/// What is against a set before the recordings are looked at, in nats: its freedom, and how far from what is usual it is.
fn improbability(set: &[Amended], model: &Model, own: usize) -> f64 {
    let mut prior = freedom(&model.problem, model.x.len() - own) + CHOSEN * set.len() as f64;
    for (one, first) in set.iter().zip(firsts(&model.problem, set, own)) {
        prior += one.amendment.improbability(&model.problem, model.x[first]);
    }
    prior
}

/// The least costly set of each combination of kinds.
pub(crate) fn of_kinds<'a>(sets: impl Iterator<Item = &'a Hypothesis>) -> Vec<&'a Hypothesis> {
    let mut best: Vec<&Hypothesis> = Vec::new();
    for set in sets {
        if best.iter().all(|other| other.kinds() != set.kinds()) {
            best.push(set);
        }
    }
    best
}

/// The problem with these amendments.
///
/// # Errors
/// A machine that cannot have them.
pub(crate) fn added(problem: &Problem, set: &[Amended]) -> Result<Problem, Error> {
    let with = |problem: Problem, one: &Amended| one.amendment.added(&problem, &one.values);
    set.iter().try_fold(problem.clone(), with)
}

/// The machine of `problem`, amended as `set` and by `amendment` at `probe`, from the coordinates `x` of the machine with
/// `set`. None where it cannot be so.
pub(crate) fn start(
    problem: &Problem,
    x: &[f64],
    amendment: &Amendment,
    probe: &[f64],
) -> Option<Start> {
    let with = amendment.added(problem, probe).ok()?;
    let own = amendment.start(&with, x.len(), probe);
    Some((with, [x, &own].concat()))
}

/// Index of the first parameter of each amendment of a set.
fn firsts(problem: &Problem, set: &[Amended], own: usize) -> Vec<usize> {
    let mut first = own;
    let all = set.iter().map(|one| {
        let start = first.min(problem.parameters.len().saturating_sub(1));
        first += one.amendment.free();
        start
    });
    all.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::amendment::candidate::Candidate;
    use crate::fixture::{effort, problem};

    #[test]
    fn a_set_without_one_keeps_the_coordinates_of_the_others() {
        let problem = problem();
        let own = problem.parameters.len();
        let named = |name: &str| {
            let mut all = Candidate::all(&problem).into_iter();
            let candidate = all.find(|one| one.entry.name == name).unwrap();
            let values = candidate.usual();
            let amendment = Amendment::Effect(candidate);
            Amended { amendment, values }
        };
        let set = vec![named("ring_friction"), named("sensor_gain")];
        let with = added(&problem, &set).unwrap();
        let x: Vec<f64> = (0..with.parameters.len())
            .map(|i| 1e-3 * i as f64)
            .collect();
        let model = Model::at(with.clone(), &x, 0.0, &effort()).unwrap();
        let both = Hypothesis::new(set, model, own);
        let [gain, friction] = both.without_one(&problem).unwrap().try_into().unwrap();
        for ((set, (problem, x_left)), kept) in [(gain, "sensor_gain"), (friction, "ring_friction")]
        {
            let kinds: Vec<&str> = set.iter().map(|one| one.amendment.kind()).collect();
            assert_eq!(kinds, [kept]);
            let values = |problem: &Problem, x: &[f64]| -> Vec<(String, f64)> {
                let all = problem.parameters.iter().zip(x);
                let key = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
                all.map(|(p, x)| (key(&p.path), *x)).collect()
            };
            let before = values(&with, &x);
            let left = values(&problem, &x_left);
            assert_eq!(left.len(), own + set[0].amendment.free());
            assert!(left.iter().all(|one| before.contains(one)), "{left:?}");
        }
        let alone = Hypothesis::new(both.set[..1].to_vec(), both.model.clone(), own);
        let [(nothing, (_, x))] = alone.without_one(&problem).unwrap().try_into().unwrap();
        assert!(nothing.is_empty() && x.len() == own);
    }
}
