//! The measuring chain, whose keys all sensors share.

use crate::choice::Count;
use crate::error::quoted;
use crate::machine_file::sections::Resonance;
use crate::quantity::{
    Any, Duration, Frequency, Kind, NonNegative, Number, Part, Positive, Quantity, Ratio, describe,
    describe_error, measure, text_schema,
};
use crate::unit::Dimension;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{Deserializer, IntoDeserializer, MapAccess, Unexpected, Visitor};
use simulate::sensor::{self, Chain, NoiseLevel, Range};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

const RANGE: &str = "range";
const BITS: &str = "bits";
const NOISE: &str = "noise";
const DELAY: &str = "delay";
const LOW_PASS: &str = "low_pass";
const HIGH_PASS: &str = "high_pass";
const MOUNTING: &str = "mounting";
const GAIN: &str = "gain";

/// The keys of a chain.
pub(super) const KEYS: [&str; 8] = [
    RANGE, BITS, NOISE, DELAY, LOW_PASS, HIGH_PASS, MOUNTING, GAIN,
];

/// Reads the value of a key of the chain of a sensor of kind `K`; false for any other key.
pub(super) fn read<'de, K: Kind, A: MapAccess<'de>>(
    chain: &mut Chain,
    key: &str,
    map: &mut A,
) -> Result<bool, A::Error> {
    match key {
        RANGE => {
            let range: Option<RangeText<K>> = map.next_value()?;
            chain.range = range.map(|text| text.range);
        }
        BITS => {
            let bits: Option<Count<1, 32>> = map.next_value()?;
            chain.bits = bits.map(Count::get);
        }
        NOISE => {
            let noise: Option<Noise<Level<K>>> = map.next_value()?;
            chain.noise = noise.as_ref().map(Noise::resolve);
        }
        DELAY => {
            let delay: Option<NonNegative<Duration>> = map.next_value()?;
            chain.delay = delay.map_or(0.0, |delay| delay.si());
        }
        LOW_PASS => {
            let low_pass: Option<LowPass> = map.next_value()?;
            chain.low_pass = low_pass.map(|low_pass| sensor::LowPass {
                cutoff: low_pass.cutoff.si(),
                order: low_pass.order.get(),
            });
        }
        HIGH_PASS => {
            let high_pass: Option<HighPass> = map.next_value()?;
            chain.high_pass = high_pass.map(|high_pass| high_pass.cutoff.si());
        }
        MOUNTING => {
            let mounting: Option<Resonance> = map.next_value()?;
            chain.mounting = mounting.map(|mounting| sensor::Resonance {
                frequency: mounting.frequency.si(),
                damping_ratio: mounting.damping_ratio.si(),
            });
        }
        GAIN => {
            let gain: Option<Number<Any>> = map.next_value()?;
            chain.gain = gain.map_or(1.0, |gain| gain.get());
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// Meaning and schema of each of [`KEYS`] in a chain of kind `K`.
pub(super) fn schemas<K: Kind>(generator: &mut SchemaGenerator) -> [(&'static str, Schema); 8] {
    let range = generator.subschema_for::<Option<RangeText<K>>>();
    let bits = generator.subschema_for::<Option<Count<1, 32>>>();
    let noise = generator.subschema_for::<Option<Noise<Level<K>>>>();
    let delay = generator.subschema_for::<Option<NonNegative<Duration>>>();
    let low_pass = generator.subschema_for::<Option<LowPass>>();
    let high_pass = generator.subschema_for::<Option<HighPass>>();
    let mounting = generator.subschema_for::<Option<Resonance>>();
    let gain = generator.subschema_for::<Option<Number<Any>>>();
    [
        (
            "Largest magnitude that is recorded, beyond which the record is flat; auto for a \
             recorder that sets it to the largest magnitude of each record.",
            range,
        ),
        ("Resolution of the converter over ± the range.", bits),
        ("Noise of the chain.", noise),
        (
            "By how much the recorded value is late; 0 s where it is left out.",
            delay,
        ),
        ("Low-pass filter of the amplifier (Butterworth).", low_pass),
        (
            "Coupling that does not pass what is constant (first order), as of a charge amplifier.",
            high_pass,
        ),
        ("Resonance of the sensor on its mount.", mounting),
        (
            "Factor on the value; 1, as when calibrated right, where it is left out.",
            gain,
        ),
    ]
}

/// A Butterworth low-pass filter.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LowPass {
    /// Frequency at which it damps by 3 dB.
    cutoff: Positive<Frequency>,
    /// Order.
    order: Count<1, 8>,
}

/// A high-pass filter of the first order.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HighPass {
    /// Frequency at which it damps by 3 dB.
    cutoff: Positive<Frequency>,
}

/// Gaussian noise: white, plus 1/f.
#[derive(Deserialize, JsonSchema)]
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
                let measure =
                    measure::<K>(text).map_err(|error| wrong(&describe_error(text, &error)))?;
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
