//! Contact and friction laws of a joint.

use super::relation::{RelationSection, Stated};
use crate::choice::{Or, Pair};
use crate::error::{Error, quoted};
use crate::quantity::{
    Contraction, Damping, FromOne, FromZero, Length, NonNegative, Number, Positive, Pressure,
    Rebound, Velocity, describe, found, text_schema,
};
use crate::unit::{self, Dimension};
use mechanism::joints::contact::{self, ContactLaw};
use mechanism::joints::friction::{self, FrictionLaw};
use mechanism::joints::stiffness::{Material, conformal, equation_5};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserialize, Deserializer, Unexpected, Visitor};
use std::borrow::Cow;
use std::fmt;

/// Normal force between two surfaces as a function of the penetration δ and its rate.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(rename = "tag:law=impact", rename_all = "snake_case")]
#[schemars(rename = "Contact", tag = "law", transform = crate::schema::default_variant)]
pub(super) enum Contact {
    /// IMPACT of ADAMS (the default): K δⁿ + STEP(δ, 0, 0, depth, damping) dδ/dt.
    Impact(Impact),
    /// K δⁿ, without loss (Hertz 1881).
    Hertz(Hertz),
    /// Linear spring and damper (Dubowsky and Freudenstein 1971).
    KelvinVoigt(KelvinVoigt),
    /// Hunt and Crossley 1975.
    HuntCrossley(Restitution),
    /// Lankarani and Nikravesh 1990.
    LankaraniNikravesh(Restitution),
    /// Flores, Machado, Silva and Martins 2011.
    Flores(Restitution),
}

/// Declares the parameters of a contact law: its own, and how they follow the clearance.
macro_rules! law {
    (
        $(#[$meta:meta])*
        struct $name:ident { $( $(#[$field_meta:meta])* $field:ident: $type:ty, )* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $( $(#[$field_meta])* $field: $type, )*
            /// How the parameters follow the clearance: eq5, conformal, constant, or a section of
            /// exponents. They do not follow it where it is left out.
            #[serde(default)]
            relation: Option<RelationSection>,
            /// Clearance at which the parameters are as they stand here; needed with a relation.
            #[serde(default)]
            at_clearance: Option<Positive<Length>>,
        }

        impl $name {
            fn stated(&self) -> Result<Option<Stated>, Error> {
                Stated::new(self.relation.as_ref(), self.at_clearance)
            }
        }
    };
}

law! {
    /// Parameters of IMPACT.
    struct Impact {
        /// Stiffness K, or what it follows from.
        stiffness: StiffnessSource,
        /// Exponent n of the penetration; 1.5 where it is left out.
        #[serde(default = "hertzian")]
        exponent: Number<FromOne>,
        /// Greatest damping.
        damping: NonNegative<Damping>,
        /// Penetration at which the damping is full.
        depth: Positive<Length>,
    }
}

law! {
    /// Parameters of the elastic law.
    struct Hertz {
        /// Stiffness K, or what it follows from.
        stiffness: StiffnessSource,
        /// Exponent n of the penetration; 1.5 where it is left out.
        #[serde(default = "hertzian")]
        exponent: Number<FromOne>,
    }
}

law! {
    /// Parameters of the linear law.
    struct KelvinVoigt {
        /// Stiffness, in N/m.
        stiffness: StiffnessSource,
        /// Damping.
        damping: NonNegative<Damping>,
    }
}

law! {
    /// Parameters of a law with a coefficient of restitution.
    struct Restitution {
        /// Stiffness K, or what it follows from.
        stiffness: StiffnessSource,
        /// Exponent n of the penetration; 1.5 where it is left out.
        #[serde(default = "hertzian")]
        exponent: Number<FromOne>,
        /// Coefficient of restitution.
        restitution: Number<Rebound>,
        /// Smallest approach speed that the damping is computed with; 1 mm/s where it is left out.
        #[serde(default)]
        slowest_approach: Option<Positive<Velocity>>,
    }
}

type StiffnessSource = Or<Stiffness, Materials>;

fn hertzian() -> Number<FromOne> {
    Number::fixed(1.5)
}

/// A stiffness N/m^n with the n of its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stiffness {
    si: f64,
    exponent: f64,
}

const STIFFNESS: &str =
    "a contact stiffness greater than 0 with its unit N/m^n, e.g. '24 GN/m^1.5'";

impl<'de> Deserialize<'de> for Stiffness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl Visitor<'_> for Text {
            type Value = Stiffness;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(STIFFNESS)
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Stiffness, E> {
                let wrong = |found: &str| E::invalid_value(Unexpected::Other(found), &self);
                let measure = unit::parse(text).map_err(|error| wrong(&found(text, &error)))?;
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
        text_schema(STIFFNESS, false, &["24 GN/m^1.5", "2.4e10 N/m^1.5"])
    }
}

/// A stiffness that follows from the materials, the journal's radius and the clearance.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Materials {
    /// Which formula.
    from: Formula,
    /// Young's modulus: one for both bodies, or a list of two.
    youngs_modulus: Pair<Positive<Pressure>>,
    /// Poisson's ratio: one for both bodies, or a list of two.
    poisson_ratio: Pair<Number<Contraction>>,
}

/// A formula for the contact stiffness of a journal in a bearing.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Formula {
    /// Eq. (5) of the papers, with the effective radius R₁R₂/(R₁ + R₂).
    Eq5,
    /// The conformal form, with R₁R₂/(R₂ − R₁): stiffer, and it falls with the clearance.
    Conformal,
}

/// The surfaces that touch.
#[derive(Clone, Copy)]
pub(super) enum Surfaces {
    /// A journal of this radius in a bearing with this clearance, m.
    Journal { radius: f64, clearance: f64 },
    /// Flat faces with this gap, m.
    Flat { clearance: f64 },
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
        match self {
            Contact::Impact(law) => law.stated(),
            Contact::Hertz(law) => law.stated(),
            Contact::KelvinVoigt(law) => law.stated(),
            Contact::HuntCrossley(law)
            | Contact::LankaraniNikravesh(law)
            | Contact::Flores(law) => law.stated(),
        }
    }

    /// The law with the parameters as they stand.
    fn law(&self, surfaces: Surfaces) -> Result<ContactLaw, Error> {
        let stiffness = |source: &StiffnessSource, exponent: f64| {
            resolve_stiffness(source, exponent, surfaces).map_err(|e| e.under("stiffness"))
        };
        let restitution = |law: &Restitution| {
            let slowest = law.slowest_approach.map_or(1e-3, |v| v.si());
            Ok::<_, Error>(contact::Restitution {
                stiffness: stiffness(&law.stiffness, law.exponent.get())?,
                exponent: law.exponent.get(),
                restitution: law.restitution.get(),
                slowest_approach: slowest,
            })
        };
        Ok(match self {
            Contact::Impact(law) => ContactLaw::Impact(contact::Impact {
                stiffness: stiffness(&law.stiffness, law.exponent.get())?,
                exponent: law.exponent.get(),
                damping: law.damping.si(),
                depth: law.depth.si(),
            }),
            Contact::Hertz(law) => ContactLaw::Hertz(contact::Hertz {
                stiffness: stiffness(&law.stiffness, law.exponent.get())?,
                exponent: law.exponent.get(),
            }),
            Contact::KelvinVoigt(law) => ContactLaw::KelvinVoigt(contact::KelvinVoigt {
                stiffness: stiffness(&law.stiffness, 1.0)?,
                damping: law.damping.si(),
            }),
            Contact::HuntCrossley(law) => ContactLaw::HuntCrossley(restitution(law)?),
            Contact::LankaraniNikravesh(law) => ContactLaw::LankaraniNikravesh(restitution(law)?),
            Contact::Flores(law) => ContactLaw::Flores(restitution(law)?),
        })
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
        Or::Section(_) if unit != Dimension::stiffness(1.5) => Err(Error::found(
            "",
            format_args!("a stiffness from materials with the exponent {exponent}"),
            format_args!("the exponent 1.5, or a stiffness in {unit}"),
        )),
        Or::Section(materials) => match surfaces {
            Surfaces::Journal { radius, clearance } => Ok(materials.stiffness(radius, clearance)),
            Surfaces::Flat { .. } => Err(Error::found(
                "",
                "a stiffness from materials",
                "a stiffness with its unit, e.g. '24 GN/m^1.5': the guide's faces have no radius",
            )),
        },
    }
}

impl Materials {
    /// Stiffness of a journal of `radius` in a bearing with `clearance` (m), N/m^1.5.
    fn stiffness(&self, radius: f64, clearance: f64) -> f64 {
        let (modulus, ratio) = (self.youngs_modulus.both(), self.poisson_ratio.both());
        let bodies = std::array::from_fn(|i| Material {
            youngs_modulus: modulus[i].si(),
            poisson_ratio: ratio[i].get(),
        });
        match self.from {
            Formula::Eq5 => equation_5(bodies, [radius, radius + clearance]),
            Formula::Conformal => conformal(bodies, radius, clearance),
        }
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
                    return Err(Error::clash("transition_speed", expected));
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
                    return Err(Error::clash("fast", expected));
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
