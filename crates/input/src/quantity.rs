//! Quantities as files have them: a text with a unit whose dimension and range the type fixes.

pub use crate::kind::{
    Acceleration, Angle, Area, Clearance, Compliance, Damping, Duration, Force, ForcePerPressure,
    Frequency, Inertia, Kind, Length, Mass, Pressure, Ratio, Speed, StiffnessPerRoot, Torque,
    TorqueSlope, Velocity, Viscosity,
};

use crate::dimension::Measure;
use crate::error::quoted;
use crate::kind::{KINDS, Reading};
use crate::unit::{self, Dimension, UnitError};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Error, Unexpected, Visitor};
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// The values that a quantity or a number may have.
pub trait Bound {
    /// Name that stands before the kind in a schema.
    const NAME: &'static str;
    /// How messages say it, with a space before it.
    const WORDS: &'static str;
    /// Whether `value` (SI) is one of them.
    fn holds(value: f64) -> bool;
    /// JSON Schema keywords for a plain number.
    fn keywords(schema: &mut Schema);
}

macro_rules! bounds {
    ($( $(#[$meta:meta])* $name:ident, $prefix:literal, $words:literal, $test:expr, {$($key:literal: $value:literal),*}; )*) => {
        $(
            $(#[$meta])*
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $name;

            impl Bound for $name {
                const NAME: &'static str = $prefix;
                const WORDS: &'static str = $words;
                fn holds(value: f64) -> bool {
                    let test: fn(f64) -> bool = $test;
                    test(value)
                }
                fn keywords(_schema: &mut Schema) {
                    $( _schema.insert($key.to_owned(), serde_json::json!($value)); )*
                }
            }
        )*
    };
}

bounds! {
    /// Every finite value.
    Any, "", "", |_| true, {};
    /// Values above 0.
    AboveZero, "Positive", " greater than 0", |x| x > 0.0, {"exclusiveMinimum": 0};
    /// Values from 0.
    FromZero, "NonNegative", " of at least 0", |x| x >= 0.0, {"minimum": 0};
    /// Values from 1.
    FromOne, "AtLeastOne", " of at least 1", |x| x >= 1.0, {"minimum": 1};
    /// A part of a whole: 0 to 1.
    Part, "Part", " from 0 to 100 %", |x| (0.0..=1.0).contains(&x), {"minimum": 0, "maximum": 1};
    /// A part of a whole that is not all of it: from 0, below 1.
    ProperPart, "ProperPart", " of at least 0, below 100 %", |x| (0.0..1.0).contains(&x), {"minimum": 0, "exclusiveMaximum": 1};
    /// A coefficient of restitution: above 0, to 1.
    Rebound, "Rebound", " greater than 0, up to 1", |x| x > 0.0 && x <= 1.0, {"exclusiveMinimum": 0, "maximum": 1};
    /// A Poisson's ratio: 0 to 0.5.
    Contraction, "Contraction", " from 0 to 0.5", |x| (0.0..=0.5).contains(&x), {"minimum": 0, "maximum": 0.5};
}

/// A value of kind `K` within the bound `B`. Files have it as text with its unit, never as a bare
/// number.
pub struct Quantity<K, B = Any> {
    si: f64,
    kind: PhantomData<fn() -> (K, B)>,
}

/// A quantity greater than 0.
pub type Positive<K> = Quantity<K, AboveZero>;
/// A quantity of at least 0.
pub type NonNegative<K> = Quantity<K, FromZero>;

impl<K: Kind, B: Bound> Quantity<K, B> {
    /// The quantity of `si` SI units; none where the bound forbids it or it is not finite.
    pub fn new(si: f64) -> Option<Self> {
        (si.is_finite() && B::holds(si)).then_some(Self {
            si,
            kind: PhantomData,
        })
    }

    /// The value, SI, of `text`, which something called `name` says.
    ///
    /// # Errors
    /// The name, what was found and what was expected.
    pub fn named(name: &str, text: &str) -> Result<f64, String> {
        let quantity = Self::parse(text).map_err(|found| {
            let expected = Self::expected();
            format!("{name}: found {found}, expected {expected}")
        })?;
        Ok(quantity.si())
    }

    /// The value in SI units.
    pub fn si(&self) -> f64 {
        self.si
    }

    /// What belongs in the file, with an example.
    pub fn expected() -> String {
        format!(
            "{}{} with its unit, e.g. '{}'",
            K::WORDS,
            B::WORDS,
            K::EXAMPLE
        )
    }

    /// Reads a text.
    ///
    /// # Errors
    /// The text, quoted, with the reason: it is no number with a unit, its unit has another dimension
    /// than the kind, or the bound forbids the value.
    pub fn parse(text: &str) -> Result<Self, String> {
        let measure = measure::<K>(text).map_err(|error| describe_error(text, &error))?;
        if measure.dimension != K::DIMENSION {
            return Err(format!("{} ({})", quoted(text), describe(&measure)));
        }
        Self::new(measure.si).ok_or_else(|| quoted(text))
    }
}

/// Reads a text where a quantity of kind `K` belongs.
pub(crate) fn measure<K: Kind>(text: &str) -> Result<Measure, UnitError> {
    match K::READING {
        Reading::Plain => unit::parse(text),
        Reading::Gravities => unit::parse_acceleration(text),
        Reading::Sided => unit::parse_clearance(text),
    }
}

/// `text` and what keeps it from being a quantity.
pub(crate) fn describe_error(text: &str, error: &UnitError) -> String {
    match error {
        UnitError::NoNumber => quoted(text),
        error => format!("{} ({error})", quoted(text)),
    }
}

/// What a measure of the wrong dimension is: `a mass`, or its unit.
pub(crate) fn describe(measure: &Measure) -> String {
    match KINDS.iter().find(|k| k.dimension == measure.dimension) {
        Some(kind) => kind.words.to_owned(),
        None => format!("in {}", measure.dimension),
    }
}

impl<K> NonNegative<K> {
    /// Nothing.
    pub const ZERO: Self = Self {
        si: 0.0,
        kind: PhantomData,
    };
}

impl<K, B> Clone for Quantity<K, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K, B> Copy for Quantity<K, B> {}

impl<K, B> PartialEq for Quantity<K, B> {
    fn eq(&self, other: &Self) -> bool {
        self.si == other.si
    }
}

impl<K: Kind, B> fmt::Debug for Quantity<K, B> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The shortest text in SI units that reads back as exactly this value.
impl<K: Kind, B> fmt::Display for Quantity<K, B> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let measure = Measure {
            si: self.si,
            dimension: K::DIMENSION,
        };
        measure.fmt(f)
    }
}

impl<K: Kind, B> Serialize for Quantity<K, B> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de, K: Kind, B: Bound> Deserialize<'de> for Quantity<K, B> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text<K, B>(PhantomData<(K, B)>);
        impl<K: Kind, B: Bound> Visitor<'_> for Text<K, B> {
            type Value = Quantity<K, B>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(&Quantity::<K, B>::expected())
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Quantity::parse(text)
                    .map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))
            }
        }
        deserializer.deserialize_str(Text(PhantomData))
    }
}

impl<K: Kind, B: Bound> JsonSchema for Quantity<K, B> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}{}", B::NAME, K::NAME).into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        text_schema(&Self::expected(), B::holds(-1.0), &[K::EXAMPLE])
    }
}

/// The text for a number of SI units of kind `K`, as files have it.
pub(crate) fn text<K: Kind>(si: Number<impl Bound>) -> Value {
    let measure = Measure {
        si: si.get(),
        dimension: K::DIMENSION,
    };
    measure.to_string().into()
}

/// Schema of a text with a number and a unit.
pub(crate) fn text_schema(expected: &str, negative: bool, examples: &[&str]) -> Schema {
    let sign = if negative { "[+−-]?" } else { "[+]?" };
    json_schema!({
        "type": "string",
        "description": expected,
        "pattern": format!("^\\s*{sign}([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+−-]?[0-9]+)?\\s*[^0-9\\s.eE].*$"),
        "examples": examples,
    })
}

/// The number after a minus sign that YAML takes for text; none for any other text.
fn negative(text: &str) -> Option<f64> {
    let is_one = text.starts_with(unit::MINUS);
    let number = is_one.then(|| unit::plain_minus(text).parse().ok());
    number.flatten()
}

/// A pure number within the bound `B`: an exponent, a coefficient.
pub struct Number<B = Any> {
    value: f64,
    bound: PhantomData<fn() -> B>,
}

impl<B: Bound> Number<B> {
    /// The number `value`; none where the bound forbids it or it is not finite.
    pub fn new(value: f64) -> Option<Self> {
        (value.is_finite() && B::holds(value)).then_some(Self {
            value,
            bound: PhantomData,
        })
    }

    /// The number.
    pub fn get(&self) -> f64 {
        self.value
    }
}

impl<B> Clone for Number<B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B> Copy for Number<B> {}

impl<B> PartialEq for Number<B> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<B> fmt::Debug for Number<B> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Debug::fmt(&self.value, f)
    }
}

impl<B> Serialize for Number<B> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.value)
    }
}

impl<'de, B: Bound> Deserialize<'de> for Number<B> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Plain<B>(PhantomData<B>);
        impl<B: Bound> Visitor<'_> for Plain<B> {
            type Value = Number<B>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a plain number{}", B::WORDS)
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                if let Some(number) = negative(text) {
                    return self.visit_f64(number);
                }
                let found = match unit::parse(text) {
                    Ok(share) if share.dimension == Dimension::NONE => {
                        format!("{} ({} as a plain number)", quoted(text), share.si)
                    }
                    Err(error @ (UnitError::Comma | UnitError::Thousands | UnitError::Number)) => {
                        describe_error(text, &error)
                    }
                    _ => quoted(text),
                };
                Err(E::invalid_value(Unexpected::Other(&found), &self))
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
                Number::new(value)
                    .ok_or_else(|| E::invalid_value(Unexpected::Other(&value.to_string()), &self))
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
                self.visit_f64(value as f64)
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
                self.visit_f64(value as f64)
            }
        }
        deserializer.deserialize_f64(Plain(PhantomData))
    }
}

impl<B: Bound> JsonSchema for Number<B> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{}Number", B::NAME).into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({"type": "number"});
        B::keywords(&mut schema);
        schema
    }
}
