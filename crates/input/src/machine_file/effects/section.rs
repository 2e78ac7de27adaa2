//! The section of an effect in the list `effects`, as its declaration has it.

use super::act::{Act, Body, End, Joint, Measure, Part, Place};
use super::catalogue::{CATALOGUE, Entry, entry};
use crate::machine_file::value::{self, Value};
use mechanism::declaration::PlaceKey;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, VariantAccess,
    Visitor,
};
use std::borrow::Cow;
use std::fmt;
use std::sync::LazyLock;

/// Physics beyond the first model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EffectSection {
    /// The effect.
    pub entry: &'static Entry,
    /// Where it acts.
    pub place: Place,
    /// The values that the section states, SI, in the order of the parameters.
    pub stated: Vec<Option<f64>>,
}

impl EffectSection {
    /// The values of the parameters, SI; what is left out has its default.
    pub fn values(&self) -> Vec<f64> {
        let each = self.stated.iter().zip(self.entry.declared());
        each.map(|(stated, parameter)| stated.unwrap_or(parameter.default()))
            .collect()
    }

    /// What it does.
    pub fn effect(&self) -> Box<dyn Act> {
        self.entry.effect(&self.values(), &self.place)
    }

    /// The whole numbers among its values, which distinguish it from the same effect at the same place.
    pub fn orders(&self) -> Vec<f64> {
        let each = self.values().into_iter().zip(self.entry.parameters);
        each.filter(|(_, parameter)| parameter.whole)
            .map(|(value, _)| value)
            .collect()
    }
}

static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| CATALOGUE.iter().map(|entry| entry.name).collect());

impl<'de> Deserialize<'de> for EffectSection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Named;
        impl<'de> Visitor<'de> for Named {
            type Value = EffectSection;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an effect")
            }
            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Self::Value, A::Error> {
                let (name, content) = data.variant::<String>()?;
                match entry(&name) {
                    Some(entry) => content.newtype_variant_seed(Content(entry)),
                    None => Err(A::Error::unknown_variant(&name, &NAMES)),
                }
            }
        }
        deserializer.deserialize_enum("EffectSection", &NAMES, Named)
    }
}

/// The keys of an effect's section.
struct Content(&'static Entry);

impl<'de> DeserializeSeed<'de> for Content {
    type Value = EffectSection;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_struct(self.0.name, self.0.keys, self)
    }
}

impl<'de> Visitor<'de> for Content {
    type Value = EffectSection;
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a section")
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let entry = self.0;
        let declared = entry.declared();
        let mut stated = vec![None; declared.len()];
        let mut place = Place::default();
        while let Some(key) = map.next_key::<String>()? {
            let parameter = declared.iter().position(|parameter| parameter.key == key);
            let choice = entry.place_keys().iter();
            let mut choice = choice.filter(|choice| super::catalogue::choice(**choice).key == key);
            match (parameter, choice.next()) {
                (Some(i), _) => stated[i] = map.next_value_seed(Value(declared[i].declared()))?,
                (None, Some(PlaceKey::Throw)) => place.throw = map.next_value()?,
                (None, Some(PlaceKey::Joint)) => place.joint = Some(map.next_value()?),
                (None, Some(PlaceKey::End)) => place.end = map.next_value()?,
                (None, Some(PlaceKey::Measure)) => place.measure = map.next_value()?,
                (None, Some(PlaceKey::Body)) => place.body = map.next_value()?,
                (None, Some(PlaceKey::Part)) => place.part = map.next_value()?,
                (None, None) => return Err(A::Error::unknown_field(&key, entry.keys)),
            }
        }
        if entry.place_keys().contains(&PlaceKey::Joint) && place.joint.is_none() {
            return Err(A::Error::missing_field("joint"));
        }
        Ok(EffectSection {
            entry,
            place,
            stated,
        })
    }
}

impl JsonSchema for EffectSection {
    fn schema_name() -> Cow<'static, str> {
        "EffectSection".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let each = CATALOGUE.iter().map(|entry| {
            let name = entry.name;
            let section = definition(entry, generator);
            json_schema!({
                "description": entry.sentence,
                "type": "object",
                "properties": {name: section},
                "required": [name],
                "additionalProperties": false,
            })
        });
        let each: Vec<Schema> = each.collect();
        json_schema!({"description": "Physics beyond the first model.", "oneOf": each})
    }
}

/// Defines the section of an effect, and refers to it.
fn definition(entry: &'static Entry, generator: &mut SchemaGenerator) -> Schema {
    let mut properties = serde_json::Map::new();
    for parameter in entry.declared() {
        let mut schema = value::schema(parameter.declared(), generator);
        schema.insert("description".to_owned(), parameter.words.into());
        properties.insert(parameter.key.to_owned(), schema.to_value());
    }
    let mut required = Vec::new();
    for key in entry.place_keys() {
        let choice = super::catalogue::choice(*key);
        let mut schema = match key {
            PlaceKey::Throw => generator.subschema_for::<String>(),
            PlaceKey::Joint => generator.subschema_for::<Joint>(),
            PlaceKey::End => generator.subschema_for::<End>(),
            PlaceKey::Measure => generator.subschema_for::<Measure>(),
            PlaceKey::Body => generator.subschema_for::<Body>(),
            PlaceKey::Part => generator.subschema_for::<Part>(),
        };
        schema.insert("description".to_owned(), words(*key).into());
        properties.insert(choice.key.to_owned(), schema.to_value());
        if choice.required {
            required.push(choice.key);
        }
    }
    let mut section = json_schema!({
        "description": entry.about(),
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if !required.is_empty() {
        section.insert("required".to_owned(), required.into());
    }
    let name = entry.type_name();
    let definitions = generator.definitions_mut();
    definitions.insert(name.to_owned(), section.to_value());
    Schema::new_ref(format!("#/$defs/{name}"))
}

/// What a key of a place means.
fn words(key: PlaceKey) -> &'static str {
    match key {
        PlaceKey::Throw => "Name of the throw; every one where it is left out.",
        PlaceKey::Joint => "The joint.",
        PlaceKey::End => "The chamber; both where it is left out.",
        PlaceKey::Measure => {
            "What the sensor measures; crosshead_acceleration where it is left out."
        }
        PlaceKey::Body => "What is shaken; frame where it is left out.",
        PlaceKey::Part => "Which of the two; bearing where it is left out.",
    }
}
