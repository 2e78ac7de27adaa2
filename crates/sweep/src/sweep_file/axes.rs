//! What a block of cases goes through.

use super::values::{Draw, Levels};
use input::choice::Count;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// Cases that belong together.
#[derive(Clone, Debug, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Block {
    /// Every combination of the axes' values (full factorial).
    Grid(Axes<Levels>),
    /// The first values of all axes, the second values, and so on.
    Zip(Axes<Levels>),
    /// Values drawn at random.
    Random(Random),
}

impl Block {
    /// What its cases set, as its axes are named.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::Grid(axes) | Self::Zip(axes) => axes.names().collect(),
            Self::Random(random) => random.axes.names().collect(),
        }
    }
}

/// Cases whose values are drawn at random.
#[derive(Clone, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Random {
    /// The design of experiments; default sobol.
    #[serde(default)]
    pub design: Design,
    /// Number of cases.
    pub count: Count<1, { u32::MAX }>,
    /// What is drawn.
    pub axes: Axes<Draw>,
}

/// A design of experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Sobol's sequence with Owen's scrambling: fills space evenly; at most 64 draws a case.
    #[default]
    Sobol,
    /// Each draw falls once into each of as many strata as there are cases.
    LatinHypercube,
    /// Independent draws.
    Random,
}

/// What is set, in the order of the file: `joints` (which joints have the clearance), `clearance`,
/// `load` (suction and discharge pressure), a key of a joint (`contact.damping`: that of every joint
/// that `joints` names), or any path of the machine file (`speed`, `joints.big_end.contact.damping`).
#[derive(Clone, Debug)]
pub struct Axes<T>(pub Vec<(String, T)>);

impl<T> Default for Axes<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Axes<T> {
    /// The values of the axis `joints`, where there is one.
    pub fn joints(&self) -> Option<&T> {
        let joints = self.0.iter().find(|(name, _)| name == "joints");
        joints.map(|(_, values)| values)
    }

    /// The names of all axes.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }

    /// The other axes.
    pub fn others(&self) -> impl Iterator<Item = (&str, &T)> {
        let named = self.0.iter().map(|(name, values)| (name.as_str(), values));
        named.filter(|(name, _)| *name != "joints")
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Axes<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Section<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Section<T> {
            type Value = Axes<T>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a section of paths and their values")
            }
            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
                let mut axes = Vec::new();
                while let Some(axis) = map.next_entry()? {
                    axes.push(axis);
                }
                Ok(Axes(axes))
            }
        }
        deserializer.deserialize_map(Section(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for Axes<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("AxesOf{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let values = generator.subschema_for::<T>();
        json_schema!({
            "type": "object",
            "description": "joints, clearance (radial; 0.1 mm diametral is 0.05 mm), load, keys of the joints such as contact.damping, or paths of the machine file, and their values",
            "additionalProperties": values,
        })
    }
}
