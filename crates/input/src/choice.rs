//! Values that may be written in two ways.

use crate::error::quoted;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{
    BorrowedStrDeserializer, F64Deserializer, I64Deserializer, MapAccessDeserializer,
    SeqAccessDeserializer, StrDeserializer, U64Deserializer,
};
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess,
};
use serde::de::{Unexpected, Visitor};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// A scalar `A`, or a section or list `B`.
#[derive(Clone, Debug, PartialEq)]
pub enum Or<A, B> {
    /// Text or a number.
    Scalar(A),
    /// A section or a list.
    Section(B),
}

impl<'de, A: Deserialize<'de>, B: Deserialize<'de>> Deserialize<'de> for Or<A, B> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<A, B>(PhantomData<(A, B)>);
        impl<'de, A: Deserialize<'de>, B: Deserialize<'de>> Visitor<'de> for Either<A, B> {
            type Value = Or<A, B>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value or a section")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                let text: StrDeserializer<E> = text.into_deserializer();
                A::deserialize(text).map(Or::Scalar)
            }
            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Self::Value, E> {
                A::deserialize(BorrowedStrDeserializer::new(text)).map(Or::Scalar)
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
                A::deserialize(U64Deserializer::new(value)).map(Or::Scalar)
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
                A::deserialize(I64Deserializer::new(value)).map(Or::Scalar)
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
                A::deserialize(F64Deserializer::new(value)).map(Or::Scalar)
            }
            fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Self::Value, M::Error> {
                B::deserialize(MapAccessDeserializer::new(map)).map(Or::Section)
            }
            fn visit_seq<S: SeqAccess<'de>>(self, seq: S) -> Result<Self::Value, S::Error> {
                B::deserialize(SeqAccessDeserializer::new(seq)).map(Or::Section)
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

impl<A: JsonSchema, B: JsonSchema> JsonSchema for Or<A, B> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{}Or{}", A::schema_name(), B::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [generator.subschema_for::<A>(), generator.subschema_for::<B>()]
        })
    }
}

/// One value for both bodies of a contact, or a list of two.
pub type Pair<T> = Or<T, [T; 2]>;

impl<T: Copy> Pair<T> {
    /// The values of the two bodies.
    pub fn both(&self) -> [T; 2] {
        match self {
            Or::Scalar(same) => [*same; 2],
            Or::Section(both) => *both,
        }
    }
}

/// The word `ideal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ideal;

impl<'de> Deserialize<'de> for Ideal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Word;
        impl Visitor<'_> for Word {
            type Value = Ideal;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("'ideal' or a section")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Ideal, E> {
                match text {
                    "ideal" => Ok(Ideal),
                    other => {
                        let found = quoted(other);
                        Err(E::invalid_value(Unexpected::Other(&found), &self))
                    }
                }
            }
        }
        deserializer.deserialize_str(Word)
    }
}

impl JsonSchema for Ideal {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Ideal".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"const": "ideal"})
    }
}

/// A whole number from `LOW` to `HIGH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count<const LOW: u32, const HIGH: u32>(u32);

impl<const LOW: u32, const HIGH: u32> Count<LOW, HIGH> {
    /// The number; none where it is out of range.
    pub fn new(number: u32) -> Option<Self> {
        (LOW..=HIGH).contains(&number).then_some(Self(number))
    }

    /// The number.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl<'de, const LOW: u32, const HIGH: u32> Deserialize<'de> for Count<LOW, HIGH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (low, high) = (LOW, HIGH);
        WholeNumber { low, high }
            .deserialize(deserializer)
            .map(Self)
    }
}

/// Reads a whole number from `low` to `high`.
#[derive(Clone, Copy)]
pub(crate) struct WholeNumber {
    pub low: u32,
    pub high: u32,
}

impl<'de> DeserializeSeed<'de> for WholeNumber {
    type Value = u32;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<u32, D::Error> {
        deserializer.deserialize_u32(self)
    }
}

impl Visitor<'_> for WholeNumber {
    type Value = u32;
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a whole number from {} to {}", self.low, self.high)
    }
    fn visit_u64<E: Error>(self, value: u64) -> Result<u32, E> {
        let number = u32::try_from(value).ok();
        let number = number.filter(|n| (self.low..=self.high).contains(n));
        number.ok_or_else(|| E::invalid_value(Unexpected::Unsigned(value), &self))
    }
    // `4.0` and `1e3` are whole numbers.
    fn visit_f64<E: Error>(self, value: f64) -> Result<u32, E> {
        match value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
            true => self.visit_u64(value as u64),
            false => Err(E::invalid_value(Unexpected::Float(value), &self)),
        }
    }
}

impl WholeNumber {
    /// Its schema.
    pub(crate) fn schema(self) -> Schema {
        let Self { low, high } = self;
        json_schema!({"type": "integer", "minimum": low, "maximum": high})
    }
}

impl<const LOW: u32, const HIGH: u32> JsonSchema for Count<LOW, HIGH> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Count{LOW}To{HIGH}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let (low, high) = (LOW, HIGH);
        WholeNumber { low, high }.schema()
    }
}
