//! How contact parameters follow the clearance.
//!
//! ```yaml
//! contact:
//!   stiffness: 24 GN/m^1.5
//!   damping: 2e4 N s/m
//!   depth: 10 um
//!   relation: conformal           # or eq5, constant, {stiffness: -0.5, damping: -0.25}
//!   at_clearance: 0.1 mm          # where the three hold as they stand
//! ```

use super::surfaces::Surfaces;
use crate::choice::Or;
use crate::error::Error;
use crate::quantity::{Any, Clearance, Number, Positive};
use mechanism::joints::clearance_relation::Relation;
use mechanism::joints::contact::ContactLaw;
use schemars::JsonSchema;
use serde::Deserialize;

/// A relation by its name, or by its exponents.
pub(crate) type RelationSection = Or<RelationName, Exponents>;

/// A relation between the parameters of a contact at different clearances.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RelationName {
    /// The stiffness follows Eq. (5) of the papers: R₁R₂/(R₁ + R₂). The damping follows the patch
    /// of contact, near c^(−1/5); the depth stays.
    Eq5,
    /// The stiffness follows the conformal form: R₁R₂/(R₂ − R₁). Damping and depth keep the
    /// restitution.
    Conformal,
    /// Nothing depends on the clearance.
    Constant,
}

/// Powers of the clearance that the parameters follow.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Exponents {
    /// Exponent of the stiffness; 0 where it is left out.
    #[serde(default)]
    stiffness: Option<Number<Any>>,
    /// Exponent of the damping; 0 where it is left out.
    #[serde(default)]
    damping: Option<Number<Any>>,
    /// Exponent of IMPACT's depth; 0 where it is left out.
    #[serde(default)]
    depth: Option<Number<Any>>,
}

/// For which clearance parameters are stated, and how they follow it from there.
pub(super) struct Stated {
    relation: Relation,
    clearance: f64,
}

impl Stated {
    /// What the two keys of a contact say together; none where it has neither.
    pub(super) fn new(
        relation: Option<&RelationSection>,
        at_clearance: Option<Positive<Clearance>>,
    ) -> Result<Option<Self>, Error> {
        match (relation, at_clearance) {
            (None, None) => Ok(None),
            (None, Some(_)) => Err(Error::missing("relation")),
            (Some(_), None) => Err(Error::missing("at_clearance")),
            (Some(relation), Some(clearance)) => Ok(Some(Self {
                relation: resolve(relation),
                clearance: clearance.si(),
            })),
        }
    }

    /// The law between `surfaces`, where `law` gives it at the stated clearance. An ideal joint has
    /// no other.
    pub(super) fn carry_over(
        &self,
        surfaces: Surfaces,
        law: impl FnOnce(Surfaces) -> Result<ContactLaw, Error>,
    ) -> Result<ContactLaw, Error> {
        match (surfaces, self.relation) {
            (Surfaces::Journal { radius, clearance }, _) => {
                let stated = Surfaces::Journal {
                    radius,
                    clearance: self.clearance,
                };
                Ok(self.at(clearance, radius, law(stated)?))
            }
            (Surfaces::Flat { .. }, Relation::Equation5 | Relation::Conformal) => {
                let expected = "constant, or exponents: the guide's faces have no radius";
                Err(Error::clash("relation", expected))
            }
            (Surfaces::Flat { clearance }, _) => Ok(self.at(clearance, 0.0, law(surfaces)?)),
        }
    }

    fn at(&self, clearance: f64, radius: f64, law: ContactLaw) -> ContactLaw {
        if clearance > 0.0 {
            law.at_clearance(&self.relation, radius, [self.clearance, clearance])
        } else {
            law
        }
    }
}

fn resolve(relation: &RelationSection) -> Relation {
    let exponent = |number: Option<Number<Any>>| number.map_or(0.0, |n| n.get());
    match relation {
        Or::Scalar(RelationName::Eq5) => Relation::Equation5,
        Or::Scalar(RelationName::Conformal) => Relation::Conformal,
        Or::Scalar(RelationName::Constant) => Relation::Constant,
        Or::Section(exponents) => Relation::Powers {
            stiffness: exponent(exponents.stiffness),
            damping: exponent(exponents.damping),
            depth: exponent(exponents.depth),
        },
    }
}
