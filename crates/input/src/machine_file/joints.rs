//! The four joints: main bearing, big end, small end, crosshead guide.

use super::contact::{Contact, Friction};
use super::surfaces::Surfaces;
use crate::choice::{Ideal, Or};
use crate::error::{Error, join};
use crate::quantity::{Clearance, Length, NonNegative, Positive, text_schema};
use crate::tree::{find, put};
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::guide::{Guide, GuideClearance};
use mechanism::joints::revolute::{self, Revolute};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde::de::{Deserializer, Unexpected, Visitor};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt;

/// A section, or the word `ideal`; a joint that is left out is ideal too.
type Joint<T> = Or<Ideal, Box<T>>;

/// The joints. One that is left out is ideal.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Joints {
    /// Bearing between crankshaft and frame.
    #[serde(default)]
    pub main: Option<Joint<Bearing>>,
    /// Joint between crank pin and connecting rod.
    #[serde(default)]
    pub big_end: Option<Joint<Bearing>>,
    /// Joint between crosshead pin and connecting rod.
    #[serde(default)]
    pub small_end: Option<Joint<Bearing>>,
    /// Joint between crosshead and guide.
    #[serde(default)]
    pub guide: Option<Joint<GuideFaces>>,
}

/// The joints of one throw. One that is left out is ideal.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ThrowJoints {
    /// Joint between crank pin and connecting rod.
    #[serde(default)]
    pub big_end: Option<Joint<Bearing>>,
    /// Joint between crosshead pin and connecting rod.
    #[serde(default)]
    pub small_end: Option<Joint<Bearing>>,
    /// Joint between crosshead and guide.
    #[serde(default)]
    pub guide: Option<Joint<GuideFaces>>,
}

/// A journal in a bearing.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bearing {
    /// Radial clearance: half the difference of the diameters. `0.1 mm diametral` is 0.05 mm radial. With 0 or
    /// `ideal` the joint is ideal, and the other keys have no effect.
    clearance: Gap,
    /// Radial clearance up to which the joint counts as healthy (`0.1 mm diametral` is 0.05 mm radial); where it
    /// is left out, the clearance that the joint has in this file.
    #[serde(default)]
    normal_clearance: Option<NonNegative<Clearance>>,
    /// Radius of the journal: half the diameter of the pin.
    journal_radius: Positive<Length>,
    /// Which motions of the journal the joint distinguishes; three_mode where it is left out.
    #[serde(default)]
    model: JointModel,
    /// Normal force between the surfaces.
    contact: Contact,
    /// Friction between the surfaces; none where it is left out.
    #[serde(default)]
    friction: Option<Friction>,
}

/// A crosshead between the two faces of its guide. It touches at its four corners.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GuideFaces {
    /// Gap to each face when the crosshead is centred, half of the gaps to both together, which is `diametral`.
    /// With 0 or `ideal` the guide is ideal.
    clearance: Gap,
    /// Gap to each face up to which the guide counts as healthy; where it is left out, the gap that it has in
    /// this file.
    #[serde(default)]
    normal_clearance: Option<NonNegative<Clearance>>,
    /// Half the length of the crosshead's shoes.
    half_length: Positive<Length>,
    /// Half the height of the crosshead.
    half_height: Positive<Length>,
    /// Normal force at a corner.
    contact: Contact,
    /// Friction at a corner; none where it is left out.
    #[serde(default)]
    friction: Option<Friction>,
}

/// Which motions of the journal inside its bearing a joint distinguishes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum JointModel {
    /// Free flight, impact and following, all out of the contact law.
    #[default]
    ThreeMode,
    /// Free flight and following, without rebound.
    TwoMode,
    /// Following only: a massless link as long as the clearance joins the centres.
    MasslessLink,
}

/// A clearance; 0 for the word `ideal`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gap(NonNegative<Clearance>);

const GAP: &str = "a length of at least 0 with its unit, e.g. '0.1 mm', or 'ideal'";

impl<'de> Deserialize<'de> for Gap {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl Visitor<'_> for Text {
            type Value = Gap;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(GAP)
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Gap, E> {
                if text == "ideal" {
                    return Ok(Gap(NonNegative::ZERO));
                }
                NonNegative::parse(text)
                    .map(Gap)
                    .map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))
            }
        }
        deserializer.deserialize_str(Text)
    }
}

impl Gap {
    /// The clearance in m, if it is smaller than the body's `size`.
    fn below(self, name: &str, size: Positive<Length>) -> Result<f64, Error> {
        let Gap(clearance) = self;
        if clearance.si() < size.si() {
            return Ok(clearance.si());
        }
        let across = Positive::<Length>::new(2.0 * size.si()).unwrap_or(size);
        let expected = format_args!(
            "a radial clearance below {name}, {size}, or a diametral one below {across}"
        );
        Err(Error::clash("clearance", expected).against(name))
    }
}

impl JsonSchema for Gap {
    fn schema_name() -> Cow<'static, str> {
        "Clearance".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let length = text_schema(GAP, false, &["0.1 mm", "0.2 mm diametral"]);
        schemars::json_schema!({
            "anyOf": [length, {"const": "ideal"}]
        })
    }
}

/// The tree with the word `ideal` in the place of each joint without a clearance of which nothing else is stated than
/// sizes: the other keys have no effect, and may be left out.
pub(super) fn name_ideal(mut tree: Cow<'_, Value>) -> Cow<'_, Value> {
    let throws = tree["throws"].as_array().map_or(0, Vec::len);
    let throws = (0..throws).map(|i| format!("throws.{i}.joints"));
    for place in std::iter::once("joints".to_owned()).chain(throws) {
        let joints = find(&tree, &place).and_then(Value::as_object);
        let ideal = joints.into_iter().flatten();
        let ideal = ideal.filter(|(_, joint)| says_ideal(joint));
        let keys: Vec<String> = ideal.map(|(name, _)| join(&place, name)).collect();
        for key in keys {
            put(tree.to_mut(), &key, "ideal".into());
        }
    }
    tree
}

/// Whether the section of a joint says that it has no clearance, and has nothing but sizes besides, each of which can
/// be read.
fn says_ideal(joint: &Value) -> bool {
    let Some(section) = joint.as_object() else {
        return false;
    };
    let is_none = |text: &str| {
        text == "ideal"
            || NonNegative::<Clearance>::parse(text).is_ok_and(|clearance| clearance.si() == 0.0)
    };
    let clearance = section.get("clearance").and_then(Value::as_str);
    let size = |(key, value): (&String, &Value)| match (key.as_str(), value.as_str()) {
        ("clearance", _) => true,
        ("normal_clearance", Some(text)) => NonNegative::<Clearance>::parse(text).is_ok(),
        ("journal_radius" | "half_length" | "half_height", Some(text)) => {
            Positive::<Length>::parse(text).is_ok()
        }
        _ => false,
    };
    clearance.is_some_and(is_none) && section.iter().all(size)
}

/// A joint as the machine has it, and the clearance up to which it is healthy, m, where the file
/// states one.
pub(super) struct Fitted<T> {
    pub joint: T,
    pub normal_clearance: Option<f64>,
}

/// The bearing that a file describes.
pub(super) fn bearing(joint: &Option<Joint<Bearing>>) -> Result<Fitted<Revolute>, Error> {
    match joint {
        None | Some(Or::Scalar(Ideal)) => Ok(Fitted {
            joint: Revolute::Ideal,
            normal_clearance: None,
        }),
        Some(Or::Section(bearing)) => bearing.resolve(),
    }
}

/// The guide that a file describes.
pub(super) fn guide(joint: &Option<Joint<GuideFaces>>) -> Result<Fitted<Guide>, Error> {
    match joint {
        None | Some(Or::Scalar(Ideal)) => Ok(Fitted {
            joint: Guide::Ideal,
            normal_clearance: None,
        }),
        Some(Or::Section(guide)) => guide.resolve(),
    }
}

/// The section of a joint, where it has one.
pub(super) fn section(joint: &mut Option<Joint<Bearing>>) -> Option<&mut Bearing> {
    match joint {
        Some(Or::Section(bearing)) => Some(bearing),
        Some(Or::Scalar(Ideal)) | None => None,
    }
}

impl Bearing {
    /// The clearance, m; 0 where the joint is ideal.
    pub(super) fn gap(&self) -> f64 {
        let Gap(clearance) = self.clearance;
        clearance.si()
    }

    /// Makes the clearance larger by `more`, m; it does not fall below 0.
    pub(super) fn widen(&mut self, more: f64) {
        let wider = NonNegative::new(self.gap() + more);
        self.clearance = Gap(wider.unwrap_or(NonNegative::ZERO));
    }

    fn resolve(&self) -> Result<Fitted<Revolute>, Error> {
        let radius = self.journal_radius;
        let clearance = self.clearance.below("journal_radius", radius)?;
        let surfaces = Surfaces::Journal {
            radius: radius.si(),
            clearance,
        };
        let law = revolute::Clearance {
            clearance,
            journal_radius: radius.si(),
            contact: self
                .contact
                .resolve(surfaces)
                .map_err(|e| e.under("contact"))?,
            friction: friction(&self.friction)?,
            model: match self.model {
                JointModel::ThreeMode => revolute::JointModel::ThreeMode,
                JointModel::TwoMode => revolute::JointModel::TwoMode,
                JointModel::MasslessLink => revolute::JointModel::MasslessLink,
            },
        };
        Ok(Fitted {
            joint: if clearance > 0.0 {
                Revolute::Clear(law)
            } else {
                Revolute::Ideal
            },
            normal_clearance: self.normal_clearance.map(|c| c.si()),
        })
    }
}

impl GuideFaces {
    fn resolve(&self) -> Result<Fitted<Guide>, Error> {
        let clearance = self.clearance.below("half_height", self.half_height)?;
        let law = GuideClearance {
            clearance,
            half_length: self.half_length.si(),
            half_height: self.half_height.si(),
            contact: self
                .contact
                .resolve(Surfaces::Flat { clearance })
                .map_err(|e| e.under("contact"))?,
            friction: friction(&self.friction)?,
        };
        Ok(Fitted {
            joint: if clearance > 0.0 {
                Guide::Clear(law)
            } else {
                Guide::Ideal
            },
            normal_clearance: self.normal_clearance.map(|c| c.si()),
        })
    }
}

fn friction(law: &Option<Friction>) -> Result<FrictionLaw, Error> {
    match law {
        None => Ok(FrictionLaw::none()),
        Some(law) => law.resolve().map_err(|e| e.under("friction")),
    }
}
