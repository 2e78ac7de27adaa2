//! The contact of a journal in its bush from their materials.
//!
//! ```yaml
//! big_end:
//!   clearance: 0.1 mm
//!   journal_radius: 50 mm
//!   contact: {law: impact, materials: {pin: steel, bush: bronze}, damping: 2e4 N s/m, depth: 10 um}
//! ```
//!
//! The tree that a machine is read from has numbers in their place, so that sweeps, calibrations and paths need no
//! more: `stiffness`, with the `relation` that its form has to the clearance and the clearance for which it is worked
//! out; for the law `cylinder` its `modulus`.

use super::synonyms::places;
use super::written::{Mistakes, Written};
use crate::choice::Or;
use crate::error::{Error, join};
use crate::quantity::{
    Clearance, Contraction, Kind, Length, Number, Positive, Pressure, StiffnessPerRoot,
};
use crate::reader;
use crate::tree::{find, put, take};
use crate::unit::Measure;
use mechanism::joints::materials::MATERIALS;
use mechanism::joints::stiffness::{Material, composite_modulus, conformal, equation_5};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error as _};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::sync::LazyLock;

/// The key.
pub(super) const MATERIALS_KEY: &str = "materials";

/// What it is, in words.
pub(super) const WORDS: &str = "Materials of pin and bush, in the place of the stiffness (of the modulus in the law \
     cylinder), which then follows from them, the journal's radius and the clearance.";

/// What a guide needs in the place of materials.
pub(super) const GUIDE_NEEDS: &str =
    "a stiffness with its unit, e.g. '24 GN/m^1.5': the guide's faces have no radius";

/// A journal's radius over the clearance that a stiffness is worked out for where the joint states none: that of a
/// new bearing. With the relation of its form the stiffness is the same for every choice.
const RADIUS_OVER_CLEARANCE: f64 = 1000.0;

/// Materials of the two bodies of a contact.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Materials {
    /// Material of the pin or journal.
    pin: Body,
    /// Material of the bush or bearing shell.
    bush: Body,
    /// Form of the contact; conformal where it is left out.
    #[serde(default)]
    form: Formula,
}

/// A material by its name, or by its elastic constants.
type Body = Or<Named, Elastic>;

/// Elastic constants of a material.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Elastic {
    /// Young's modulus.
    youngs_modulus: Positive<Pressure>,
    /// Poisson's ratio.
    poisson_ratio: Number<Contraction>,
}

/// A formula for the contact stiffness of a journal in a bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Formula {
    /// Hertz's, of a pin in a bush: the effective radius is R₁R₂/(R₂ − R₁), and the stiffness falls with the clearance.
    #[default]
    Conformal,
    /// Eq. (5) of the papers, with R₁R₂/(R₁ + R₂): some 30 times too soft, to repeat their results.
    Eq5,
}

impl Formula {
    /// Its name, which its relation to the clearance shares.
    fn name(self) -> &'static str {
        match self {
            Self::Conformal => "conformal",
            Self::Eq5 => "eq5",
        }
    }

    /// The stiffness of a journal of this radius with this clearance, m, in N/m^1.5.
    pub(super) fn stiffness(self, bodies: [Material; 2], radius: f64, clearance: f64) -> f64 {
        match self {
            Self::Conformal => conformal(bodies, radius, clearance),
            Self::Eq5 => equation_5(bodies, [radius, radius + clearance]),
        }
    }
}

/// The index of a material of the list.
#[derive(Clone, Copy, Debug)]
struct Named(usize);

static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| MATERIALS.iter().map(|entry| entry.name).collect());

impl<'de> Deserialize<'de> for Named {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let found = NAMES.iter().position(|known| *known == name);
        found
            .map(Named)
            .ok_or_else(|| D::Error::unknown_variant(&name, &NAMES))
    }
}

impl JsonSchema for Named {
    fn schema_name() -> Cow<'static, str> {
        "MaterialName".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let each = MATERIALS.iter().map(|entry| {
            let of = entry.material;
            let constants = format!("{} GPa, {}", of.youngs_modulus / 1e9, of.poisson_ratio);
            let words = format!("{}: {constants}.", entry.words);
            json!({"type": "string", "const": entry.name, "description": words})
        });
        json_schema!({"oneOf": each.collect::<Vec<_>>()})
    }
}

/// The constants of a body.
fn material(body: &Body) -> Material {
    match body {
        Or::Scalar(Named(index)) => MATERIALS[*index].material,
        Or::Section(own) => Material {
            youngs_modulus: own.youngs_modulus.si(),
            poisson_ratio: own.poisson_ratio.get(),
        },
    }
}

/// Puts the numbers that follow from the materials of joints in their place.
pub(super) fn replace(written: &mut Written, mistakes: &mut Mistakes) {
    for place in places(&written.tree) {
        for joint in ["main", "big_end", "small_end", "guide"] {
            let joint = join(&place, &format!("joints.{joint}"));
            let contact = join(&joint, "contact");
            let key = join(&contact, MATERIALS_KEY);
            let Some(stated) = find(&written.tree, &key).cloned() else {
                continue;
            };
            let numbers = numbers(written, &joint, &stated);
            take(&mut written.tree, &key);
            match numbers {
                Ok(numbers) => {
                    for (name, value) in numbers {
                        let to = join(&contact, name);
                        if put(&mut written.tree, &to, value) {
                            written.moved(key.clone(), to);
                        }
                    }
                }
                Err(error) => mistakes.note(written, error.under(&key)),
            }
        }
    }
}

/// The keys of the contact at `joint` that follow from the materials `stated`, with their values.
fn numbers(
    written: &Written,
    joint: &str,
    stated: &Value,
) -> Result<Vec<(&'static str, Value)>, Error> {
    let materials: Materials = reader::read(stated)?;
    let bodies = [material(&materials.pin), material(&materials.bush)];
    let own = |key: &str| find(&written.tree, &format!("{joint}.contact.{key}"));
    let refuse_both = |key: &str| match own(key) {
        Some(_) => Err(Error::clash("", format_args!("it or {key}, not both"))),
        None => Ok(()),
    };
    if own("law").is_some_and(|law| law == "cylinder") {
        refuse_both("modulus")?;
        return Ok(vec![(
            "modulus",
            text::<Pressure>(composite_modulus(bodies)),
        )]);
    }
    refuse_both("stiffness")?;
    if joint.ends_with("guide") {
        return Err(Error::clash("", GUIDE_NEEDS));
    }
    let radius = radius(&written.tree, joint)?;
    let clearance = clearance(&written.tree, joint).unwrap_or(radius / RADIUS_OVER_CLEARANCE);
    let stiffness = materials.form.stiffness(bodies, radius, clearance);
    let mut numbers = vec![("stiffness", text::<StiffnessPerRoot>(stiffness))];
    if own("relation").is_none() {
        numbers.push(("relation", materials.form.name().into()));
    }
    if own("at_clearance").is_none() {
        numbers.push(("at_clearance", text::<Clearance>(clearance)));
    }
    Ok(numbers)
}

/// What stands at `key` of a joint; of a throw that does not have it, in the section that the throws share.
fn stated<'a>(tree: &'a Value, joint: &str, key: &str) -> Option<&'a Value> {
    let shared = joint
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'));
    let own = find(tree, &join(joint, key));
    own.or_else(|| find(tree, &join(shared?.1, key)))
}

/// The journal's radius, m.
fn radius(tree: &Value, joint: &str) -> Result<f64, Error> {
    let stated = stated(tree, joint, "journal_radius").and_then(Value::as_str);
    let radius = stated.and_then(|text| Positive::<Length>::parse(text).ok());
    radius.map(|radius| radius.si()).ok_or_else(|| {
        let expected =
            "a journal_radius in the section of the joint, from which the stiffness follows";
        Error::clash("", expected).against(format!("/{joint}.journal_radius"))
    })
}

/// The clearance that the joint has, or else the one up to which it is healthy, m.
fn clearance(tree: &Value, joint: &str) -> Option<f64> {
    let mut each = ["clearance", "normal_clearance"]
        .into_iter()
        .filter_map(|key| {
            let text = stated(tree, joint, key)?.as_str()?;
            Positive::<Clearance>::parse(text).ok()
        });
    each.next().map(|clearance| clearance.si())
}

fn text<K: Kind>(si: f64) -> Value {
    let dimension = K::DIMENSION;
    Measure { si, dimension }.to_string().into()
}
