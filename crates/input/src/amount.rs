//! A number as files have it where its kind is not known beforehand: with its unit, or plain.

use crate::unit::{self, Dimension, Measure};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Error, Unexpected};
use serde_json::Value;
use std::borrow::Cow;

/// A quantity with its unit, or a plain number where the machine file has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount {
    /// The number, in SI units.
    pub si: f64,
    /// Its dimension; none for a plain number.
    pub dimension: Option<Dimension>,
}

impl Amount {
    /// As it stands in a machine file, exactly.
    pub fn to_value(self) -> Value {
        match self.dimension {
            None => self.si.into(),
            Some(dimension) => {
                let si = self.si;
                Measure { si, dimension }.to_string().into()
            }
        }
    }

    /// The amount that a value of a machine file is; none where it is something else.
    pub fn from_value(value: &Value) -> Option<Self> {
        if let Some(si) = value.as_f64() {
            let dimension = None;
            return Some(Self { si, dimension });
        }
        let Measure { si, dimension } = unit::parse_clearance(value.as_str()?).ok()?;
        let dimension = Some(dimension);
        Some(Self { si, dimension })
    }
}

impl<'de> Deserialize<'de> for Amount {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const EXPECTED: &str = "a quantity with its unit, e.g. '0.1 mm', or a plain number";
        let value = Value::deserialize(deserializer)?;
        Amount::from_value(&value).ok_or_else(|| {
            let found = value.to_string();
            D::Error::invalid_value(Unexpected::Other(&found), &EXPECTED)
        })
    }
}

impl JsonSchema for Amount {
    fn schema_name() -> Cow<'static, str> {
        "Amount".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["string", "number"],
            "description": "a quantity with its unit, or a plain number where there is none",
            "examples": ["0.1 mm", "500 rpm", 0.05],
        })
    }
}
