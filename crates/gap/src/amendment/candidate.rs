//! What may be missing: an effect of the catalogue at a place of the machine.

use crate::amendment::places::{
    BEARINGS, EITHER, MEASURE, PRESSURE, distinguishes_ends, has_crank_end, is_clear, places,
    recorded, throws, words,
};
use crate::error::Error;
use crate::model::Model;
use crate::recorded::{is_of_pressures, shows_pressure};
use calibrate::Problem;
use input::MachineFile;
use input::effects::{CATALOGUE, Entry, Kind, Parameter, Proposal};
use serde_json::Value;
use std::f64::consts::TAU;

/// An effect at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The effect.
    pub entry: &'static Entry,
    /// Where it acts: keys of its section and words.
    pub place: Vec<(&'static str, String)>,
    /// The values that are not searched (an order), by their index among the effect's parameters.
    pub fixed: Vec<(usize, f64)>,
    /// The places of one kind that have the effect together, as the keys and words that distinguish them (both
    /// bearings, both ends of a cylinder); none where it acts at `place` alone.
    pub each: Vec<(&'static str, String)>,
    /// Whether one set of values holds at each of them, or each has values of its own.
    pub shared: bool,
    /// Whether the form of its law is searched, and not only its size.
    pub formed: bool,
}

/// Share of an amplitude that is next to nothing.
const FAINT: f64 = 0.03;
impl Candidate {
    /// Every effect of the catalogue at every place that the machine of `problem` has.
    pub fn all(problem: &Problem) -> Vec<Self> {
        let throws = throws(&problem.tree);
        let known = shows_pressure(problem);
        let both_ends = has_crank_end(&problem.tree) && distinguishes_ends(problem);
        let mut all = Vec::new();
        // The zero of the crank angle is fitted from the start, unless pressures are all that was recorded.
        // Clearance volume and exponents imitate its effect on pressures, so that it has to earn its place.
        let zero = !problem
            .parameters
            .iter()
            .any(calibrate::Parameter::is_crank_angle_offset)
            && is_of_pressures(problem);
        let looked_for = |entry: &&Entry| match entry.proposal {
            Proposal::CrankAngleZero => zero,
            proposal => !proposal.is_separate(),
        };
        for entry in CATALOGUE.iter().filter(looked_for) {
            for place in places(entry, &throws, both_ends) {
                if is_series(entry) && recorded(problem, &place) == Some(1) {
                    continue;
                }
                let own = both_ends
                    && entry.proposal == Proposal::PerEnd
                    && place.iter().all(|(key, _)| *key != EITHER);
                let ends = entry.places.iter().filter(|c| own && c.key == EITHER);
                let each: Vec<(&str, String)> = ends.flat_map(words).collect();
                for mut fixed in orders(entry) {
                    fixed.extend(included(entry, &place, problem));
                    let place = place.clone();
                    let candidate = Self {
                        entry,
                        place,
                        fixed,
                        each: each.clone(),
                        shared: false,
                        formed: true,
                    };
                    let usual = candidate.usual();
                    let seen = known || !candidate.place.iter().any(|(_, word)| word == PRESSURE);
                    let new = seen && candidate.is_new(problem);
                    if new && candidate.added(problem, &usual).is_ok() {
                        all.push(candidate);
                    }
                }
            }
        }
        let together = all.iter().flat_map(|one| {
            let both = one.in_both_bearings(problem);
            both.into_iter().chain(one.at_every_throw(&throws))
        });
        let possible = |one: &Self| one.added(problem, &one.usual()).is_ok();
        let together: Vec<Self> = together.filter(possible).collect();
        all.extend(together);
        all
    }

    /// The same in the bearings of both ends of the rod, where it is in the first of them and both are clear.
    /// Oil and wear are alike there. A direction is each bearing's own.
    fn in_both_bearings(&self, problem: &Problem) -> Option<Self> {
        let clear = |joint: &&str| is_clear(problem, &self.place, joint);
        let shared = !self.entry.parameters.iter().any(|p| p.cyclic);
        let both = BEARINGS.iter().all(clear).then_some(BEARINGS)?;
        self.at_each("joint", &both, shared)
    }

    /// The same at every throw of a machine that has several, with one set of values: what is the machine's is alike there.
    fn at_every_throw(&self, throws: &[String]) -> Option<Self> {
        let throws: Vec<&str> = throws.iter().map(String::as_str).collect();
        (throws.len() > 1).then(|| self.at_each("throw", &throws, true))?
    }

    /// The same at each of these places, where it is at the first of them.
    fn at_each(&self, key: &'static str, words: &[&str], shared: bool) -> Option<Self> {
        let at_first = (key, words.first()?.to_string());
        let index = self.place.iter().position(|word| *word == at_first)?;
        let mut together = self.clone();
        together.place.remove(index);
        together.each = words.iter().map(|word| (key, (*word).to_owned())).collect();
        together.shared = shared;
        self.each.is_empty().then_some(together)
    }

    /// The same with only the parameters of these indices free, and the others without effect or as
    /// usual.
    pub(crate) fn restricted(&self, free: &[usize]) -> Self {
        let parameters = self.entry.parameters.iter().enumerate();
        let others = parameters.filter(|(i, _)| !free.contains(i));
        Self {
            fixed: others
                .map(|(i, p)| (i, p.absent.unwrap_or(p.start)))
                .collect(),
            ..self.clone()
        }
    }

    /// The same with the usual form of its law; none where its law has one form.
    pub(crate) fn of_usual_form(&self) -> Option<Self> {
        let forms = self.entry.parameters.iter().any(|p| p.shape);
        (forms && self.formed).then(|| Self {
            formed: false,
            ..self.clone()
        })
    }

    /// These values, with those of the usual form of its law.
    pub(crate) fn usually_formed(&self, values: &[f64]) -> Vec<f64> {
        let parameters = self.entry.parameters.iter().cycle();
        let usual = |(value, p): (&f64, &Parameter)| if p.shape { p.start } else { *value };
        values.iter().zip(parameters).map(usual).collect()
    }

    /// The parameters that are searched, by their indices.
    pub(crate) fn free(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.entry.parameters.len()).filter(|i| self.is_free(*i))
    }

    pub(crate) fn is_free(&self, index: usize) -> bool {
        let is_form = self.entry.parameters[index].shape && !self.formed;
        !is_form && !self.fixed.iter().any(|(fixed, _)| *fixed == index)
    }

    /// Whether it acts on the gas or on what measures it, so that the pressures show it.
    pub fn is_of_gas(&self) -> bool {
        let measures = |(_, word): &(&str, String)| word == PRESSURE;
        self.entry.kind == Kind::Gas
            || self.entry.proposal == Proposal::CrankAngleZero
            || self.place.iter().any(measures)
    }

    /// Whether it acts on gas whose pressure was recorded, so that the pressures alone show it.
    pub(crate) fn is_shown_by_pressures(&self, problem: &Problem) -> bool {
        self.is_of_gas() && recorded(problem, &self.place).is_some_and(|chambers| chambers > 0)
    }

    /// Whether a run of pressures shows the end of the cylinder at which it acts.
    pub(crate) fn acts_on(&self, run: &calibrate::Observation) -> bool {
        let at = |column: &str| match column.contains("crank_end") {
            true => "crank",
            false => "head",
        };
        let mut columns = run.channels.iter().map(|channel| channel.column.as_str());
        self.end()
            .is_none_or(|end| columns.any(|column| at(column) == end))
    }

    /// The same at the end of the cylinder alone whose pressure was recorded, where it acts at both and that
    /// of the other was not.
    pub(crate) fn at_recorded_end(&self, problem: &Problem) -> Option<Self> {
        let choice = self.entry.places.iter().find(|c| c.key == EITHER)?;
        if self.end().is_some() || !self.each.is_empty() || !has_crank_end(&problem.tree) {
            return None;
        }
        let at = |end: &&str| {
            let mut alone = self.clone();
            alone.place.push((EITHER, (*end).to_owned()));
            alone
        };
        let each = choice.words.iter().map(at);
        let mut shown = each.filter(|alone| alone.is_shown_by_pressures(problem));
        shown.next().filter(|_| shown.next().is_none())
    }

    /// Its joint, where it has one.
    pub fn joint(&self) -> Option<&str> {
        let place = self.place.iter().find(|(key, _)| *key == "joint");
        place.map(|(_, joint)| joint.as_str())
    }

    /// The throw at which it acts, where it does at one alone.
    pub fn throw(&self) -> Option<&str> {
        let place = self.place.iter().find(|(key, _)| *key == "throw");
        place.map(|(_, throw)| throw.as_str())
    }

    /// The end of the cylinder at which it acts, where it does at one alone.
    pub fn end(&self) -> Option<&str> {
        let place = self.place.iter().find(|(key, _)| *key == EITHER);
        place.map(|(_, end)| end.as_str())
    }

    /// Everywhere that it acts, in words.
    pub(crate) fn places(&self) -> Vec<String> {
        let all = self.place.iter().chain(&self.each);
        all.map(|(_, word)| word.clone()).collect()
    }

    /// What it is called in words: effect, place and order.
    pub fn label(&self) -> String {
        let mut label = self.entry.name.to_owned();
        for (_, word) in &self.place {
            label.push(' ');
            label.push_str(word);
        }
        if !self.each.is_empty() {
            let each: Vec<&str> = self.each.iter().map(|(_, word)| word.as_str()).collect();
            label.push_str(&format!(" {}", each.join(" and ")));
        }
        for (index, value) in &self.fixed {
            let parameter = &self.entry.parameters[*index];
            if parameter.whole {
                label.push_str(&format!(" {} {value}", parameter.key));
            }
        }
        label
    }

    /// It as the items of a machine file's list of effects that it consists of, with the index of
    /// each one's first value.
    pub fn items(&self) -> Vec<(Self, usize)> {
        if self.each.is_empty() {
            return vec![(self.clone(), 0)];
        }
        let own = match self.shared {
            true => 0,
            false => self.entry.parameters.len(),
        };
        let item = |(i, word): (usize, &(&'static str, String))| {
            let mut item = self.clone();
            item.each = Vec::new();
            item.place.push(word.clone());
            let position = |key: &str| self.entry.places.iter().position(|c| c.key == key);
            item.place.sort_by_key(|(key, _)| position(key));
            (item, i * own)
        };
        self.each.iter().enumerate().map(item).collect()
    }

    /// How many sets of values it has.
    pub(crate) fn sets(&self) -> usize {
        match self.shared {
            true => 1,
            false => self.each.len().max(1),
        }
    }

    /// Usual values of the parameters, those of one item after those of another.
    pub(crate) fn usual(&self) -> Vec<f64> {
        let of_item = self.entry.parameters.iter().map(|p| p.start);
        of_item.collect::<Vec<f64>>().repeat(self.sets())
    }

    /// Values with next to nothing of its amplitudes.
    pub(crate) fn faint(&self, values: &[f64]) -> Vec<f64> {
        let parameters = self.entry.parameters.iter().cycle();
        let faint = |(value, parameter): (&f64, &Parameter)| match parameter.absent {
            Some(absent) => {
                let [low, high] = parameter.bounds;
                (absent + FAINT * (value - absent)).clamp(low.min(absent), high)
            }
            None => *value,
        };
        values.iter().zip(parameters).map(faint).collect()
    }

    /// Whether the machine does not have it yet.
    fn is_new(&self, problem: &Problem) -> bool {
        if !self.each.is_empty() {
            return self.items().iter().all(|(item, _)| item.is_new(problem));
        }
        let there = problem.tree.get("effects").and_then(Value::as_array);
        !there.into_iter().flatten().any(|item| {
            item.get(self.entry.name).is_some_and(|section| {
                let same = |(key, word): &(&str, String)| section[*key] == word.as_str();
                let index = |i: usize| self.entry.parameters[i].key;
                let fixed = |(i, value): &(usize, f64)| section[index(*i)].as_f64() == Some(*value);
                let sensor = self.place.iter().find(|(key, _)| *key == MEASURE);
                let sensor = section[MEASURE].as_str() == sensor.map(|(_, word)| word.as_str());
                sensor && self.place.iter().all(same) && self.fixed.iter().all(fixed)
            })
        })
    }

    /// The problem with the effect in the machine and its parameters free. Their coordinates are 0 at `values`: SI, one
    /// per parameter of the catalogue's entry, in its order, those of one item after those of another.
    ///
    /// # Errors
    /// A machine that cannot have it.
    pub fn added(&self, problem: &Problem, values: &[f64]) -> Result<Problem, Error> {
        let own = problem.parameters.len();
        let mut added = problem.clone();
        for (item, first) in self.items() {
            let before = added.parameters.len();
            added = item.item_added(&added, &values[first..])?;
            if self.shared && before > own {
                let again = added.parameters.split_off(before);
                for (first, again) in added.parameters[own..].iter_mut().zip(again) {
                    first.places.extend(again.places);
                }
            }
        }
        Ok(added)
    }

    /// The same for one item.
    fn item_added(&self, problem: &Problem, values: &[f64]) -> Result<Problem, Error> {
        let mut values = values[..self.entry.parameters.len()].to_vec();
        for (index, value) in &self.fixed {
            values[*index] = *value;
        }
        let place: Vec<(&str, &str)> = self.place.iter().map(|(k, w)| (*k, w.as_str())).collect();
        let mut added = problem.clone();
        let effects = &mut added.tree["effects"];
        if !effects.is_array() {
            *effects = Value::Array(Vec::new());
        }
        let items = effects.as_array_mut().ok_or(Error::Effects)?;
        let index = items.len();
        let mut item = self.entry.item(&place, &values);
        // Terms that are left out have no effect, and constants and forms are as usual.
        let is_law = self.entry.proposal == Proposal::ForceLaw;
        let is_usual = |(i, parameter): (usize, &Parameter)| {
            let is_fixed = self.fixed.iter().any(|(fixed, _)| *fixed == i);
            let form = parameter.shape && values[i] == parameter.start && !self.is_free(i);
            (form || (is_law && is_fixed && !parameter.whole)).then_some(parameter.key)
        };
        let usual: Vec<&str> = self
            .entry
            .parameters
            .iter()
            .enumerate()
            .filter_map(is_usual)
            .collect();
        if let Some(section) = item[self.entry.name].as_object_mut() {
            section.retain(|key, _| !usual.contains(&key.as_str()));
        }
        items.push(item);
        MachineFile::from_tree(&added.tree)?.resolve()?;
        for (i, parameter) in self.entry.parameters.iter().enumerate() {
            if !self.is_free(i) {
                continue;
            }
            let path = format!("effects.{index}.{}.{}", self.entry.name, parameter.key);
            let value = values[i];
            let bounds = match parameter.cyclic {
                // A turn to either side: it has no ends.
                true => [value - TAU, value + TAU],
                false => [
                    parameter.bounds[0].min(value),
                    parameter.bounds[1].max(value),
                ],
            };
            added
                .parameters
                .push(calibrate::Parameter::within(&added.tree, &path, bounds)?);
        }
        Ok(added)
    }

    /// Its parameters in a model in which its first item is the effect of this index, SI.
    pub(crate) fn values(&self, model: &Model, index: usize) -> Vec<f64> {
        let items = self.items().into_iter().enumerate().take(self.sets());
        let values = items.flat_map(|(i, (item, _))| item.item_values(model, index + i));
        values.collect()
    }

    fn item_values(&self, model: &Model, index: usize) -> Vec<f64> {
        let of = |(i, parameter): (usize, &Parameter)| {
            let path = format!("effects.{index}.{}.{}", self.entry.name, parameter.key);
            let mut fitted = model.problem.parameters.iter().zip(&model.x);
            let fitted = fitted.find(|(p, _)| p.path == path);
            let fixed = self.fixed.iter().find(|(fixed, _)| *fixed == i);
            match (fixed, fitted) {
                (Some((_, value)), _) => *value,
                (None, Some((fitted, x))) => fitted.value(*x),
                (None, None) => written(&model.problem.tree, &path).unwrap_or(parameter.start),
            }
        };
        self.entry.parameters.iter().enumerate().map(of).collect()
    }
}

/// Whether it is a term of a Fourier series of the gas. In one recording of one chamber such a term fits
/// anything while a valve is open, and says nothing.
fn is_series(entry: &Entry) -> bool {
    entry.kind == Kind::Gas && entry.parameters.iter().any(|p| p.whole)
}

/// The parameter that an effect of the machine at the same place includes already, at the value where it vanishes.
fn included(
    entry: &Entry,
    place: &[(&'static str, String)],
    problem: &Problem,
) -> Option<(usize, f64)> {
    let of_holder = |holder: &'static Entry| {
        let mut included = holder.includes().iter();
        let (_, key) = included.find(|(name, _)| *name == entry.name)?;
        Some((holder.name, *key))
    };
    let (holder, key) = CATALOGUE.iter().find_map(of_holder)?;
    let index = entry.parameters.iter().position(|p| p.key == key)?;
    let absent = entry.parameters[index].absent?;
    let effects = problem.tree.get("effects").and_then(Value::as_array);
    let held = effects
        .into_iter()
        .flatten()
        .filter_map(|item| item.get(holder));
    let mut ends: Vec<&str> = held
        .map(|section| section[EITHER].as_str().unwrap_or(""))
        .collect();
    ends.sort_unstable();
    let asked = place.iter().find(|(key, _)| *key == EITHER);
    let asked = asked.map_or("", |(_, end)| end.as_str());
    let everywhere = ends.contains(&"") || ends == ["crank", "head"];
    (everywhere || (!asked.is_empty() && ends.contains(&asked))).then_some((index, absent))
}

/// The value at a path of a machine file, SI; none where there is none.
fn written(tree: &Value, path: &str) -> Option<f64> {
    match input::paths::get(tree, path).ok()?? {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => input::unit::parse_clearance(text)
            .ok()
            .map(|measure| measure.si),
        _ => None,
    }
}

/// The orders that an effect may have: whole numbers are tried one by one.
fn orders(entry: &Entry) -> Vec<Vec<(usize, f64)>> {
    let whole = entry.parameters.iter().position(|p| p.whole);
    let Some(index) = whole else {
        return vec![Vec::new()];
    };
    let [low, high] = entry.parameters[index].bounds.map(|x| x as u32);
    (low..=high).map(|k| vec![(index, f64::from(k))]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use serde_json::json;

    #[test]
    fn what_acts_at_every_throw_has_one_set_of_values() {
        let mut problem = problem();
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../data/machines/two-stage.yaml"
        );
        let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
        problem.tree = file.to_tree().clone();
        problem.parameters.clear();
        let throws = throws(&problem.tree);
        let all = Candidate::all(&problem);
        let mut friction = all.iter().filter(|c| c.entry.name == "ring_friction");
        let places: Vec<Vec<String>> = friction.clone().map(Candidate::places).collect();
        let alone = throws.iter().map(|throw| vec![throw.clone()]);
        let expected: Vec<Vec<String>> = alone.chain([throws.clone()]).collect();
        assert_eq!(places, expected);
        let every = friction.next_back().unwrap();
        let added = every.added(&problem, &every.usual()).unwrap();
        assert_eq!((every.items().len(), added.parameters.len()), (2, 4));
        assert!(added.parameters.iter().all(|p| p.places.len() == 2));
    }

    #[test]
    fn pressures_tell_the_gas_at_the_ends_where_they_were_recorded() {
        let mut problem = problem();
        problem.tree["cylinder"]["crank_end"] =
            json!({"rod_radius": "15 mm", "clearance": "30 mm"});
        let losses = |problem: &Problem| {
            let mut all = Candidate::all(problem);
            all.retain(|c| c.entry.name == "valve_loss");
            all
        };
        let shown = |problem: &Problem| -> Vec<bool> {
            let of = |c: &Candidate| c.is_shown_by_pressures(problem);
            losses(problem).iter().map(of).collect()
        };
        // Everywhere, at the head end, at the crank end.
        assert_eq!(shown(&problem), [false; 3]);
        assert!(losses(&problem)[0].at_recorded_end(&problem).is_none());
        for run in &mut problem.runs {
            let mut pressure = run.channels[0].clone();
            pressure.column = "cylinder_pressure_pa".into();
            run.channels.push(pressure);
        }
        assert_eq!(shown(&problem), [true, true, false]);
        let alone = losses(&problem)[0].at_recorded_end(&problem).unwrap();
        assert_eq!(alone.end(), Some("head"));
        assert!(alone.at_recorded_end(&problem).is_none());
        // Pressures of one end alone do not distinguish it from the other.
        for run in &mut problem.runs {
            run.channels.remove(0);
        }
        assert_eq!(shown(&problem), [true]);
    }
}
