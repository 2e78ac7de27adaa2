//! The calibration that a sweep asks for before its first case.

use input::calibration::Calibration;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, StringDeserializer};
use serde::de::{DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// The machine is calibrated before the first case: the keys of a calibration file, and how the
/// sweep uses the uncertainty of the estimates.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrate {
    /// What is fitted to which recordings, and how.
    pub settings: Calibration,
    /// How the sweep uses the uncertainty of the estimates.
    pub uncertainty: Uncertainty,
    /// Treatment of parameters that are not identifiable.
    pub undetermined: Undetermined,
}

/// How a sweep uses the uncertainty of the estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Uncertainty {
    /// Every case has the best values.
    #[default]
    Ignored,
    /// Every case draws its values from their joint distribution: normal in the logarithms of
    /// positive values, with the intervals and correlations of the calibration, within the bounds.
    /// It also draws one relation to the clearance, the same for all joints, from those that the
    /// recordings do not exclude. A calibration whose model is not adequate has no intervals, and
    /// is an error.
    Sampled,
}

/// Treatment of parameters that are not identifiable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Undetermined {
    /// They keep their nominal values.
    #[default]
    Nominal,
    /// Every case draws each value independently between the bounds of the search; positive values
    /// are uniform in the logarithm.
    Prior,
}

/// The keys that a sweep adds to those of a calibration file.
const ADDED: [&str; 2] = ["uncertainty", "undetermined"];

/// The keys of a calibration file; the others are put aside as they come by.
struct Keys<'a, M> {
    map: M,
    uncertainty: &'a mut Uncertainty,
    undetermined: &'a mut Undetermined,
}

impl<'de, M: MapAccess<'de>> MapAccess<'de> for Keys<'_, M> {
    type Error = M::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, M::Error> {
        while let Some(key) = self.map.next_key::<String>()? {
            match key.as_str() {
                "uncertainty" => *self.uncertainty = self.map.next_value()?,
                "undetermined" => *self.undetermined = self.map.next_value()?,
                _ => {
                    let key: StringDeserializer<M::Error> = key.into_deserializer();
                    return seed.deserialize(key).map(Some);
                }
            }
        }
        Ok(None)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, M::Error> {
        self.map.next_value_seed(seed)
    }
}

impl<'de> Deserialize<'de> for Calibrate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Section;
        impl<'de> Visitor<'de> for Section {
            type Value = Calibrate;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a section with the key bundle")
            }
            fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Calibrate, M::Error> {
                let (mut uncertainty, mut undetermined) = Default::default();
                let keys = Keys {
                    map,
                    uncertainty: &mut uncertainty,
                    undetermined: &mut undetermined,
                };
                let settings = Calibration::deserialize(MapAccessDeserializer::new(keys))?;
                if settings.machine.is_some() {
                    let expected = "machine beside calibrate, as the sweep's own, in place of calibrate.machine";
                    return Err(M::Error::custom(expected));
                }
                Ok(Calibrate {
                    settings,
                    uncertainty,
                    undetermined,
                })
            }
        }
        deserializer.deserialize_map(Section)
    }
}

impl JsonSchema for Calibrate {
    fn schema_name() -> Cow<'static, str> {
        "Calibrate".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = Calibration::json_schema(generator);
        let added = [
            generator.subschema_for::<Uncertainty>(),
            generator.subschema_for::<Undetermined>(),
        ];
        if let Some(properties) = schema
            .get_mut("properties")
            .and_then(|properties| properties.as_object_mut())
        {
            properties.shift_remove("machine");
            for (name, of) in ADDED.into_iter().zip(added) {
                properties.insert(name.into(), of.into());
            }
        }
        schema
    }
}
