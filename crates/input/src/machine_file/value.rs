//! The values of declared parameters: how a file has them.

use crate::choice::WholeNumber;
use crate::quantity::{
    self, AboveZero, Any, Bound, FromOne, FromZero, Kind, Number, ProperPart, Quantity as Of,
    Rebound,
};
use crate::unit::Dimension;
use mechanism::declaration::{Quantity, Range};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{DeserializeOwned, DeserializeSeed, Deserializer, Error, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// What a parameter is declared to be.
pub(super) type Declared = (Quantity, Range);

/// Angles from 0 to half a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OnTheStroke;

impl Bound for OnTheStroke {
    const NAME: &'static str = "Stroke";
    const WORDS: &'static str = " from 0 to 180 deg";
    fn holds(value: f64) -> bool {
        (0.0..=std::f64::consts::PI).contains(&value)
    }
    fn keywords(_: &mut Schema) {}
}

/// A type that a file's values have.
trait Valued: DeserializeOwned + JsonSchema {
    /// Its dimension; none for a plain number.
    const DIMENSION: Option<Dimension>;
    /// Its SI unit; empty for a plain number.
    const UNIT: &'static str;
    /// The value, SI.
    fn si(&self) -> f64;
}

impl<K: Kind, B: Bound> Valued for Of<K, B> {
    const DIMENSION: Option<Dimension> = Some(K::DIMENSION);
    const UNIT: &'static str = K::UNIT;
    fn si(&self) -> f64 {
        self.si()
    }
}

impl<B: Bound> Valued for Number<B> {
    const DIMENSION: Option<Dimension> = None;
    const UNIT: &'static str = "";
    fn si(&self) -> f64 {
        self.get()
    }
}

/// Something that is done with the kind of a quantity.
pub(super) trait WithKind {
    type Output;
    fn with<K: Kind>(self) -> Self::Output;
    fn with_number(self) -> Self::Output;
}

pub(super) fn with_kind<W: WithKind>(quantity: Quantity, then: W) -> W::Output {
    match quantity {
        Quantity::Number => then.with_number(),
        Quantity::Ratio => then.with::<quantity::Ratio>(),
        Quantity::Length => then.with::<quantity::Length>(),
        Quantity::Clearance => then.with::<quantity::Clearance>(),
        Quantity::Angle => then.with::<quantity::Angle>(),
        Quantity::Speed => then.with::<quantity::Speed>(),
        Quantity::Frequency => then.with::<quantity::Frequency>(),
        Quantity::Velocity => then.with::<quantity::Velocity>(),
        Quantity::Acceleration => then.with::<quantity::Acceleration>(),
        Quantity::Force => then.with::<quantity::Force>(),
        Quantity::Damping => then.with::<quantity::Damping>(),
        Quantity::Area => then.with::<quantity::Area>(),
        Quantity::Compliance => then.with::<quantity::Compliance>(),
        Quantity::Pressure => then.with::<quantity::Pressure>(),
        Quantity::Viscosity => then.with::<quantity::Viscosity>(),
        Quantity::Duration => then.with::<quantity::Duration>(),
        Quantity::StiffnessPerRoot => then.with::<quantity::StiffnessPerRoot>(),
        Quantity::ForcePerPressure => then.with::<quantity::ForcePerPressure>(),
    }
}

/// Something that is done with the type of a parameter.
trait WithType {
    type Output;
    fn with<T: Valued>(self) -> Self::Output;
    fn with_whole(self, number: WholeNumber) -> Self::Output;
}

fn with_type<W: WithType>((quantity, range): Declared, then: W) -> W::Output {
    struct Ranged<W>(Range, W);
    impl<W: WithType> WithKind for Ranged<W> {
        type Output = W::Output;
        fn with<K: Kind>(self) -> W::Output {
            with_range::<K, W>(self.0, self.1)
        }
        fn with_number(self) -> W::Output {
            number_with_range(self.0, self.1)
        }
    }
    with_kind(quantity, Ranged(range, then))
}

fn number_with_range<W: WithType>(range: Range, then: W) -> W::Output {
    match range {
        Range::Any => then.with::<Number<Any>>(),
        Range::AboveZero => then.with::<Number<AboveZero>>(),
        Range::FromZero => then.with::<Number<FromZero>>(),
        Range::ProperPart => then.with::<Number<ProperPart>>(),
        Range::OnTheStroke => then.with::<Number<OnTheStroke>>(),
        Range::FromOne => then.with::<Number<FromOne>>(),
        Range::Rebound => then.with::<Number<Rebound>>(),
        Range::Whole(low, high) => then.with_whole(WholeNumber { low, high }),
    }
}

fn with_range<K: Kind, W: WithType>(range: Range, then: W) -> W::Output {
    match range {
        Range::Any => then.with::<Of<K, Any>>(),
        Range::AboveZero => then.with::<Of<K, AboveZero>>(),
        Range::FromZero => then.with::<Of<K, FromZero>>(),
        Range::ProperPart => then.with::<Of<K, ProperPart>>(),
        Range::OnTheStroke => then.with::<Of<K, OnTheStroke>>(),
        Range::FromOne => then.with::<Of<K, FromOne>>(),
        Range::Rebound => then.with::<Of<K, Rebound>>(),
        // A number of things has no unit.
        Range::Whole(low, high) => then.with_whole(WholeNumber { low, high }),
    }
}

/// Dimension and SI unit of a parameter; none and empty for a plain number.
pub(super) fn unit(declared: Declared) -> (Option<Dimension>, &'static str) {
    struct Unit;
    impl WithType for Unit {
        type Output = (Option<Dimension>, &'static str);
        fn with<T: Valued>(self) -> Self::Output {
            (T::DIMENSION, T::UNIT)
        }
        fn with_whole(self, _: WholeNumber) -> Self::Output {
            (None, "")
        }
    }
    with_type(declared, Unit)
}

/// Dimension and SI unit of a quantity.
pub(crate) fn unit_of_quantity(quantity: Quantity) -> (Dimension, &'static str) {
    struct Unit;
    impl WithKind for Unit {
        type Output = (Dimension, &'static str);
        fn with<K: Kind>(self) -> Self::Output {
            (K::DIMENSION, K::UNIT)
        }
        fn with_number(self) -> Self::Output {
            (Dimension::NONE, "")
        }
    }
    with_kind(quantity, Unit)
}

/// Schema of a parameter's value.
pub(super) fn schema(declared: Declared, generator: &mut SchemaGenerator) -> Schema {
    struct Describe<'a>(&'a mut SchemaGenerator);
    impl WithType for Describe<'_> {
        type Output = Schema;
        fn with<T: Valued>(self) -> Schema {
            self.0.subschema_for::<T>()
        }
        fn with_whole(self, number: WholeNumber) -> Schema {
            number.schema()
        }
    }
    with_type(declared, Describe(generator))
}

/// Reads the value of a parameter, SI; none for null.
pub(super) struct Value(pub Declared);

impl<'de> DeserializeSeed<'de> for Value {
    type Value = Option<f64>;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_option(self)
    }
}

impl<'de> Visitor<'de> for Value {
    type Value = Option<f64>;
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }
    fn visit_none<E: Error>(self) -> Result<Self::Value, E> {
        Ok(None)
    }
    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        struct Read<'de, D>(D, PhantomData<&'de ()>);
        impl<'de, D: Deserializer<'de>> WithType for Read<'de, D> {
            type Output = Result<f64, D::Error>;
            fn with<T: Valued>(self) -> Self::Output {
                T::deserialize(self.0).map(|value| value.si())
            }
            fn with_whole(self, number: WholeNumber) -> Self::Output {
                number.deserialize(self.0).map(f64::from)
            }
        }
        with_type(self.0, Read(deserializer, PhantomData)).map(Some)
    }
}
