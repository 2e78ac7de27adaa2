//! The section of a sensor in the list `sensors`, as its declaration has it.

use super::chain;
use crate::machine_file::value::{WithKind, with_kind};
use crate::quantity::{Kind, Ratio};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, VariantAccess, Visitor,
};
use serde_json::{Map, Value, json};
use simulate::sensor::Chain;
use simulate::sensors::{Entry, PlaceKey, SENSORS};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// The key that names the sensor.
pub(super) const MEASURE: &str = "measure";

/// A measured quantity, seen through a measuring chain.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SensorSection {
    /// Index of the sensor in [`SENSORS`].
    sensor: usize,
    pub(super) throw: Option<String>,
    pub(super) axis: Option<Axis>,
    pub(super) end: End,
    pub(super) chain: Chain,
}

/// A direction of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Axis {
    /// Along the cylinder.
    X,
    /// Across the cylinder.
    Y,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum End {
    /// Between piston and head.
    #[default]
    Head,
    /// Between piston and crank-end cover.
    Crank,
}

/// The key of a place.
pub(super) fn key(place: PlaceKey) -> &'static str {
    match place {
        PlaceKey::Throw => "throw",
        PlaceKey::Axis => "axis",
        PlaceKey::End => "end",
    }
}

/// Names of the sensors, and the keys of each.
static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| SENSORS.iter().map(|sensor| sensor.name).collect());
static KEYS: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| {
    let keys = |sensor: &Entry| {
        let places = sensor.places.iter().map(|place| key(*place));
        places.chain(chain::KEYS).collect()
    };
    SENSORS.iter().map(keys).collect()
});

impl SensorSection {
    fn new(sensor: usize) -> Self {
        Self {
            sensor,
            throw: None,
            axis: None,
            end: End::default(),
            chain: Chain::default(),
        }
    }

    /// The sensor.
    pub(super) fn entry(&self) -> &'static Entry {
        &SENSORS[self.sensor]
    }
}

impl<'de> Deserialize<'de> for SensorSection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Named;
        impl<'de> Visitor<'de> for Named {
            type Value = SensorSection;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a sensor")
            }
            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Self::Value, A::Error> {
                let (sensor, content) = data.variant::<Index>()?;
                content.newtype_variant_seed(Content(sensor.0))
            }
        }
        deserializer.deserialize_enum("tag:measure", &NAMES, Named)
    }
}

/// The index of a sensor, by its name.
struct Index(usize);

impl<'de> Deserialize<'de> for Index {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let index = NAMES.iter().position(|known| *known == name);
        index
            .map(Index)
            .ok_or_else(|| D::Error::unknown_variant(&name, &NAMES))
    }
}

/// The keys of the sensor with this index.
struct Content(usize);

impl<'de> DeserializeSeed<'de> for Content {
    type Value = SensorSection;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_struct("Sensor", &KEYS[self.0], self)
    }
}

impl<'de> Visitor<'de> for Content {
    type Value = SensorSection;
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a section")
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut section = SensorSection::new(self.0);
        let entry = section.entry();
        while let Some(name) = map.next_key::<String>()? {
            let mut places = entry.places.iter();
            match places.find(|place| key(**place) == name) {
                Some(PlaceKey::Throw) => section.throw = map.next_value()?,
                Some(PlaceKey::Axis) => section.axis = Some(map.next_value()?),
                Some(PlaceKey::End) => section.end = map.next_value()?,
                None => {
                    let reading = ReadChain {
                        chain: &mut section.chain,
                        key: &name,
                        map: &mut map,
                        input: PhantomData,
                    };
                    if !with_kind(entry.declaration.quantity, reading)? {
                        return Err(A::Error::unknown_field(&name, &KEYS[self.0]));
                    }
                }
            }
        }
        if entry.places.contains(&PlaceKey::Axis) && section.axis.is_none() {
            return Err(A::Error::missing_field(key(PlaceKey::Axis)));
        }
        Ok(section)
    }
}

/// Reads a key of the chain.
struct ReadChain<'a, 'de, A> {
    chain: &'a mut Chain,
    key: &'a str,
    map: &'a mut A,
    input: PhantomData<&'de ()>,
}

impl<'de, A: MapAccess<'de>> WithKind for ReadChain<'_, 'de, A> {
    type Output = Result<bool, A::Error>;
    fn with<K: Kind>(self) -> Self::Output {
        chain::read::<K, A>(self.chain, self.key, self.map)
    }
    fn with_number(self) -> Self::Output {
        self.with::<Ratio>()
    }
}

impl JsonSchema for SensorSection {
    fn schema_name() -> Cow<'static, str> {
        "Sensor".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let each = SENSORS.iter().map(|entry| schema(entry, generator));
        let each: Vec<Value> = each.map(Schema::to_value).collect();
        json_schema!({
            "oneOf": each,
            "description": "A measured quantity, seen through a measuring chain.",
        })
    }
}

/// Schema of the section of a sensor.
fn schema(entry: &Entry, generator: &mut SchemaGenerator) -> Schema {
    let mut properties = Map::new();
    let name = json!({"type": "string", "const": entry.name});
    properties.insert(MEASURE.to_owned(), name);
    let mut add = |key: &str, words: &str, mut schema: Schema| {
        schema.insert("description".to_owned(), words.into());
        properties.insert(key.to_owned(), schema.to_value());
    };
    let mut required = vec![MEASURE];
    for place in entry.places {
        let (words, schema) = match place {
            PlaceKey::Throw => (
                "Name of the throw; may be left out where there is one.",
                generator.subschema_for::<Option<String>>(),
            ),
            PlaceKey::Axis => {
                required.push(key(*place));
                (
                    "Direction that it feels.",
                    generator.subschema_for::<Axis>(),
                )
            }
            PlaceKey::End => (
                "Which chamber; head where it is left out.",
                generator.subschema_for::<End>(),
            ),
        };
        add(key(*place), words, schema);
    }
    let of_chain = with_kind(entry.declaration.quantity, Schemas(generator));
    for (key, (words, schema)) in chain::KEYS.into_iter().zip(of_chain) {
        add(key, words, schema);
    }
    json_schema!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
        "description": entry.declaration.about,
        "required": required,
    })
}

/// Makes the schemas of the chain's keys.
struct Schemas<'a>(&'a mut SchemaGenerator);

impl WithKind for Schemas<'_> {
    type Output = [(&'static str, Schema); 8];
    fn with<K: Kind>(self) -> Self::Output {
        chain::schemas::<K>(self.0)
    }
    fn with_number(self) -> Self::Output {
        self.with::<Ratio>()
    }
}
