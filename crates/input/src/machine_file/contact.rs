//! Contact and friction laws of a joint.

use super::materials::{self, Formula, MATERIALS_KEY};
use super::relation::{RelationSection, Stated};
use super::surfaces::Surfaces;
use super::value::{self, Value};
use crate::choice::{Or, Pair};
use crate::error::{Error, quoted};
use crate::quantity::{
    Clearance, Contraction, FromZero, NonNegative, Number, Positive, Pressure, Velocity, describe,
    describe_error, text_schema,
};
use crate::unit::{self, Dimension};
use mechanism::declaration::Quantity;
use mechanism::joints::contact::{self, CONTACT_LAWS, ContactLaw, Entry, Parameter};
use mechanism::joints::friction::{self, FrictionLaw};
use mechanism::joints::stiffness::Material;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, Unexpected,
    VariantAccess, Visitor,
};
use serde_json::{Map, json};
use std::borrow::Cow;
use std::fmt;
use std::sync::LazyLock;

/// Normal force between two surfaces as a function of the penetration δ and its rate: the section of
/// one of [`CONTACT_LAWS`], as its declaration has it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Contact {
    /// Index of the law.
    law: usize,
    /// Stiffness K, or what it follows from; none where the law works it out.
    stiffness: Option<StiffnessSource>,
    /// The other parameters, SI, in their order.
    values: Vec<f64>,
    /// How the parameters follow the clearance: eq5, conformal, constant, or a section of exponents.
    relation: Option<RelationSection>,
    /// Clearance at which the parameters are as they stand; needed with a relation.
    at_clearance: Option<Positive<Clearance>>,
}

type StiffnessSource = Or<Stiffness, FromMaterials>;

/// Keys that every contact law has.
const RELATION: &str = "relation";
const AT_CLEARANCE: &str = "at_clearance";
/// The key that most have.
const STIFFNESS: &str = "stiffness";
/// The key of the law `cylinder` in its place.
const MODULUS: &str = "modulus";

/// Names of the laws, and the keys of each.
static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| CONTACT_LAWS.iter().map(|law| law.name).collect());
static KEYS: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| {
    let keys = |law: &Entry| {
        let declared = &law.declaration;
        let own = declared.parameters.iter().map(|parameter| parameter.key);
        let stiffness = declared.stiffness.map(|_| STIFFNESS);
        let keys = stiffness.into_iter().chain(own);
        keys.chain([MATERIALS_KEY, RELATION, AT_CLEARANCE])
            .collect()
    };
    CONTACT_LAWS.iter().map(keys).collect()
});

impl<'de> Deserialize<'de> for Contact {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Named;
        impl<'de> Visitor<'de> for Named {
            type Value = Contact;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a contact law")
            }
            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Contact, A::Error> {
                let (Law(law), content) = data.variant()?;
                content.newtype_variant_seed(Keys(law))
            }
        }
        deserializer.deserialize_enum("tag:law=impact", &NAMES, Named)
    }
}

/// The index of a law, by its name.
struct Law(usize);

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let law = NAMES.iter().position(|known| *known == name);
        law.map(Law)
            .ok_or_else(|| D::Error::unknown_variant(&name, &NAMES))
    }
}

/// The keys of the law with this index.
struct Keys(usize);

impl<'de> DeserializeSeed<'de> for Keys {
    type Value = Contact;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Contact, D::Error> {
        deserializer.deserialize_struct("Contact", &KEYS[self.0], self)
    }
}

impl<'de> Visitor<'de> for Keys {
    type Value = Contact;
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a section")
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Contact, A::Error> {
        let declared = &CONTACT_LAWS[self.0].declaration;
        let mut stated = vec![None; declared.parameters.len()];
        let (mut stiffness, mut relation, mut at_clearance) = (None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            let mut parameters = declared.parameters.iter();
            match (parameters.position(|p| p.key == key), key.as_str()) {
                (Some(i), _) => {
                    let parameter = &declared.parameters[i];
                    stated[i] = map.next_value_seed(Value(parameter.declared()))?;
                }
                (None, STIFFNESS) if declared.stiffness.is_some() => {
                    stiffness = Some(map.next_value()?);
                }
                (None, MATERIALS_KEY) => {
                    let expected = "a joint of a machine file beside it";
                    return Err(A::Error::custom(expected));
                }
                (None, RELATION) => relation = map.next_value()?,
                (None, AT_CLEARANCE) => at_clearance = map.next_value()?,
                (None, _) => return Err(A::Error::unknown_field(&key, &KEYS[self.0])),
            }
        }
        if declared.stiffness.is_some() && stiffness.is_none() {
            return Err(A::Error::missing_field(STIFFNESS));
        }
        let each = stated.into_iter().zip(declared.parameters);
        let value = |(stated, parameter): (Option<f64>, &'static Parameter)| {
            let value = stated.or(parameter.default);
            value.ok_or_else(|| A::Error::missing_field(parameter.key))
        };
        Ok(Contact {
            law: self.0,
            stiffness,
            values: each.map(value).collect::<Result<_, _>>()?,
            relation,
            at_clearance,
        })
    }
}

impl JsonSchema for Contact {
    fn schema_name() -> Cow<'static, str> {
        "Contact".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let each = CONTACT_LAWS.iter().enumerate();
        let each = each.map(|(i, law)| section(law, i == 0, generator));
        let each: Vec<Schema> = each.collect();
        json_schema!({
            "description": "Normal force between two surfaces as a function of the penetration δ and its rate.",
            "oneOf": each,
        })
    }
}

/// Schema of the section of a law; the default's need not have its name.
fn section(law: &Entry, is_default: bool, generator: &mut SchemaGenerator) -> Schema {
    let mut required: Vec<&str> = if is_default { vec![] } else { vec!["law"] };
    let mut properties = Map::new();
    // The key in whose place the materials may stand.
    let mut stands_for = None;
    properties.insert(
        "law".to_owned(),
        json!({"type": "string", "const": law.name}),
    );
    let mut add = |key: &str, words: &str, mut schema: Schema| {
        schema.insert("description".to_owned(), words.into());
        properties.insert(key.to_owned(), schema.to_value());
    };
    if let Some(words) = law.declaration.stiffness {
        add(
            STIFFNESS,
            words,
            generator.subschema_for::<StiffnessSource>(),
        );
        stands_for = Some(STIFFNESS);
    }
    for parameter in law.declaration.parameters {
        let mut schema = value::schema(parameter.declared(), generator);
        if let (Some(default), Quantity::Number) = (parameter.default, parameter.quantity) {
            schema.insert("default".to_owned(), default.into());
        }
        add(parameter.key, parameter.words, schema);
        match (parameter.default, parameter.key) {
            (None, MODULUS) => stands_for = Some(MODULUS),
            (None, key) => required.push(key),
            (Some(_), _) => {}
        }
    }
    if stands_for.is_some() {
        let schema = generator.subschema_for::<materials::Materials>();
        add(MATERIALS_KEY, materials::WORDS, schema);
    }
    add(
        RELATION,
        "How the parameters follow the clearance: eq5, conformal, constant, or a section of \
         exponents. They do not follow it where it is left out.",
        generator.subschema_for::<RelationSection>(),
    );
    add(
        AT_CLEARANCE,
        "Radial clearance at which the parameters are as they stand here; needed with a relation.",
        generator.subschema_for::<Positive<Clearance>>(),
    );
    let mut schema = json_schema!({
        "description": law.declaration.about,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if let Some(key) = stands_for {
        let one = json!([{"required": [key]}, {"required": [MATERIALS_KEY]}]);
        schema.insert("oneOf".to_owned(), one);
    }
    schema
}

/// A stiffness N/m^n with the n of its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stiffness {
    si: f64,
    exponent: f64,
}

const STIFFNESS_TEXT: &str =
    "a contact stiffness greater than 0 with its unit N/m^n, e.g. '24 GN/m^1.5'";

impl<'de> Deserialize<'de> for Stiffness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl Visitor<'_> for Text {
            type Value = Stiffness;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(STIFFNESS_TEXT)
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Stiffness, E> {
                let wrong = |found: &str| E::invalid_value(Unexpected::Other(found), &self);
                let measure =
                    unit::parse(text).map_err(|error| wrong(&describe_error(text, &error)))?;
                let exponent = measure
                    .dimension
                    .stiffness_exponent()
                    .ok_or_else(|| wrong(&format!("{} ({})", quoted(text), describe(&measure))))?;
                if measure.si <= 0.0 {
                    return Err(wrong(&quoted(text)));
                }
                Ok(Stiffness {
                    si: measure.si,
                    exponent,
                })
            }
        }
        deserializer.deserialize_str(Text)
    }
}

impl JsonSchema for Stiffness {
    fn schema_name() -> Cow<'static, str> {
        "Stiffness".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        text_schema(STIFFNESS_TEXT, false, &["24 GN/m^1.5", "2.4e10 N/m^1.5"])
    }
}

/// A stiffness that follows from elastic constants, the journal's radius and the clearance that the joint has.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FromMaterials {
    /// Which formula.
    from: Formula,
    /// Young's modulus: one for both bodies, or a list of two.
    youngs_modulus: Pair<Positive<Pressure>>,
    /// Poisson's ratio: one for both bodies, or a list of two.
    poisson_ratio: Pair<Number<Contraction>>,
}

impl Contact {
    /// The law between `surfaces`, whose clearance may differ from the one that its parameters are
    /// stated for.
    pub(super) fn resolve(&self, surfaces: Surfaces) -> Result<ContactLaw, Error> {
        match self.stated()? {
            Some(stated) => stated.carry_over(surfaces, |surfaces| self.law(surfaces)),
            None => self.law(surfaces),
        }
    }

    fn stated(&self) -> Result<Option<Stated>, Error> {
        Stated::new(self.relation.as_ref(), self.at_clearance)
    }

    /// The law with the parameters as they stand.
    fn law(&self, surfaces: Surfaces) -> Result<ContactLaw, Error> {
        let clearance = surfaces.clearance();
        let law = |stiffness: f64| {
            let surfaces = contact::Surfaces {
                stiffness,
                clearance,
            };
            let law = (CONTACT_LAWS[self.law].law)(&surfaces, &self.values);
            law.map_err(|clash| Error::clash(clash.key, clash.expected))
        };
        let Some(source) = &self.stiffness else {
            return law(1.0);
        };
        // The law's exponent says what unit its stiffness has.
        let (_, exponent) = law(1.0)?.spring();
        let stiffness = resolve_stiffness(source, exponent, surfaces);
        law(stiffness.map_err(|e| e.under("stiffness").against("exponent").against("law"))?)
    }
}

fn resolve_stiffness(
    source: &StiffnessSource,
    exponent: f64,
    surfaces: Surfaces,
) -> Result<f64, Error> {
    let unit = Dimension::stiffness(exponent);
    match source {
        Or::Scalar(given) if unit == Dimension::stiffness(given.exponent) => Ok(given.si),
        Or::Scalar(_) => Err(Error::clash(
            "",
            format_args!("a stiffness in {unit}, because the exponent is {exponent}"),
        )),
        Or::Section(_) if unit != Dimension::stiffness(1.5) => Err(Error::unexpected(
            "",
            format_args!("a stiffness from materials with the exponent {exponent}"),
            format_args!("the exponent 1.5, or a stiffness in {unit}"),
        )),
        Or::Section(materials) => match surfaces {
            Surfaces::Journal { radius, clearance } => Ok(materials.stiffness(radius, clearance)),
            Surfaces::Flat { .. } => Err(Error::unexpected(
                "",
                "a stiffness from materials",
                materials::GUIDE_NEEDS,
            )),
        },
    }
}

impl FromMaterials {
    /// Stiffness of a journal of `radius` in a bearing with `clearance` (m), N/m^1.5.
    fn stiffness(&self, radius: f64, clearance: f64) -> f64 {
        let (modulus, ratio) = (self.youngs_modulus.both(), self.poisson_ratio.both());
        let bodies = std::array::from_fn(|i| Material {
            youngs_modulus: modulus[i].si(),
            poisson_ratio: ratio[i].get(),
        });
        self.from.stiffness(bodies, radius, clearance)
    }
}

/// Friction between two surfaces as a function of the slip speed.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(rename = "tag:law=coulomb", rename_all = "snake_case")]
#[schemars(rename = "Friction", tag = "law", transform = crate::schema::default_variant)]
pub(super) enum Friction {
    /// Coulomb's law without its jump (the default): μ v / √(v² + vs²).
    Coulomb(Coulomb),
    /// Smooth surfaces.
    None(Smooth),
    /// Static and dynamic coefficient with transition speeds, as in ADAMS.
    Adams(Adams),
    /// Ambrósio 2003: no friction up to a slow slip speed, all of it from a fast one.
    Ambrosio(Ambrosio),
}

/// Nothing to say.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Smooth {}

/// Parameters of the regularised law.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Coulomb {
    /// Coefficient μ of friction.
    coefficient: Number<FromZero>,
    /// Slip speed over which the jump at rest is spread.
    slip_speed: Positive<Velocity>,
}

/// Parameters of the ADAMS law.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Adams {
    /// Static coefficient of friction.
    static_coefficient: Number<FromZero>,
    /// Dynamic coefficient of friction.
    dynamic_coefficient: Number<FromZero>,
    /// Slip speed at which the static coefficient is reached.
    stiction_speed: Positive<Velocity>,
    /// Slip speed from which the dynamic coefficient holds; above the stiction speed.
    transition_speed: Positive<Velocity>,
}

/// Parameters of Ambrósio's law.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Ambrosio {
    /// Coefficient μ of friction.
    coefficient: Number<FromZero>,
    /// Slip speed up to which there is no friction.
    slow: NonNegative<Velocity>,
    /// Slip speed from which friction is full; above the slow one.
    fast: Positive<Velocity>,
}

impl Friction {
    /// The law.
    pub(super) fn resolve(&self) -> Result<FrictionLaw, Error> {
        Ok(match self {
            Friction::None(Smooth {}) => FrictionLaw::none(),
            Friction::Coulomb(law) => FrictionLaw::Coulomb(friction::Coulomb {
                coefficient: law.coefficient.get(),
                slip_speed: law.slip_speed.si(),
            }),
            Friction::Adams(law) => {
                let (low, high) = (law.stiction_speed, law.transition_speed);
                if low.si() >= high.si() {
                    let expected = format_args!("a velocity above stiction_speed, {low}");
                    return Err(
                        Error::clash("transition_speed", expected).against("stiction_speed")
                    );
                }
                FrictionLaw::Adams(friction::Adams {
                    static_coefficient: law.static_coefficient.get(),
                    dynamic_coefficient: law.dynamic_coefficient.get(),
                    stiction_speed: low.si(),
                    transition_speed: high.si(),
                })
            }
            Friction::Ambrosio(law) => {
                if law.slow.si() >= law.fast.si() {
                    let expected = format_args!("a velocity above slow, {}", law.slow);
                    return Err(Error::clash("fast", expected).against("slow"));
                }
                FrictionLaw::Ambrosio(friction::Ambrosio {
                    coefficient: law.coefficient.get(),
                    slow: law.slow.si(),
                    fast: law.fast.si(),
                })
            }
        })
    }
}
