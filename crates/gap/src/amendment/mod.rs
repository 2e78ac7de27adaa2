//! What may be amended in a machine: an effect that it lacks, or a value of its data sheet that is wrong.

pub mod candidate;
pub(crate) mod places;

use crate::amendment::candidate::Candidate;
use crate::error::Error;
use crate::model::Model;
use calibrate::data_sheet::{Doubt, doubts};
use calibrate::{Parameter, Problem};

/// Values at which a doubtful value is tried, in standard deviations of its prior.
const DOUBTED: [f64; 4] = [-2.0, -0.7, 0.7, 2.0];
/// Sizes at which waves are tried, over what a linear machine would need: contacts give way.
const SIZES: [f64; 2] = [1.0, 0.3];

/// A change of the machine that may explain what its calibration leaves.
#[derive(Clone, Debug, PartialEq)]
pub enum Amendment {
    /// An effect at a place, or at every place of its kind.
    Effect(Candidate),
    /// The value at this path of the machine file.
    Correction(String),
}

impl Amendment {
    /// Every amendment of the machine of `problem`.
    ///
    /// # Errors
    /// An invalid machine file.
    pub(crate) fn all(problem: &Problem) -> Result<Vec<Self>, Error> {
        let effects = Candidate::all(problem).into_iter().map(Self::Effect);
        let doubts = doubts(problem)?;
        let of_machine = doubts.into_iter().filter(Doubt::is_of_machine);
        let corrections = of_machine.map(|doubt| Self::Correction(doubt.parameter.path));
        Ok(effects.chain(corrections).collect())
    }

    /// It in words.
    pub fn label(&self) -> String {
        match self {
            Self::Effect(candidate) => candidate.label(),
            Self::Correction(path) => path.clone(),
        }
    }

    /// What kind of change it is: amendments of one kind differ by place and order.
    pub fn kind(&self) -> &str {
        match self {
            Self::Effect(candidate) => candidate.entry.name,
            Self::Correction(path) => path,
        }
    }

    /// The effect; none where it is a correction.
    pub fn effect(&self) -> Option<&Candidate> {
        match self {
            Self::Effect(candidate) => Some(candidate),
            Self::Correction(_) => None,
        }
    }

    /// Whether it is of the gas, which pressures show whatever the joints do.
    pub(crate) fn is_of_gas(&self) -> bool {
        match self {
            Self::Effect(candidate) => candidate.is_of_gas(),
            Self::Correction(path) => path.contains("cylinder."),
        }
    }

    /// The problem with it, its parameters free after those that were. Their coordinates are 0 at `values`, SI.
    ///
    /// # Errors
    /// A machine that cannot have it.
    pub(crate) fn added(&self, problem: &Problem, values: &[f64]) -> Result<Problem, Error> {
        match self {
            Self::Effect(candidate) => candidate.added(problem, values),
            Self::Correction(path) => Ok(doubt(problem, path)?.added(problem)),
        }
    }

    /// Coordinates of its parameters, in the problem that has it at `values`, from which they count as `probe`.
    pub(crate) fn start(&self, added: &Problem, own: usize, probe: &[f64]) -> Vec<f64> {
        match self {
            Self::Effect(_) => vec![0.0; added.parameters.len() - own],
            Self::Correction(_) => probe.to_vec(),
        }
    }

    /// The same with the usual form of its law, and these values in it; none where its law has one form.
    pub(crate) fn of_usual_form(&self, values: &[f64]) -> Option<(Self, Vec<f64>)> {
        let usual = self.effect()?.of_usual_form()?;
        let values = usual.usually_formed(values);
        Some((Self::Effect(usual), values))
    }

    /// The same at each of its places alone, with the values of that place; nothing where it has one place.
    pub(crate) fn at_places_alone(&self, values: &[f64]) -> Vec<(Self, Vec<f64>)> {
        let Some(effect) = self.effect().filter(|effect| !effect.each.is_empty()) else {
            return Vec::new();
        };
        let alone = |(item, first): (Candidate, usize)| {
            let count = item.entry.parameters.len();
            (Self::Effect(item), values[first..first + count].to_vec())
        };
        effect.items().into_iter().map(alone).collect()
    }

    /// The same with values of each place's own, all of them as its one set of values; none where each has its own.
    pub(crate) fn of_each_place(&self, values: &[f64]) -> Option<(Self, Vec<f64>)> {
        let effect = self.effect().filter(|effect| effect.shared)?;
        let own = Candidate {
            shared: false,
            ..effect.clone()
        };
        let values = values.repeat(own.sets());
        Some((Self::Effect(own), values))
    }

    /// Where it is tried: values of an effect's parameters (SI), or the coordinate of a correction.
    pub(crate) fn probes(&self, problem: &Problem) -> Result<Vec<Vec<f64>>, Error> {
        match self {
            Self::Effect(candidate) => Ok(candidate.probes(problem)),
            Self::Correction(path) => {
                let deviation = doubt(problem, path)?.deviation;
                Ok(DOUBTED.iter().map(|by| vec![by * deviation]).collect())
            }
        }
    }

    /// Its waves by themselves, each at two phases; nothing where it has none.
    pub(crate) fn quadratures(&self) -> Vec<Vec<f64>> {
        self.effect().map_or(Vec::new(), Candidate::quadratures)
    }

    /// The probes that shares of its [`quadratures`](Self::quadratures) come to: as large and smaller, and in other forms.
    pub(crate) fn combinations(&self, shares: &[f64]) -> Vec<Vec<f64>> {
        let Some(effect) = self.effect() else {
            return Vec::new();
        };
        let of_size = |size: &f64| {
            let shares: Vec<f64> = shares.iter().map(|share| size * share).collect();
            effect.combined(&shares)
        };
        let mut probes: Vec<Vec<f64>> = SIZES.iter().map(of_size).collect();
        probes.extend(effect.other_forms_of(&probes[0]));
        probes
    }

    /// The form of its law at these values; nothing where it has one.
    pub(crate) fn form_at(&self, values: &[f64]) -> Vec<f64> {
        self.effect()
            .map_or(Vec::new(), |effect| effect.form_at(values))
    }

    /// A probe at which hardly anything of it is left, so that a descent can leave it out.
    pub(crate) fn faint(&self, probe: &[f64]) -> Vec<f64> {
        match self {
            Self::Effect(candidate) => candidate.faint(probe),
            Self::Correction(_) => vec![0.0],
        }
    }

    /// Its values in a model in which its parameters begin at `first` and whose first effect it is at `index`, SI.
    pub(crate) fn values(&self, model: &Model, first: usize, index: usize) -> Vec<f64> {
        match self {
            Self::Effect(candidate) => candidate.values(model, index),
            Self::Correction(_) => {
                let parameter: &Parameter = &model.problem.parameters[first];
                vec![parameter.value(model.x[first])]
            }
        }
    }

    /// How many values it has.
    pub(crate) fn count(&self) -> usize {
        self.effect().map_or(1, |candidate| {
            candidate.entry.parameters.len() * candidate.sets()
        })
    }

    /// How many of them are searched.
    pub(crate) fn free(&self) -> usize {
        self.effect()
            .map_or(1, |candidate| candidate.free().count() * candidate.sets())
    }

    /// How many items of a machine file's list of effects it is.
    pub(crate) fn items(&self) -> usize {
        self.effect().map_or(0, |candidate| candidate.items().len())
    }

    /// What its values cost by their prior, in nats: half the square of a correction over its deviation.
    pub(crate) fn improbability(&self, problem: &Problem, x: f64) -> f64 {
        match self {
            Self::Effect(_) => 0.0,
            Self::Correction(path) => {
                let parameter = problem.parameters.iter().find(|p| p.path == *path);
                let deviation =
                    parameter.map_or(1.0, |p| p.box_bounds()[1] / calibrate::data_sheet::REACH);
                0.5 * (x / deviation).powi(2)
            }
        }
    }
}

fn doubt(problem: &Problem, path: &str) -> Result<Doubt, Error> {
    let mut doubts = doubts(problem)?.into_iter();
    let found = doubts.find(|doubt| doubt.parameter.path == path);
    found.ok_or_else(|| {
        Error::Fit(calibrate::Error::Refused(format!(
            "{path} is fitted already"
        )))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use serde_json::json;

    #[test]
    fn what_is_alike_in_both_bearings_has_one_set_of_values() {
        let mut problem = problem();
        let both = |problem: &Problem, kind: &str| {
            let all = Amendment::all(problem).unwrap();
            let mut both = all
                .into_iter()
                .filter(|one| one.label().ends_with("big_end and small_end"));
            both.find(|one| one.kind() == kind)
        };
        // Oil in an ideal joint is nothing.
        assert_eq!(both(&problem, "squeeze_film"), None);
        problem.tree["joints"]["big_end"]["clearance"] = json!("0.1 mm");
        let film = both(&problem, "squeeze_film").unwrap();
        let own = problem.parameters.len();
        let values = film.effect().unwrap().usual();
        let added = film.added(&problem, &values).unwrap();
        assert_eq!((film.items(), film.free()), (2, 5));
        assert_eq!(added.parameters.len(), own + 5);
        assert!(added.parameters[own..].iter().all(|p| p.places.len() == 2));
        // Each bearing has been worn in its own direction.
        let oval = both(&problem, "bearing_ovality").unwrap();
        assert_eq!((oval.items(), oval.free()), (2, 10));
        assert_eq!(oval.of_each_place(&oval.effect().unwrap().usual()), None);
        // Values of their own begin as those that both had.
        let (own, repeated) = film.of_each_place(&values).unwrap();
        assert_eq!((own.items(), own.free()), (2, 10));
        assert_eq!(repeated, [values.clone(), values].concat());
        let freed = own.added(&problem, &repeated).unwrap();
        assert_eq!(freed.tree, added.tree);
        assert!(freed.parameters.iter().all(|p| p.places.len() == 1));
    }

    #[test]
    fn a_value_of_the_data_sheet_may_be_off_by_its_usual_error() {
        let problem = problem();
        let all = Amendment::all(&problem).unwrap();
        let mass = Amendment::Correction("crosshead.mass".to_owned());
        assert!(all.contains(&mass));
        // A joint's clearance is the business of effects.
        assert!(!all.iter().any(|one| one.label().contains("joints.")));
        let added = mass.added(&problem, &[]).unwrap();
        assert_eq!(
            added.parameters.last().map(|p| p.path.as_str()),
            Some("crosshead.mass")
        );
        let one = 0.05;
        assert!((mass.improbability(&added, one) - 0.5).abs() < 0.1);
        assert_eq!(mass.probes(&problem).unwrap().len(), DOUBTED.len());
    }
}
