//! Sensors and their measuring chains.

use super::sections::Resonance;
use crate::choice::Count;
use crate::error::{Error, Problem, quoted};
use crate::quantity::{
    Acceleration, Angle, Any, Frequency, Kind, NonNegative, Number, Part, Positive, Pressure,
    Quantity, Ratio, describe, found, text_schema,
};
use crate::unit::{self, Dimension};
use mechanism::Machine;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{Deserializer, IntoDeserializer, Unexpected, Visitor};
use simulate::sensor::{self, Chain, Measured, NoiseLevel, Range, Sensor};
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::fmt;
use std::marker::PhantomData;

/// A measured quantity, seen through a measuring chain.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename = "tag:measure", rename_all = "snake_case")]
#[schemars(rename = "Sensor", tag = "measure")]
pub(super) enum SensorSection {
    /// Acceleration of the crosshead along the cylinder, positive toward the head.
    CrossheadAcceleration(OnCrosshead),
    /// Acceleration of the crosshead across the guide (not 0 only with clearance there).
    CrossheadLateralAcceleration(OnCrosshead),
    /// Acceleration of the frame along an axis.
    FrameAcceleration(OnFrame),
    /// Gas pressure in a chamber.
    CylinderPressure(InCylinder),
    /// Crank angle from 0 to one turn.
    CrankAngle(OnCrank),
}

/// Declares a sensor section: what is its own, and the measuring chain that all share.
macro_rules! sensor {
    (
        $(#[$meta:meta])*
        struct $name:ident<$kind:ident> { $( $(#[$field_meta:meta])* $field:ident: $type:ty, )* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $( $(#[$field_meta])* $field: $type, )*
            /// Largest magnitude that is recorded, beyond which the record is flat; auto for a
            /// recorder that sets it to the largest magnitude of each record.
            #[serde(default)]
            range: Option<RangeText<$kind>>,
            /// Resolution of the converter over ± the range.
            #[serde(default)]
            bits: Option<Count<1, 32>>,
            /// Noise of the chain.
            #[serde(default)]
            noise: Option<Noise<Level<$kind>>>,
            /// Low-pass filter of the amplifier (Butterworth).
            #[serde(default)]
            low_pass: Option<LowPass>,
            /// Resonance of the sensor on its mount.
            #[serde(default)]
            mounting: Option<Resonance>,
            /// Factor on the value; 1, as when calibrated right, where it is left out.
            #[serde(default)]
            gain: Option<Number<Any>>,
        }

        impl $name {
            fn chain(&self) -> Chain {
                Chain {
                    mounting: self.mounting.map(|mounting| sensor::Resonance {
                        frequency: mounting.frequency.si(),
                        damping_ratio: mounting.damping_ratio.si(),
                    }),
                    low_pass: self.low_pass.map(|low_pass| sensor::LowPass {
                        cutoff: low_pass.cutoff.si(),
                        order: low_pass.order.get(),
                    }),
                    gain: self.gain.map_or(1.0, |gain| gain.get()),
                    noise: self.noise.as_ref().map(Noise::resolve),
                    range: self.range.as_ref().map(|range| range.range),
                    bits: self.bits.map(|bits| bits.get()),
                    ..Chain::default()
                }
            }
        }
    };
}

sensor! {
    /// A sensor on a crosshead.
    struct OnCrosshead<Acceleration> {
        /// Name of the throw; may be left out where there is one.
        #[serde(default)]
        throw: Option<String>,
    }
}

sensor! {
    /// A sensor on the frame.
    struct OnFrame<Acceleration> {
        /// Direction that it feels.
        axis: Axis,
    }
}

sensor! {
    /// A sensor in a cylinder.
    struct InCylinder<Pressure> {
        /// Name of the throw; may be left out where there is one.
        #[serde(default)]
        throw: Option<String>,
        /// Which chamber; head where it is left out.
        #[serde(default)]
        end: End,
    }
}

sensor! {
    /// An encoder on the crankshaft. Its range is one turn where it is left out.
    struct OnCrank<Angle> {}
}

/// A direction of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Axis {
    /// Along the cylinder.
    X,
    /// Across the cylinder.
    Y,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum End {
    /// Between piston and head.
    #[default]
    Head,
    /// Between piston and crank-end cover.
    Crank,
}

/// A Butterworth low-pass filter.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LowPass {
    /// Frequency at which it damps by 3 dB.
    cutoff: Positive<Frequency>,
    /// Order.
    order: Count<1, 8>,
}

/// Gaussian noise: white, plus 1/f.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Noise{L}")]
struct Noise<L> {
    /// RMS of the whole noise: in the sensor's unit, or in % of the signal's own RMS.
    rms: L,
    /// Share of its power that is 1/f; 0 % where it is left out.
    #[serde(default)]
    pink_share: Option<Quantity<Ratio, Part>>,
}

impl<K> Noise<Level<K>> {
    fn resolve(&self) -> sensor::Noise {
        sensor::Noise {
            level: self.rms.level,
            pink_share: self.pink_share.map_or(0.0, |share| share.si()),
        }
    }
}

/// The size of noise on a quantity of kind `K`.
#[derive(Clone, Debug, PartialEq)]
struct Level<K> {
    level: NoiseLevel,
    kind: PhantomData<K>,
}

impl<K: Kind> Level<K> {
    fn expected() -> String {
        format!(
            "{}, or '2 %' of the signal's RMS",
            NonNegative::<K>::expected()
        )
    }
}

impl<'de, K: Kind> Deserialize<'de> for Level<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text<K>(PhantomData<K>);
        impl<K: Kind> Visitor<'_> for Text<K> {
            type Value = Level<K>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(&Level::<K>::expected())
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Level<K>, E> {
                let wrong = |found: &str| E::invalid_value(Unexpected::Other(found), &self);
                let measure = unit::parse(text).map_err(|error| wrong(&found(text, &error)))?;
                let level = match measure.dimension {
                    _ if measure.si < 0.0 => return Err(wrong(&quoted(text))),
                    d if d == Dimension::NONE => NoiseLevel::OfSignal(measure.si),
                    d if d == K::DIMENSION => NoiseLevel::Absolute(measure.si),
                    _ => {
                        let found = format!("{} ({})", quoted(text), describe(&measure));
                        return Err(wrong(&found));
                    }
                };
                Ok(Level {
                    level,
                    kind: PhantomData,
                })
            }
        }
        deserializer.deserialize_str(Text(PhantomData))
    }
}

impl<K: Kind> JsonSchema for Level<K> {
    fn schema_name() -> Cow<'static, str> {
        format!("Level{}", K::NAME).into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        text_schema(&Self::expected(), false, &["2 %", K::EXAMPLE])
    }
}

/// The range of a recorder of quantities of kind `K`.
#[derive(Clone, Debug, PartialEq)]
struct RangeText<K> {
    range: Range,
    kind: PhantomData<K>,
}

/// The word for a range that is set to each record.
const AUTO: &str = "auto";

impl<K: Kind> RangeText<K> {
    fn expected() -> String {
        format!("{}, or '{AUTO}'", Positive::<K>::expected())
    }
}

impl<'de, K: Kind> Deserialize<'de> for RangeText<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text<K>(PhantomData<K>);
        impl<K: Kind> Visitor<'_> for Text<K> {
            type Value = RangeText<K>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(&RangeText::<K>::expected())
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<RangeText<K>, E> {
                let range = match text {
                    AUTO => Range::Auto,
                    text => {
                        let text: StrDeserializer<E> = text.into_deserializer();
                        Range::Fixed(Positive::<K>::deserialize(text)?.si())
                    }
                };
                Ok(RangeText {
                    range,
                    kind: PhantomData,
                })
            }
        }
        deserializer.deserialize_str(Text(PhantomData))
    }
}

impl<K: Kind> JsonSchema for RangeText<K> {
    fn schema_name() -> Cow<'static, str> {
        format!("Range{}", K::NAME).into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let fixed = text_schema(&Positive::<K>::expected(), false, &[K::EXAMPLE]);
        json_schema!({"anyOf": [{"const": AUTO}, fixed]})
    }
}

/// The sensors on `machine`.
pub(super) fn resolve(sections: &[SensorSection], machine: &Machine) -> Result<Vec<Sensor>, Error> {
    let names: Vec<&str> = machine.throws.iter().map(|t| t.name.as_str()).collect();
    let mut sensors: Vec<Sensor> = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        let sensor = section.resolve(machine, &names).map_err(|e| e.under(i))?;
        if let Some(first) = sensors.iter().position(|s| s.measured == sensor.measured) {
            let found = format_args!("what sensors.{first} measures already");
            return Err(Error::found(
                i.to_string(),
                found,
                "each quantity at most once",
            ));
        }
        sensors.push(sensor);
    }
    Ok(sensors)
}

impl SensorSection {
    fn resolve(&self, machine: &Machine, names: &[&str]) -> Result<Sensor, Error> {
        let (measured, chain) = match self {
            Self::CrossheadAcceleration(s) => {
                let throw = throw(&s.throw, names)?;
                (Measured::CrossheadAcceleration { throw }, s.chain())
            }
            Self::CrossheadLateralAcceleration(s) => {
                let throw = throw(&s.throw, names)?;
                (Measured::CrossheadLateralAcceleration { throw }, s.chain())
            }
            Self::FrameAcceleration(s) => {
                if machine.frame.is_none() {
                    let expected = "a section frame in the machine";
                    return Err(Error::clash("measure", expected));
                }
                let axis = match s.axis {
                    Axis::X => sensor::Axis::X,
                    Axis::Y => sensor::Axis::Y,
                };
                (Measured::FrameAcceleration { axis }, s.chain())
            }
            Self::CylinderPressure(s) => {
                let throw = throw(&s.throw, names)?;
                let end = match s.end {
                    End::Head => sensor::ChamberEnd::Head,
                    End::Crank if machine.throws[throw].cylinder.crank_end.is_none() => {
                        let expected = "'head', or a section crank_end in the cylinder";
                        return Err(Error::clash("end", expected));
                    }
                    End::Crank => sensor::ChamberEnd::Crank,
                };
                (Measured::CylinderPressure { throw, end }, s.chain())
            }
            Self::CrankAngle(s) => {
                let mut chain = s.chain();
                if chain.bits.is_some() {
                    chain.range.get_or_insert(Range::Fixed(TAU));
                }
                (Measured::CrankAngle, chain)
            }
        };
        if let (Some(bits), None) = (chain.bits, chain.range) {
            let found = format_args!("{bits} without a range");
            return Err(Error::found("bits", found, "a key range beside it"));
        }
        Ok(Sensor { measured, chain })
    }
}

/// The index of the throw called `name`, or of the only one.
fn throw(name: &Option<String>, names: &[&str]) -> Result<usize, Error> {
    match name {
        None if names.len() == 1 => Ok(0),
        None => {
            let expected = Some(format!("one of {}", names.join(", ")));
            Err(Error::new("throw", Problem::Missing { expected }))
        }
        Some(name) => names
            .iter()
            .position(|known| known == name)
            .ok_or_else(|| Error::unknown_name("throw", name, named(names))),
    }
}

/// The names to choose from: none in a machine whose only throw has no name.
fn named<'a, 'b>(names: &'a [&'b str]) -> &'a [&'b str] {
    match names {
        [""] => &[],
        names => names,
    }
}
