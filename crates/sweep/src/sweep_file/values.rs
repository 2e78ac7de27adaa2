//! The values that an axis goes through, and those that are drawn.

use super::Weight;
pub use input::amount::Amount;
use input::choice::Count;
use input::quantity::{FromOne, Number};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// The values of an axis: one, a list, or a range.
pub type Levels = Values<Range>;

/// A value that is drawn: always the same, one of a list (each equally likely), or a distribution.
pub type Draw = Values<Spread>;

/// One value, a list, or a section `S` with a rule.
#[derive(Clone, Debug)]
pub enum Values<S> {
    /// One value.
    One(Value),
    /// Several.
    List(Vec<Value>),
    /// Given by a rule.
    Rule(S),
}

/// Values at equal steps.
#[derive(Clone, Copy, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// First value.
    pub from: Amount,
    /// Last value.
    pub to: Amount,
    /// Number of values.
    pub count: Count<2, 1_000_000>,
    /// Equal differences or equal ratios.
    #[serde(default)]
    pub spacing: Spacing,
}

/// What is equal between neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// The difference.
    #[default]
    Linear,
    /// The ratio.
    Log,
}

/// A distribution.
#[derive(Clone, Debug, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Spread {
    /// Every value between two equally likely.
    Uniform([Amount; 2]),
    /// Every ratio between two equally likely.
    LogUniform([Amount; 2]),
    /// Gauss's.
    Normal(Normal),
    /// The logarithm is normal.
    Lognormal(Lognormal),
    /// One of several.
    Choice(Choice),
}

/// A normal distribution.
#[derive(Clone, Copy, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean; default the machine file's value.
    #[serde(default)]
    pub mean: Option<Amount>,
    /// Standard deviation.
    pub deviation: Amount,
    /// Least and greatest value; a draw beyond gets the nearer of them.
    #[serde(default)]
    pub range: Option<[Amount; 2]>,
}

/// A lognormal distribution.
#[derive(Clone, Copy, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lognormal {
    /// Median; default the machine file's value.
    #[serde(default)]
    pub median: Option<Amount>,
    /// 68 % of the values lie between median / factor and median × factor.
    pub factor: Number<FromOne>,
    /// Least and greatest value; a draw beyond gets the nearer of them.
    #[serde(default)]
    pub range: Option<[Amount; 2]>,
}

/// One of several values.
#[derive(Clone, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    /// The values.
    pub values: Vec<Value>,
    /// How likely each is, up to a common factor.
    pub weights: Vec<Weight>,
}

impl<'de, S: Deserialize<'de>> Deserialize<'de> for Values<S> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any<S>(PhantomData<S>);
        impl<'de, S: Deserialize<'de>> Visitor<'de> for Any<S> {
            type Value = Values<S>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value, a list of values or a section")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Ok(Values::One(text.into()))
            }
            fn visit_bool<E: Error>(self, value: bool) -> Result<Self::Value, E> {
                Ok(Values::One(value.into()))
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
                Ok(Values::One(value.into()))
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
                Ok(Values::One(value.into()))
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
                Ok(Values::One(value.into()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Values::List)
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let rule = S::deserialize(MapAccessDeserializer::new(&mut map))?;
                match map.next_key::<String>()? {
                    None => Ok(Values::Rule(rule)),
                    Some(second) => {
                        let problem = format!("'{second}' is one rule too many: give one alone");
                        Err(A::Error::custom(problem))
                    }
                }
            }
        }
        deserializer.deserialize_any(Any(PhantomData))
    }
}

impl<S: JsonSchema> JsonSchema for Values<S> {
    fn schema_name() -> Cow<'static, str> {
        format!("ValuesOr{}", S::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let rule = generator.subschema_for::<S>();
        json_schema!({
            "anyOf": [{"type": ["string", "number", "boolean"]}, {"type": "array"}, rule]
        })
    }
}
