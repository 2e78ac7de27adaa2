//! The catalogue of effects as data: what a program that looks for a missing effect needs to know.

use super::act::{Act, Place};
use crate::amount::Amount;
use crate::machine_file::value;
use crate::unit::Dimension;
use mechanism::declaration::{self, Declaration, Kind, PlaceKey, Proposal, Range};
use mechanism::effects::{Alternatives, Law};
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

/// An effect.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name in the machine file.
    pub name: &'static str,
    /// What it is, in a sentence that a mechanic understands.
    pub sentence: &'static str,
    /// On what part of the machine it acts.
    pub kind: Kind,
    /// How a program that looks for a missing effect proposes it.
    pub proposal: Proposal,
    /// Its parameters, in the order of its section.
    pub parameters: &'static [Parameter],
    /// Where it can act.
    pub places: &'static [Choice],
    /// All keys of its section.
    pub(super) keys: &'static [&'static str],
    declaration: Declaration,
    make: Make,
}

/// Two entries are the same if their names are.
impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// How an effect is made of the values of its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) enum Make {
    /// It acts in the equations.
    Law(fn(&[f64], Alternatives) -> Law),
    /// It changes the file, the machine or its sensors.
    Own(fn(&[f64]) -> Box<dyn Act>),
}

/// All effects.
pub static CATALOGUE: LazyLock<Vec<Entry>> =
    LazyLock::new(|| {
        let mut all = Vec::new();
        for law in mechanism::effects::CATALOGUE {
            all.push(Entry::new(law.name, law.declaration, Make::Law(law.law)));
            let own = super::OWN.iter().filter(|(after, ..)| *after == law.name);
            all.extend(own.map(|(_, name, declaration, make)| {
                Entry::new(name, *declaration, Make::Own(*make))
            }));
        }
        all
    });

/// A parameter of an effect. All values are SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key.
    pub key: &'static str,
    /// What it means.
    pub words: &'static str,
    /// Its dimension; none for a plain number.
    pub dimension: Option<Dimension>,
    /// Its SI unit; empty for a plain number.
    pub unit: &'static str,
    /// Between which values it is plausible.
    pub bounds: [f64; 2],
    /// A usual value where the effect is there.
    pub start: f64,
    /// The value at which the effect vanishes, if it is an amplitude: an effect is absent where all
    /// its amplitudes have theirs. A phase, a speed or an order has none.
    pub absent: Option<f64>,
    /// True where it takes whole numbers only.
    pub whole: bool,
    /// True for a crank angle after the dead centre of a chamber.
    pub on_the_stroke: bool,
    /// True for an angle whose bounds are a period of its law apart, a turn or a part of one: it has no ends.
    pub cyclic: bool,
    /// True where it is a form of the law and no size.
    pub shape: bool,
    /// The value of the form that is other than the usual one.
    pub other: f64,
}

/// A key that says where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The key.
    pub key: &'static str,
    /// What may stand there; none for the names of the machine's throws.
    pub words: &'static [&'static str],
    /// True where the key must be there. Where another is left out, the effect acts at every place
    /// (of `measure`, `body` and `part`: at the first).
    pub required: bool,
}

impl Parameter {
    fn new(declared: &declaration::Parameter) -> Self {
        let (dimension, unit) = value::unit(declared.declared());
        let [low, high] = declared.bounds;
        let end = if declared.start == low { high } else { low };
        Self {
            key: declared.key,
            words: declared.words,
            dimension,
            unit,
            bounds: declared.bounds,
            start: declared.start,
            absent: declared.absent,
            whole: matches!(declared.range, Range::Whole(..)),
            on_the_stroke: declared.range == Range::OnTheStroke,
            cyclic: declared.cyclic,
            shape: declared.shape,
            other: declared.other.unwrap_or(end),
        }
    }

    /// The value `si` as it stands in a machine file.
    pub fn value(&self, si: f64) -> Value {
        let dimension = self.dimension;
        match self.whole {
            #[expect(clippy::cast_possible_truncation, reason = "an order, say")]
            true => json!(si.round() as i64),
            false => Amount { si, dimension }.to_value(),
        }
    }
}

impl Entry {
    /// The entry of a declaration. Called once an effect: its lists live as long as the program.
    fn new(name: &'static str, declaration: Declaration, make: Make) -> Self {
        let parameters = declaration.parameters.iter().map(Parameter::new);
        let parameters: &[Parameter] = Vec::leak(parameters.collect());
        let places: &[Choice] =
            Vec::leak(declaration.places.iter().map(|key| choice(*key)).collect());
        let keys = parameters.iter().map(|parameter| parameter.key);
        let keys = keys.chain(places.iter().map(|choice| choice.key));
        Self {
            name,
            sentence: declaration.sentence,
            kind: declaration.kind,
            proposal: declaration.proposal,
            parameters,
            places,
            keys: Vec::leak(keys.collect()),
            declaration,
            make,
        }
    }

    /// What it is.
    pub fn about(&self) -> &'static str {
        self.declaration.about
    }

    /// Its equation, in short.
    pub fn law(&self) -> &'static str {
        self.declaration.law
    }

    /// Its source; empty for none.
    pub fn source(&self) -> &'static str {
        self.declaration.source
    }

    /// Parameters of other effects that this one has as well: the effect's name and the key.
    pub fn includes(&self) -> &'static [(&'static str, &'static str)] {
        self.declaration.includes
    }

    /// Name of its section in a schema.
    pub(super) fn type_name(&self) -> &'static str {
        self.declaration.type_name
    }

    /// Its parameters as they are declared.
    pub(super) fn declared(&self) -> &'static [declaration::Parameter] {
        self.declaration.parameters
    }

    /// The keys of its place as they are declared.
    pub(super) fn place_keys(&self) -> &'static [PlaceKey] {
        self.declaration.places
    }

    /// What it does with `values` (SI) of its parameters at `place`.
    pub(super) fn effect(&self, values: &[f64], place: &Place) -> Box<dyn Act> {
        match self.make {
            Make::Law(law) => Box::new(law(values, place.alternatives())),
            Make::Own(own) => own(values),
        }
    }

    /// The parameter whose key is `key`.
    pub fn parameter(&self, key: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| p.key == key)
    }

    /// Whether it acts on sensors that a key `measure` chooses.
    pub fn is_of_chosen_sensor(&self) -> bool {
        self.places.iter().any(|choice| choice.key == "measure")
    }

    /// The parameters whose values make the effect vanish.
    pub fn amplitudes(&self) -> impl Iterator<Item = &'static Parameter> {
        self.parameters.iter().filter(|p| p.absent.is_some())
    }

    /// The terms of its law that are waves, a cos(kα + φ): the indices of amplitude and phase, which follow one another.
    pub fn waves(&self) -> impl Iterator<Item = [usize; 2]> {
        let phases = (0..self.parameters.len()).filter(|i| self.parameters[*i].cyclic);
        phases.map(|phase| [phase - 1, phase])
    }

    /// The usual size of the wave whose amplitude has this index; that of the first one for a wave that the usual form of the
    /// law does not have.
    pub fn usual_wave(&self, amplitude: usize) -> f64 {
        let parameter = &self.parameters[amplitude];
        match (parameter.absent, self.amplitudes().next()) {
            (None, Some(first)) => first.start,
            _ => parameter.start,
        }
    }

    /// The item of a machine file's list of effects that puts this one at `place` (keys of
    /// [`places`](Self::places) and words) with `values` (SI) for its parameters, in their order.
    pub fn item(&self, place: &[(&str, &str)], values: &[f64]) -> Value {
        let mut section = Map::new();
        for (key, word) in place {
            section.insert((*key).to_owned(), json!(word));
        }
        for (parameter, value) in self.parameters.iter().zip(values) {
            section.insert(parameter.key.to_owned(), parameter.value(*value));
        }
        json!({self.name: section})
    }
}

/// A key of a place, and what may stand there.
pub(super) fn choice(key: PlaceKey) -> Choice {
    let (key, words, required): (_, &[&str], _) = match key {
        PlaceKey::Throw => ("throw", &[], false),
        PlaceKey::Joint => ("joint", &["main", "big_end", "small_end"], true),
        PlaceKey::End => ("end", &["head", "crank"], false),
        PlaceKey::Measure => (
            "measure",
            &[
                "crosshead_acceleration",
                "frame_acceleration",
                "cylinder_pressure",
            ],
            false,
        ),
        PlaceKey::Body => ("body", &["frame", "crosshead"], false),
        PlaceKey::Part => ("part", &["bearing", "journal"], false),
    };
    Choice {
        key,
        words,
        required,
    }
}

/// The entry called `name`.
pub fn entry(name: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}

/// The first entry that is proposed in this way.
pub fn proposed(by: Proposal) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.proposal == by)
}

/// The parameter that a path of the machine file leads to: `effects.valve_loss.discharge`,
/// `effects.2.squeeze_film.viscosity`.
pub fn at_path(path: &str) -> Option<&'static Parameter> {
    let (entry, index) = of_path(path)?;
    Some(&entry.parameters[index])
}

/// The same as the effect and the index among its parameters.
pub fn of_path(path: &str) -> Option<(&'static Entry, usize)> {
    let (rest, key) = path.strip_prefix("effects.")?.rsplit_once('.')?;
    let entry = entry(rest.rsplit('.').next()?)?;
    let index = entry.parameters.iter().position(|p| p.key == key)?;
    Some((entry, index))
}
