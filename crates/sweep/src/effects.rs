//! The effects that a sweep varies: each is a label, like a worn joint, with its amplitudes as
//! columns.
//!
//! An effect of the machine file with constant amplitudes is part of the machine. So is an effect
//! that every case has and whose size `vary` draws as an unknown. Any other effect whose amplitudes
//! differ among the cases is a label. A case has it where one of its amplitudes is not the one at
//! which the effect vanishes.

use std::collections::BTreeMap;

use input::effects::{Choice, Entry, Parameter, entry};
use mechanism::declaration::Kind;
use serde_json::{Map, Value};

use crate::fault_words::Fault;
use crate::sweep_file::Amount;

/// An effect of the machine file that a sweep varies.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedEffect {
    /// Its label: `ring_leakage`; with the throw before it where it names one: `throw1.ring_leakage`.
    pub label: String,
    /// Its amplitudes, without those at which it vanishes throughout.
    pub amplitudes: Vec<Amplitude>,
    id: Id,
}

/// How large an effect is.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude {
    /// Its path in the machine file, by the name of the effect.
    pub path: String,
    /// What it means.
    pub parameter: &'static Parameter,
    /// Its place among the effect's amplitudes.
    position: usize,
}

/// Distinguishes an effect from the others of a file: its name, its place, and its order where it has
/// one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Id {
    name: &'static str,
    /// Words of its place, and its order.
    place: Vec<String>,
    throw: Option<String>,
    /// Words of its place but for the throw.
    part: Vec<String>,
}

impl Id {
    /// The path of its parameter `key`, with the effect's place.
    fn path(&self, key: &str) -> String {
        let place = self.place.iter().map(String::as_str);
        let parts: Vec<&str> = ["effects", self.name]
            .into_iter()
            .chain(place)
            .chain([key])
            .collect();
        parts.join(".")
    }
}

/// The amplitudes of every effect of a machine file, SI, in the order of the catalogue.
type Amplitudes = BTreeMap<Id, Vec<f64>>;

impl VariedEffect {
    /// Whether the machine file `tree` has it.
    pub(crate) fn is_in(&self, tree: &Value) -> bool {
        size(&amplitudes(tree), &self.id) != absent(self.id.name)
    }

    /// The fault that it is in the machine file `tree`.
    pub(crate) fn fault(&self, tree: &Value) -> Fault {
        let Id {
            name, throw, part, ..
        } = &self.id;
        let kind = entry(name).map_or(Kind::Sensor, |entry| entry.kind);
        let sizes = size(&amplitudes(tree), &self.id).into_iter();
        let absent = absent(name);
        let sizes = sizes
            .zip(&absent)
            .map(|(size, absent)| (size - absent).abs());
        Fault::of_effect(name, kind, throw.as_deref(), part, sizes)
    }

    /// The value of one of its amplitudes in the machine file `tree`, SI: the one at which the
    /// effect vanishes where the file does not have it.
    pub(crate) fn value(&self, amplitude: &Amplitude, tree: &Value) -> f64 {
        size(&amplitudes(tree), &self.id)[amplitude.position]
    }

    /// One of its amplitudes with the place of the effect in its path.
    pub(crate) fn at_its_place(&self, amplitude: &Amplitude) -> Amplitude {
        Amplitude {
            path: self.id.path(amplitude.parameter.key),
            ..amplitude.clone()
        }
    }

    /// Where the machine file `tree` has it in its list, if it does.
    pub(crate) fn index_in(&self, tree: &Value) -> Option<usize> {
        items(tree).position(|item| item.is_some_and(|(id, _)| id == self.id))
    }

    /// The joint that it acts on, where it names one.
    pub(crate) fn joint(&self) -> Option<&str> {
        let names = entry(self.id.name)?.places.iter();
        let of_joint = |choice: &&Choice| choice.key == "joint";
        let is_named = names.filter(of_joint).count() > 0;
        self.id
            .part
            .first()
            .filter(|_| is_named)
            .map(String::as_str)
    }

    /// Whether `joint`, as labels call it, is one that it acts on.
    pub(crate) fn is_at(&self, joint: &str) -> bool {
        let (throw, own) = joint.rsplit_once('.').unwrap_or(("", joint));
        let is_of_throw = self.id.throw.as_deref().is_none_or(|own| own == throw);
        self.joint() == Some(own) && (is_of_throw || own == "main")
    }

    /// Its name in the machine file.
    pub(crate) fn name(&self) -> &'static str {
        self.id.name
    }
}

/// The effects that differ among machine files, in the order of their names.
///
/// `chosen` are files that differ in what the sweep's cases set, `drawn` those that differ in what
/// it draws as unknown; `own` is the sweep's machine file.
pub(crate) fn varied(chosen: &[Value], drawn: &[Value], own: &Value) -> Vec<VariedEffect> {
    let [chosen, drawn] = [chosen, drawn].map(|trees| trees.iter().map(amplitudes).collect());
    let (chosen, drawn): (Vec<Amplitudes>, Vec<Amplitudes>) = (chosen, drawn);
    let own = amplitudes(own);
    let all = || chosen.iter().chain(&drawn);
    let mut ids: Vec<Id> = all().flat_map(|file| file.keys().cloned()).collect();
    ids.sort();
    ids.dedup();
    let differs = |files: &[Amplitudes], id: &Id| {
        let mut sizes = files.iter().map(|file| size(file, id));
        sizes
            .next()
            .is_some_and(|first| sizes.any(|other| other != first))
    };
    let is_missing = |id: &Id| {
        let mut files = all().chain([&own]);
        files.any(|file| size(file, id) == absent(id.name))
    };
    let is_label = |id: &Id| differs(&chosen, id) || (differs(&drawn, id) && is_missing(id));
    let labelled: Vec<Id> = ids.into_iter().filter(is_label).collect();
    let effects = labelled.iter().filter_map(|id| {
        let namesakes = labelled.iter().filter(|other| other.name == id.name);
        let mut amplitudes = of_catalogue(entry(id.name)?, id, namesakes.count() > 1);
        let absent = absent(id.name);
        let is_used = |position: usize| {
            let mut files = all();
            files.any(|file| size(file, id)[position] != absent[position])
        };
        amplitudes.retain(|amplitude| is_used(amplitude.position));
        Some(VariedEffect {
            label: match &id.throw {
                Some(throw) => format!("{throw}.{}", id.name),
                None => id.name.to_owned(),
            },
            amplitudes,
            id: id.clone(),
        })
    });
    effects.collect()
}

/// The amplitudes of an effect; among several of one name the paths have its place in them.
fn of_catalogue(entry: &'static Entry, id: &Id, is_one_of_several: bool) -> Vec<Amplitude> {
    let amplitudes = entry.amplitudes().enumerate();
    let amplitudes = amplitudes.map(|(position, parameter)| Amplitude {
        path: match is_one_of_several {
            true => id.path(parameter.key),
            false => format!("effects.{}.{}", entry.name, parameter.key),
        },
        parameter,
        position,
    });
    amplitudes.collect()
}

/// A machine file with the effects that these paths name, as `effects.ring_leakage.area`: those that it lacks are put at the
/// end of its list, without amplitude. An effect that has to name its place is not.
pub(crate) fn completed<'a>(tree: &Value, paths: impl Iterator<Item = &'a str>) -> Value {
    let mut tree = tree.clone();
    for path in paths {
        let mut parts = path.split('.');
        let (Some("effects"), Some(name), Some(_)) = (parts.next(), parts.next(), parts.next())
        else {
            continue;
        };
        let is_there = items(&tree).flatten().any(|(id, _)| id.name == name);
        let entry = entry(name).filter(|entry| !entry.places.iter().any(|place| place.required));
        if let Some(entry) = entry.filter(|_| !is_there) {
            let none: Map<String, Value> = entry
                .amplitudes()
                .filter_map(|p| Some((p.key.to_owned(), p.value(p.absent?))))
                .collect();
            let item = Map::from_iter([(name.to_owned(), Value::Object(none))]);
            match &mut tree["effects"] {
                Value::Array(list) => list.push(Value::Object(item)),
                other => *other = Value::Array(vec![Value::Object(item)]),
            }
        }
    }
    tree
}

/// Makes the effects at these positions of a machine file's list vanish.
pub(crate) fn vanish(tree: &mut Value, positions: &[usize]) {
    for position in positions {
        let item = tree["effects"][position].as_object_mut();
        let Some((name, section)) = item.and_then(|item| item.iter_mut().next()) else {
            continue;
        };
        for parameter in entry(name).into_iter().flat_map(Entry::amplitudes) {
            let stated = section.get_mut(parameter.key);
            if let (Some(value), Some(absent)) = (stated, parameter.absent) {
                *value = parameter.value(absent);
            }
        }
    }
}

/// The amplitudes of `id` in a file; where it vanishes if the file does not have it.
fn size(file: &Amplitudes, id: &Id) -> Vec<f64> {
    let size = file.get(id).cloned();
    size.unwrap_or_else(|| absent(id.name))
}

/// The amplitudes at which an effect vanishes.
fn absent(name: &str) -> Vec<f64> {
    let amplitudes = entry(name)
        .into_iter()
        .flat_map(Entry::amplitudes)
        .filter_map(|parameter| parameter.absent);
    amplitudes.collect()
}

fn amplitudes(tree: &Value) -> Amplitudes {
    items(tree).flatten().collect()
}

/// The effects of a machine file in the order of its list; none for what is no effect, which
/// reading the file tells.
fn items(tree: &Value) -> impl Iterator<Item = Option<(Id, Vec<f64>)>> {
    tree["effects"].as_array().into_iter().flatten().map(item)
}

fn item(item: &Value) -> Option<(Id, Vec<f64>)> {
    let (name, section) = item.as_object()?.iter().next()?;
    let entry = entry(name)?;
    let word = |key| section.get(key).and_then(Value::as_str).map(str::to_owned);
    let words = entry.places.iter().filter_map(|choice| word(choice.key));
    let parts = entry.places.iter().filter(|choice| choice.key != "throw");
    // The crank end of a cylinder is not the crank.
    let part = |key| match key {
        "end" => word(key).map(|end| format!("{end}_end")),
        key => word(key),
    };
    let orders = entry.parameters.iter().filter(|parameter| parameter.whole);
    let orders = orders.filter_map(|parameter| section.get(parameter.key).map(Value::to_string));
    let value = |parameter: &Parameter| {
        let amount = section.get(parameter.key).and_then(Amount::from_value);
        amount.map_or(parameter.absent.unwrap_or(0.0), |amount| amount.si)
    };
    let id = Id {
        name: entry.name,
        place: words.chain(orders).collect(),
        throw: word("throw"),
        part: parts.filter_map(|choice| part(choice.key)).collect(),
    };
    Some((id, entry.amplitudes().map(value).collect()))
}
