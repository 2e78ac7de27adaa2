//! machine.yaml: a compressor with its sensors, every value with its unit.
//!
//! A machine of one throw has the sections `rod`, `crosshead`, `cylinder` and `joints` at the top.
//! A machine of several has a list `throws`; what stands at the top then holds for every throw
//! that does not say otherwise, key by key.

mod contact;
pub(crate) mod effects;
mod joints;
mod relation;
mod sections;
mod sensors;
mod shared;
mod value;

use crate::error::Error;
use crate::quantity::{Angle, Frequency, Length, Positive, Quantity, Speed};
use crate::yaml::{self, Document};
use crate::{reader, schema};
use effects::{EffectSection, Effects};
use joints::{Bearing, Joints, ThrowJoints};
use mechanism::{Direction, Machine, Throw};
pub(crate) use relation::RelationSection;
use schemars::JsonSchema;
use sections::{Crank, Crosshead, Cylinder, FrameSection, Gravity, Rod};
use sensors::SensorSection;
use serde::Deserialize;
use serde_json::Value;
use simulate::{Chain, Measured, Sensor};
use std::path::Path;

/// A reciprocating compressor. Every physical value is a text with its unit.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sections {
    /// Name of the machine.
    name: String,
    /// Speed of the crank; with a free crank the speed at which the motor gives its mean torque.
    speed: Positive<Speed>,
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
    sensors: Vec<SensorSection>,
    /// Sample rate of the recordings where a run says nothing.
    #[serde(default)]
    sample_rate: Option<Positive<Frequency>>,
    /// Physics beyond the first model, each effect at most once at its place.
    #[serde(default)]
    effects: Vec<EffectSection>,
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
    crank_radius: Option<Positive<Length>>,
    /// The connecting rod.
    rod: Rod,
    /// Crosshead, piston rod and piston.
    crosshead: Crosshead,
    /// Cylinder, piston and gas.
    cylinder: Cylinder,
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

/// A machine file whose keys, units and ranges have been checked one by one.
#[derive(Clone, Debug)]
pub struct MachineFile {
    document: Document,
    sections: Sections,
}

/// What a machine file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// The machine's name.
    pub name: String,
    /// Speed of the crank, or reference speed of a free one, rad/s.
    pub speed: f64,
    /// The machine in SI units.
    pub machine: Machine,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Sample rate at which it is recorded, Hz; none where the file states none.
    pub sample_rate: Option<f64>,
    /// Up to which clearances it is healthy.
    pub normal_clearance: NormalClearance,
    effects: Effects,
}

impl Resolved {
    /// A sensor that is perfect but for what the effects make of it.
    pub fn perfect_sensor(&self, measured: Measured) -> Sensor {
        let chain = Chain::default();
        let mut sensor = Sensor { measured, chain };
        self.effects.sense(&mut sensor, &self.machine.throws);
        sensor
    }
}

/// Clearances up to which joints count as healthy, m, where the file states them. Of a joint
/// without one, the clearance that it has in the machine file is normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalClearance {
    /// Of the main bearing.
    pub main: Option<f64>,
    /// Of each throw's joints.
    pub throws: Vec<ThrowNormalClearance>,
}

/// Clearances up to which the joints of a throw count as healthy, m, where the file states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrowNormalClearance {
    /// Of the big end.
    pub big_end: Option<f64>,
    /// Of the small end.
    pub small_end: Option<f64>,
    /// Of the crosshead guide.
    pub guide: Option<f64>,
}

/// Reads the machine file at `path`.
///
/// # Errors
/// The first key, unit or value that cannot stand where it does, with its line.
pub fn read(path: &Path) -> Result<MachineFile, Error> {
    MachineFile::from_document(Document::open(path)?)
}

impl MachineFile {
    /// Reads the text of a machine file that messages call `file_name`.
    ///
    /// # Errors
    /// As [`read`].
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, Error> {
        Self::from_document(Document::parse(text, file_name)?)
    }

    /// The machine file with the content `tree`, which a sweep may have changed.
    ///
    /// # Errors
    /// As [`read`], without lines.
    pub fn from_tree(tree: &Value) -> Result<Self, Error> {
        Self::from_document(Document::from_tree(tree.clone()))
    }

    fn from_document(document: Document) -> Result<Self, Error> {
        let spread = shared::spread(&document.tree);
        match reader::read(&spread) {
            Ok(sections) => Ok(Self { document, sections }),
            Err(error) => Err(locate(&document, error)),
        }
    }

    /// The file's content, as it is written.
    pub fn to_tree(&self) -> &Value {
        &self.document.tree
    }

    /// The file's content as YAML: reading it gives the same machine.
    ///
    /// # Errors
    /// Where the content has a form that YAML cannot hold.
    pub fn to_yaml(&self) -> Result<String, Error> {
        yaml::to_string(&self.document.tree)
    }

    /// The machine, its sensors and its limits, in SI units.
    ///
    /// # Errors
    /// The first value that does not go together with the others, with its line: a rod shorter
    /// than its crank, a clearance wider than its journal, ...
    pub fn resolve(&self) -> Result<Resolved, Error> {
        self.sections
            .resolve()
            .map_err(|error| locate(&self.document, error))
    }
}

/// `error` where the file has it: with its line, in a section shared by the throws if it stands
/// there, and with what belongs in the place of a missing key.
fn locate(document: &Document, error: Error) -> Error {
    let key = shared::written_key(&document.tree, error.key()).to_owned();
    let error = error.with_key(key.clone());
    document.locate(error.expecting(|| schema::Node::machine().walk(&key)?.expected()))
}

impl Sections {
    /// The machine with its effects.
    fn resolve(&self) -> Result<Resolved, Error> {
        let under = |error: Error| error.under("effects");
        let effects = Effects::new(&self.effects).map_err(under)?;
        let mut prepared = self.clone();
        effects.prepare(&mut prepared).map_err(under)?;
        let (mut machine, normal_clearance) = prepared.machine()?;
        effects.act(&mut machine).map_err(under)?;
        let sensors = sensors::resolve(&self.sensors, &machine);
        let mut sensors = sensors.map_err(|e| e.under("sensors"))?;
        for sensor in &mut sensors {
            effects.sense(sensor, &machine.throws);
        }
        Ok(Resolved {
            name: self.name.clone(),
            speed: self.speed.si(),
            machine,
            sensors,
            sample_rate: self.sample_rate.map(|rate| rate.si()),
            normal_clearance,
            effects,
        })
    }

    /// The machine without effects, and up to which clearances it is healthy.
    fn machine(&self) -> Result<(Machine, NormalClearance), Error> {
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

    /// The sections of the bearings at `place`; none where a joint has no section.
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

    fn throws(&self, top: Joints) -> Result<(Vec<Throw>, Vec<ThrowNormalClearance>), Error> {
        let Some(throws) = &self.throws else {
            return self.only_throw(top).map(|(t, n)| (vec![t], vec![n]));
        };
        if throws.is_empty() {
            return Err(Error::found(
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
            joints: ThrowJoints {
                big_end: top.big_end,
                small_end: top.small_end,
                guide: top.guide,
            },
        };
        throw.resolve(self.crank.radius)
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
        let crosshead = self.crosshead.resolve(&guide.joint);
        let throw = Throw {
            crank_radius: crank.si(),
            pin_angle: self.crank_pin_angle.map_or(0.0, |angle| angle.si()),
            rod: self.rod.resolve(crank).map_err(under("rod"))?,
            crosshead: crosshead.map_err(under("crosshead"))?,
            cylinder: self.cylinder.resolve().map_err(under("cylinder"))?,
            big_end: big_end.joint,
            small_end: small_end.joint,
            guide: guide.joint,
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
