//! The catalogue of effects as data: what a program that looks for a missing effect needs to know.

use crate::amount::Amount;
use crate::unit::Dimension;
use serde_json::{Map, Value, json};

/// An effect.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

/// The part of the machine that an effect acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The gas of a cylinder, so that the pressure there shows it.
    Gas,
    /// A joint: its clearance, its shape, its oil.
    Joint,
    /// Crank, rod or crosshead.
    RunningGear,
    /// The frame.
    Frame,
    /// A sensor or the encoder: the machine itself is as it was.
    Sensor,
}

/// How a program that looks for a missing effect proposes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proposal {
    /// At each place that the machine has, with one set of values.
    PerPlace,
    /// The same, but where both ends of a cylinder have it, each end has values of its own: it is a
    /// fault of one valve.
    PerEnd,
    /// By a search of its own: for a frequency that is no order, or for a law without a name.
    Separately,
}

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
    /// True for an angle whose bounds are a whole turn, or half a one, apart: it has no ends.
    pub cyclic: bool,
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

/// The entry called `name`.
pub fn entry(name: &str) -> Option<&'static Entry> {
    super::CATALOGUE.iter().find(|entry| entry.name == name)
}

/// The parameter that a path of the machine file leads to: `effects.valve_loss.discharge`,
/// `effects.2.squeeze_film.viscosity`.
pub fn at_path(path: &str) -> Option<&'static Parameter> {
    let (rest, key) = path.strip_prefix("effects.")?.rsplit_once('.')?;
    let name = rest.rsplit('.').next()?;
    entry(name)?.parameter(key)
}
