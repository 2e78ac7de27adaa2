//! What a bundle says about a throw, and the sections of the machine file that it becomes.

use crate::choice::Or;
use crate::error::Error;
use crate::machine_file::RelationSection;
use crate::quantity::{
    AboveZero, Angle, Any, Bound, Contraction, Damping, FromOne, FromZero, Inertia, Length, Mass,
    Number, Pressure, Velocity, text,
};
use crate::reader;
use crate::unit::{Dimension, Measure};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// What a bundle says about a throw.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ThrowValues {
    /// Name that stands before its columns.
    #[serde(default)]
    pub(super) name: Option<String>,
    /// Number of its stage.
    #[serde(default, rename = "stage")]
    _stage: Option<u32>,
    /// Which way the cylinder lies: 1 (where it is left out) or -1.
    #[serde(default)]
    direction: Option<Number<Any>>,
    /// Angle of its crank pin on the shaft; 0 where it is left out.
    #[serde(default)]
    crank_pin_angle_rad: Option<Number<Any>>,
    /// Crank radius; half the stroke where it is left out.
    #[serde(default)]
    crank_radius_m: Option<Number<AboveZero>>,
    /// Stroke; twice the crank radius.
    #[serde(default)]
    stroke_m: Option<Number<AboveZero>>,
    /// Distance between the eyes of the rod.
    rod_length_m: Number<AboveZero>,
    /// Mass of the rod.
    rod_mass_kg: Number<AboveZero>,
    /// Distance from the big-end eye to the rod's centre of mass.
    rod_big_end_to_cg_m: Number<FromZero>,
    /// Moment of inertia of the rod about its centre of mass.
    rod_inertia_cg_kg_m2: Number<AboveZero>,
    /// Mass of crosshead, piston rod and piston.
    crosshead_mass_kg: Number<AboveZero>,
    /// Radius of the piston.
    piston_radius_m: Number<AboveZero>,
    /// Whether gas works on both sides of the piston; false where it is left out.
    #[serde(default)]
    double_acting: bool,
    /// Radius of the piston rod; of a double-acting cylinder.
    #[serde(default)]
    piston_rod_radius_m: Option<Number<AboveZero>>,
    /// Gap between piston and head at top dead centre.
    head_clearance_m: Number<AboveZero>,
    /// Gap between piston and crank-end cover at bottom dead centre; of a double-acting cylinder.
    #[serde(default)]
    crank_end_clearance_m: Option<Number<AboveZero>>,
    /// Polytropic exponent of the gas.
    polytropic_exponent: Number<AboveZero>,
    /// Polytropic exponent while the gas in the clearance expands; the other where it is left out.
    #[serde(default)]
    polytropic_expansion_exponent: Option<Number<AboveZero>>,
    /// Pressure behind a single-acting piston, and on the end of a double-acting one's rod.
    back_pressure_pa: Number<FromZero>,
    /// Radius of the crank pin; without it the big end is ideal.
    #[serde(default)]
    big_end_journal_radius_m: Option<Number<AboveZero>>,
    /// Radius of the crosshead pin; without it the small end is ideal.
    #[serde(default)]
    small_end_journal_radius_m: Option<Number<AboveZero>>,
    /// Young's modulus of journal and bearing; serves where no stiffness is given.
    #[serde(default)]
    youngs_modulus_pa: Option<Number<AboveZero>>,
    /// Poisson's ratio of journal and bearing; serves where no stiffness is given.
    #[serde(default)]
    poisson_ratio: Option<Number<Contraction>>,
    /// Exponent of the penetration, 1.5.
    #[serde(default)]
    contact_exponent: Option<Number<FromOne>>,
    /// Design value of the contact stiffness; that of Eq. (5) of the papers where it is left out.
    #[serde(default)]
    contact_stiffness_nominal_n_m15: Option<PerEnd<AboveZero>>,
    /// Design value of the greatest contact damping.
    #[serde(default)]
    contact_damping_nominal_n_s_m: Option<PerEnd<FromZero>>,
    /// Penetration at which the damping is full.
    #[serde(default)]
    contact_damping_depth_m: Option<PerEnd<AboveZero>>,
    /// How contact parameters follow the clearance, as `relation` in a machine file.
    #[serde(default)]
    #[schemars(with = "Option<RelationSection>")]
    contact_relation: Option<Value>,
    /// Clearance at which the contact parameters hold; needed with a relation.
    #[serde(default)]
    contact_at_clearance_m: Option<PerEnd<AboveZero>>,
    /// Design value of the coefficient of friction.
    #[serde(default)]
    friction_coefficient_nominal: Option<PerEnd<FromZero>>,
    /// Slip speed over which the jump of the friction at rest is spread.
    #[serde(default)]
    friction_slip_velocity_m_s: Option<PerEnd<AboveZero>>,
    /// Clearance up to which an end is healthy.
    #[serde(default)]
    normal_clearance_m: Option<PerEnd<FromZero>>,
}

/// One number for both ends of the rod, or one for each.
type PerEnd<B> = Or<Number<B>, Ends<B>>;

/// A number for each end of the rod.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, bound = "B: Bound")]
struct Ends<B> {
    big_end: Number<B>,
    small_end: Number<B>,
}

impl<B: Bound> JsonSchema for Ends<B> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{}Ends", B::NAME).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let number = generator.subschema_for::<Number<B>>();
        json_schema!({
            "type": "object",
            "properties": {"big_end": number, "small_end": number},
            "required": ["big_end", "small_end"],
            "additionalProperties": false,
        })
    }
}

impl<B: Bound> PerEnd<B> {
    fn at_end(&self, end: End) -> Number<B> {
        match (self, end) {
            (Or::Scalar(both), _) => *both,
            (Or::Section(ends), End::Big) => ends.big_end,
            (Or::Section(ends), End::Small) => ends.small_end,
        }
    }
}

/// An end of the rod.
#[derive(Clone, Copy)]
enum End {
    Big,
    Small,
}

impl ThrowValues {
    /// Rod, crosshead, cylinder and joints.
    pub(super) fn sections(&self) -> Result<Map<String, Value>, Error> {
        let mut joints = Map::new();
        for (key, radius, end) in [
            ("big_end", self.big_end_journal_radius_m, End::Big),
            ("small_end", self.small_end_journal_radius_m, End::Small),
        ] {
            if let Some(radius) = radius {
                joints.insert(key.into(), self.bearing(radius, end)?);
            }
        }
        let crosshead = json!({"mass": text::<Mass>(self.crosshead_mass_kg)});
        let sections = [
            ("rod", self.rod()),
            ("crosshead", crosshead),
            ("cylinder", self.cylinder()?),
            ("joints", joints.into()),
        ];
        Ok(sections
            .map(|(key, value)| (key.into(), value))
            .into_iter()
            .collect())
    }

    /// The sections, and what distinguishes the throw from others.
    pub(super) fn entry(&self) -> Result<Map<String, Value>, Error> {
        let mut entry = Map::new();
        entry.insert("name".into(), self.name.as_deref().into());
        entry.insert("direction".into(), self.lie()?.into());
        if let Some(angle) = self.crank_pin_angle_rad {
            entry.insert("crank_pin_angle".into(), text::<Angle>(angle));
        }
        entry.insert("crank_radius".into(), text::<Length>(self.crank_radius()?));
        entry.extend(self.sections()?);
        Ok(entry)
    }

    pub(super) fn crank_radius(&self) -> Result<Number<AboveZero>, Error> {
        let half = self
            .stroke_m
            .and_then(|stroke| Number::new(stroke.get() / 2.0));
        let Some(radius) = self.crank_radius_m.or(half) else {
            return Err(Error::missing("crank_radius_m"));
        };
        match self.stroke_m {
            Some(stroke) if (stroke.get() / radius.get() - 2.0).abs() > 1e-3 => {
                let (found, twice) = (stroke.get(), 2.0 * radius.get());
                let expected = format_args!("{twice}, twice crank_radius_m");
                Err(Error::unexpected("stroke_m", found, expected))
            }
            _ => Ok(radius),
        }
    }

    fn lie(&self) -> Result<&'static str, Error> {
        match self.direction.map_or(1.0, |sign| sign.get()) {
            1.0 => Ok("forward"),
            -1.0 => Ok("opposed"),
            other => Err(Error::unexpected("direction", other, "1 or -1")),
        }
    }

    fn rod(&self) -> Value {
        json!({
            "length": text::<Length>(self.rod_length_m),
            "mass": text::<Mass>(self.rod_mass_kg),
            "centre_of_mass": text::<Length>(self.rod_big_end_to_cg_m),
            "inertia": text::<Inertia>(self.rod_inertia_cg_kg_m2),
        })
    }

    /// The cylinder, without the pressures of a run.
    fn cylinder(&self) -> Result<Value, Error> {
        let mut cylinder = json!({
            "piston_radius": text::<Length>(self.piston_radius_m),
            "back": text::<Pressure>(self.back_pressure_pa),
            "exponent": self.polytropic_exponent.get(),
            "head_clearance": text::<Length>(self.head_clearance_m),
        });
        if let Some(exponent) = self.polytropic_expansion_exponent {
            cylinder["expansion_exponent"] = exponent.get().into();
        }
        if self.double_acting {
            let rod_radius = needed(self.piston_rod_radius_m, "piston_rod_radius_m")?;
            let clearance = needed(self.crank_end_clearance_m, "crank_end_clearance_m")?;
            cylinder["crank_end"] = json!({
                "rod_radius": text::<Length>(rod_radius),
                "clearance": text::<Length>(clearance),
            });
        } else if self.crank_end_clearance_m.is_some() {
            let expected = "true, as crank_end_clearance_m is there";
            return Err(Error::unexpected("double_acting", false, expected));
        }
        Ok(cylinder)
    }

    /// A bearing with a journal of `radius`, ideal until a run gives it a clearance.
    fn bearing(&self, radius: Number<AboveZero>, end: End) -> Result<Value, Error> {
        let coefficient = needed(
            self.friction_coefficient_nominal.as_ref(),
            "friction_coefficient_nominal",
        )?;
        let slip_speed = needed(
            self.friction_slip_velocity_m_s.as_ref(),
            "friction_slip_velocity_m_s",
        )?;
        let mut bearing = json!({
            "clearance": "ideal",
            "journal_radius": text::<Length>(radius),
            "contact": self.contact(end)?,
            "friction": {
                "law": "coulomb",
                "coefficient": coefficient.at_end(end).get(),
                "slip_speed": text::<Velocity>(slip_speed.at_end(end)),
            },
        });
        if let Some(normal) = &self.normal_clearance_m {
            bearing["normal_clearance"] = text::<Length>(normal.at_end(end));
        }
        Ok(bearing)
    }

    fn contact(&self, end: End) -> Result<Value, Error> {
        let damping = needed(
            self.contact_damping_nominal_n_s_m.as_ref(),
            "contact_damping_nominal_n_s_m",
        )?;
        let depth = needed(
            self.contact_damping_depth_m.as_ref(),
            "contact_damping_depth_m",
        )?;
        let mut contact = json!({
            "law": "impact",
            "stiffness": self.stiffness(end)?,
            "exponent": 1.5,
            "damping": text::<Damping>(damping.at_end(end)),
            "depth": text::<Length>(depth.at_end(end)),
        });
        match (&self.contact_relation, &self.contact_at_clearance_m) {
            (None, None) => {}
            (None, Some(_)) => return Err(Error::missing("contact_relation")),
            (Some(_), None) => return Err(Error::missing("contact_at_clearance_m")),
            (Some(relation), Some(clearance)) => {
                let check: Result<RelationSection, Error> = reader::read(relation);
                check.map_err(|error| error.under("contact_relation"))?;
                contact["relation"] = relation.clone();
                contact["at_clearance"] = text::<Length>(clearance.at_end(end));
            }
        }
        Ok(contact)
    }

    fn stiffness(&self, end: End) -> Result<Value, Error> {
        if let Some(exponent) = self.contact_exponent.filter(|n| n.get() != 1.5) {
            let expected = "1.5: the stiffness is in N/m^1.5";
            return Err(Error::unexpected(
                "contact_exponent",
                exponent.get(),
                expected,
            ));
        }
        let materials = (self.youngs_modulus_pa, self.poisson_ratio);
        match (&self.contact_stiffness_nominal_n_m15, materials) {
            (Some(stiffness), _) => {
                let measure = Measure {
                    si: stiffness.at_end(end).get(),
                    dimension: Dimension::stiffness(1.5),
                };
                Ok(measure.to_string().into())
            }
            (None, (Some(modulus), Some(ratio))) => Ok(json!({
                "from": "eq5",
                "youngs_modulus": text::<Pressure>(modulus),
                "poisson_ratio": ratio.get(),
            })),
            (None, _) => Err(Error::missing("contact_stiffness_nominal_n_m15")),
        }
    }
}

pub(super) fn needed<T>(value: Option<T>, key: &str) -> Result<T, Error> {
    value.ok_or_else(|| Error::missing(key))
}
