//! How the relations between clearances compare, and which of them the recordings leave.

use crate::bounded::Bounded;
use crate::relation::Relation;
use crate::transfer::{Decision, Hypothesis};
use scalar::elementary::exp;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// How the relations between clearances compare.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Relations {
    /// What the recordings say about them.
    pub decision: Decision,
    /// Each held against the recordings.
    pub compared: Vec<Hypothesis>,
}

impl Relations {
    /// The relations that the recordings leave; none where they have no say.
    fn left(&self) -> Option<impl Iterator<Item = &Hypothesis>> {
        let left = &self.decision.relations;
        let compared = self.compared.iter();
        (!left.is_empty()).then(|| compared.filter(|c| left.contains(&c.relation)))
    }
}

/// The relations that a comparison does not exclude, as a machine file has them. Each has its weight by
/// Schwarz's criterion, up to a common factor. Where the recordings do not decide, these are all named relations
/// with equal weights.
pub fn not_excluded(relations: Option<&Relations>) -> Vec<(Value, f64)> {
    let Some(left) = relations.and_then(Relations::left) else {
        return named().map(|relation| (relation, 1.0)).collect();
    };
    left.map(|found| {
        let above = found.criterion.unwrap_or(0.0);
        (with(found, |_, bounded| bounded.value), exp(-0.5 * above))
    })
    .collect()
}

/// The same without weights, for bounds: fitted exponents stand there with each of them at either end
/// of its interval, too.
pub fn bounds_of_not_excluded(relations: Option<&Relations>) -> Vec<Value> {
    let Some(left) = relations.and_then(Relations::left) else {
        return named().collect();
    };
    left.flat_map(|found| {
        let ends: [fn(&Bounded) -> f64; 2] = [|b| b.low, |b| b.high];
        let moved = found.exponents.keys().flat_map(move |moved| {
            ends.map(|end| {
                with(found, |path, bounded| match path == moved {
                    true => end(bounded),
                    false => bounded.value,
                })
            })
        });
        std::iter::once(with(found, |_, bounded| bounded.value)).chain(moved)
    })
    .collect()
}

/// The relations that have a name in a machine file.
fn named() -> impl Iterator<Item = Value> {
    let named = Relation::ALL.iter().filter(|r| **r != Relation::Fitted);
    named.map(|relation| relation.name().into())
}

/// A relation as a machine file has it: its name, or its exponents with these values.
fn with(found: &Hypothesis, value: impl Fn(&str, &Bounded) -> f64) -> Value {
    let exponents = found.exponents.iter().map(|(path, bounded)| {
        let key = path.rsplit('.').next().unwrap_or(path);
        (key.to_owned(), value(path, bounded).into())
    });
    let exponents: Map<String, Value> = exponents.collect();
    match exponents.is_empty() {
        true => found.relation.name().into(),
        false => exponents.into(),
    }
}
