//! The sections of machine.yaml, and the machine that they make without effects.

use super::effects::{self, Draft, EffectSection};
use super::joints::{self, Bearing, Joints, ThrowJoints};
use super::normal_clearance::{NormalClearance, ThrowNormalClearance};
use super::sections::{Crank, Crosshead, Cylinder, FrameSection, Gravity, HousingSection, Rod};
use super::sensors::SensorSection;
use crate::error::Error;
use crate::quantity::{Angle, Frequency, Length, Positive, Pressure, Quantity, Speed};
use mechanism::{Direction, Machine, Throw};
use schemars::JsonSchema;
use serde::Deserialize;

/// A reciprocating compressor. Every physical value is a text with its unit.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sections {
    /// Name of the machine.
    pub(super) name: String,
    /// Speed of the crank; with a free crank the speed at which the motor gives its mean torque.
    pub(super) speed: Positive<Speed>,
    /// Ambient pressure at the machine, from which its gauge pressures (`20 barg`, `300 psig`) count.
    #[serde(default, rename = "ambient_pressure")]
    #[schemars(example = "1.013 bar")]
    _ambient_pressure: Option<Positive<Pressure>>,
    /// Gravity in the plane of motion.
    #[serde(default)]
    gravity: Option<Gravity>,
    /// Crank, flywheel and rotor, and what turns them.
    crank: Crank,
    /// The connecting rod.
    #[serde(default)]
    rod: Option<Rod>,
    /// Crosshead, piston rod and piston.
    #[serde(default)]
    crosshead: Option<Crosshead>,
    /// Cylinder, piston and gas.
    #[serde(default)]
    cylinder: Option<Cylinder>,
    /// The housing of the crosshead guide, for sensors on it.
    #[serde(default)]
    housing: Option<HousingSection>,
    /// The joints, ideal or with clearance.
    #[serde(default)]
    joints: Option<Joints>,
    /// The throws of a machine with several cylinders.
    #[serde(default)]
    throws: Option<Vec<ThrowSection>>,
    /// The elastically mounted frame.
    #[serde(default)]
    frame: Option<FrameSection>,
    /// What is measured.
    #[serde(default)]
    pub(super) sensors: Vec<SensorSection>,
    /// Sample rate of the recordings where a run says nothing.
    #[serde(default)]
    pub(super) sample_rate: Option<Positive<Frequency>>,
    /// Physics beyond the first model, each effect at most once at its place.
    #[serde(default)]
    pub(super) effects: Vec<EffectSection>,
}

/// Crank, rod, crosshead and cylinder of one throw. What is left out is as at the top.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ThrowSection {
    /// Name that stands before its channels and labels: a letter, then letters, digits and _.
    name: String,
    /// Which way the cylinder lies; forward where it is left out.
    #[serde(default)]
    direction: Lie,
    /// Angle of this throw's crank pin on the shaft; 0 where it is left out.
    #[serde(default)]
    crank_pin_angle: Option<Quantity<Angle>>,
    /// Crank radius, where it differs from that of the crank.
    #[serde(default)]
    #[schemars(example = "110 mm")]
    crank_radius: Option<Positive<Length>>,
    /// The connecting rod.
    rod: Rod,
    /// Crosshead, piston rod and piston.
    crosshead: Crosshead,
    /// Cylinder, piston and gas.
    cylinder: Cylinder,
    /// The housing of the crosshead guide, for sensors on it.
    #[serde(default)]
    housing: Option<HousingSection>,
    /// The joints, ideal or with clearance.
    #[serde(default)]
    joints: ThrowJoints,
}

/// Which way a throw's cylinder lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Lie {
    /// Along +x.
    #[default]
    Forward,
    /// Along −x.
    Opposed,
}

impl Sections {
    /// The machine without effects, and up to which clearances it is healthy.
    pub(super) fn machine(&self) -> Result<(Machine, NormalClearance), Error> {
        let top = self.joints.clone().unwrap_or_default();
        let main = joints::bearing(&top.main).map_err(|e| e.under("joints.main"))?;
        let crankshaft = self.crank.crankshaft(&main.joint);
        let crankshaft = crankshaft.map_err(|e| e.under("crank"))?;
        let (throws, normal) = self.throws(top)?;
        let [gravity_x, gravity_y] = self.gravity.clone().unwrap_or_default().components();
        let machine = Machine {
            crankshaft,
            drive: self.crank.drive(self.speed),
            main: main.joint,
            throws,
            gravity_x,
            gravity_y,
            frame: self.frame.as_ref().map(FrameSection::resolve),
            effects: Vec::new(),
        };
        let normal = NormalClearance {
            main: main.normal_clearance,
            throws: normal,
        };
        Ok((machine, normal))
    }

    fn throws(&self, top: Joints) -> Result<(Vec<Throw>, Vec<ThrowNormalClearance>), Error> {
        let Some(throws) = &self.throws else {
            return self.only_throw(top).map(|(t, n)| (vec![t], vec![n]));
        };
        if throws.is_empty() {
            return Err(Error::unexpected(
                "throws",
                "an empty list",
                "at least one throw",
            ));
        }
        let mut resolved = (Vec::new(), Vec::new());
        for (i, section) in throws.iter().enumerate() {
            let at = |e: Error| e.under(format_args!("throws.{i}"));
            let (throw, normal) = section.resolve(self.crank.radius).map_err(at)?;
            check_name(&throw.name, &resolved.0).map_err(at)?;
            resolved.0.push(throw);
            resolved.1.push(normal);
        }
        Ok(resolved)
    }

    fn only_throw(&self, top: Joints) -> Result<(Throw, ThrowNormalClearance), Error> {
        let throw = ThrowSection {
            name: String::new(),
            direction: Lie::Forward,
            crank_pin_angle: None,
            crank_radius: None,
            rod: self.rod.clone().ok_or_else(|| Error::missing("rod"))?,
            crosshead: self
                .crosshead
                .clone()
                .ok_or_else(|| Error::missing("crosshead"))?,
            cylinder: self
                .cylinder
                .clone()
                .ok_or_else(|| Error::missing("cylinder"))?,
            housing: self.housing.clone(),
            joints: ThrowJoints {
                big_end: top.big_end,
                small_end: top.small_end,
                guide: top.guide,
            },
        };
        throw.resolve(self.crank.radius)
    }
}

impl Draft for Sections {
    fn speed(&self) -> f64 {
        self.speed.si()
    }

    fn bearings(&mut self, place: &effects::Place) -> Result<Vec<Option<&mut Bearing>>, Error> {
        let names = self.throws.iter().flatten().map(|t| t.name.as_str());
        let only = place.throw(names)?;
        if place.joint == Some(effects::Joint::Main) {
            let joints = self.joints.as_mut();
            return Ok(vec![joints.and_then(|j| joints::section(&mut j.main))]);
        }
        let small = place.joint == Some(effects::Joint::SmallEnd);
        let Some(throws) = &mut self.throws else {
            let joints = self.joints.as_mut();
            return Ok(vec![joints.and_then(|j| match small {
                true => joints::section(&mut j.small_end),
                false => joints::section(&mut j.big_end),
            })]);
        };
        let throws = throws.iter_mut().enumerate();
        let throws = throws.filter(|(i, _)| only.is_none_or(|only| only == *i));
        let bearings = throws.map(|(_, throw)| match small {
            true => joints::section(&mut throw.joints.small_end),
            false => joints::section(&mut throw.joints.big_end),
        });
        Ok(bearings.collect())
    }
}

impl ThrowSection {
    fn resolve(&self, crank: Positive<Length>) -> Result<(Throw, ThrowNormalClearance), Error> {
        let under = |section: &'static str| move |error: Error| error.under(section);
        let crank = self.crank_radius.unwrap_or(crank);
        let joints = &self.joints;
        let big_end = joints::bearing(&joints.big_end).map_err(under("joints.big_end"))?;
        let small_end = joints::bearing(&joints.small_end).map_err(under("joints.small_end"))?;
        let guide = joints::guide(&joints.guide).map_err(under("joints.guide"))?;
        let crosshead = self.crosshead.resolve(&guide.joint, self.rod.length);
        let throw = Throw {
            crank_radius: crank.si(),
            pin_angle: self.crank_pin_angle.map_or(0.0, |angle| angle.si()),
            rod: self.rod.resolve(crank).map_err(under("rod"))?,
            crosshead: crosshead.map_err(under("crosshead"))?,
            cylinder: self.cylinder.resolve().map_err(under("cylinder"))?,
            big_end: big_end.joint,
            small_end: small_end.joint,
            guide: guide.joint,
            housing: self.housing.as_ref().map(HousingSection::resolve),
            name: self.name.clone(),
            direction: match self.direction {
                Lie::Forward => Direction::Forward,
                Lie::Opposed => Direction::Opposed,
            },
        };
        let normal = ThrowNormalClearance {
            big_end: big_end.normal_clearance,
            small_end: small_end.normal_clearance,
            guide: guide.normal_clearance,
        };
        Ok((throw, normal))
    }
}

/// Names prefix columns and are parts of dotted paths.
fn check_name(name: &str, before: &[Throw]) -> Result<(), Error> {
    let mut letters = name.chars();
    let sound = letters.next().is_some_and(|c| c.is_ascii_alphabetic())
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !sound {
        let expected = "a letter, then letters, digits and _, e.g. 'throw1'";
        return Err(Error::clash("name", expected));
    }
    if before.iter().any(|throw| throw.name == name) {
        return Err(Error::clash("name", "a name that no other throw has"));
    }
    Ok(())
}
