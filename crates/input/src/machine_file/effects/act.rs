//! Where effects act, and what they do there.

use crate::error::Error;
use crate::machine_file::joints::Bearing;
use mechanism::effects::{self, Alternatives, Effect, Law, Oval, Shaken};
use mechanism::{Machine, Throw};
use schemars::JsonSchema;
use serde::Deserialize;
use simulate::{Measured, Sensor};

/// A joint that an effect can act at.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Joint {
    /// Crankshaft in frame.
    Main,
    /// Crank pin in rod.
    BigEnd,
    /// Crosshead pin in rod.
    SmallEnd,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum End {
    /// Between piston and head.
    Head,
    /// Between piston and crank-end cover.
    Crank,
}

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Measure {
    /// Acceleration of the crosshead along the cylinder.
    CrossheadAcceleration,
    /// Acceleration of the frame.
    FrameAcceleration,
    /// Acceleration of the housing of the crosshead guide.
    HousingAcceleration,
    /// Gas pressure.
    CylinderPressure,
}

/// What is shaken.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Body {
    /// The frame with everything on it.
    Frame,
    /// The crosshead along its guide.
    Crosshead,
}

/// A part of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Part {
    /// What the journal lies in.
    Bearing,
    /// The pin.
    Journal,
}

/// Where a section says that its effect acts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Place {
    pub throw: Option<String>,
    pub joint: Option<Joint>,
    pub end: Option<End>,
    pub measure: Option<Measure>,
    pub body: Option<Body>,
    pub part: Option<Part>,
}

impl Place {
    /// The place in a machine with these throws, which must have it.
    pub fn resolve(&self, throws: &[Throw]) -> Result<effects::Place, Error> {
        let place = effects::Place {
            throw: self.throw(throws.iter().map(|t| t.name.as_str()))?,
            joint: self.joint.map(|joint| match joint {
                Joint::Main => effects::Joint::Main,
                Joint::BigEnd => effects::Joint::BigEnd,
                Joint::SmallEnd => effects::Joint::SmallEnd,
            }),
            end: self.end.map(|end| match end {
                End::Head => effects::End::Head,
                End::Crank => effects::End::Crank,
            }),
        };
        match place.has_chamber(throws) {
            true => Ok(place),
            false => Err(Error::clash(
                "end",
                "head, or a cylinder with a crank_end: a single-acting one has no chamber there",
            )),
        }
    }

    /// What it says beyond where the effect acts.
    pub fn alternatives(&self) -> Alternatives {
        Alternatives {
            body: self.body.map(|body| match body {
                Body::Frame => Shaken::Frame,
                Body::Crosshead => Shaken::Crosshead,
            }),
            part: self.part.map(|part| match part {
                Part::Bearing => Oval::Bearing,
                Part::Journal => Oval::Journal,
            }),
        }
    }

    /// The index of the throw among those with these names; none for every throw.
    pub fn throw<'a>(&self, names: impl Iterator<Item = &'a str>) -> Result<Option<usize>, Error> {
        let Some(wanted) = &self.throw else {
            return Ok(None);
        };
        let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
        match names.iter().position(|name| name == wanted) {
            Some(index) => Ok(Some(index)),
            None => Err(Error::unknown_name("throw", wanted, &names)),
        }
    }

    /// Whether a sensor that sees `measured` is meant.
    pub fn means(&self, measured: &Measured, throws: &[&str]) -> bool {
        let kind = match self.measure.unwrap_or(Measure::CrossheadAcceleration) {
            Measure::CrossheadAcceleration => {
                matches!(measured, Measured::CrossheadAcceleration { .. })
            }
            Measure::FrameAcceleration => matches!(measured, Measured::FrameAcceleration { .. }),
            Measure::HousingAcceleration => {
                matches!(measured, Measured::HousingAcceleration { .. })
            }
            Measure::CylinderPressure => matches!(measured, Measured::CylinderPressure { .. }),
        };
        let named = measured
            .throw()
            .and_then(|throw| throws.get(throw))
            .copied();
        kind && self
            .throw
            .as_deref()
            .is_none_or(|wanted| named == Some(wanted))
    }
}

/// A machine file, as far as effects may change it before the machine is made of it.
pub(crate) trait Draft {
    /// Speed of the crank, or reference speed of a free one, rad/s.
    fn speed(&self) -> f64;

    /// The sections of the bearings at `place`; none where a joint has no section.
    fn bearings(&mut self, place: &Place) -> Result<Vec<Option<&mut Bearing>>, Error>;
}

/// What an effect does.
pub(crate) trait Act {
    /// Changes what the file says, before the machine is made of it.
    fn prepare(&self, _file: &mut dyn Draft, _place: &Place) -> Result<(), Error> {
        Ok(())
    }

    /// Changes the machine at `_place`.
    fn act(&self, _machine: &mut Machine, _place: &effects::Place) -> Result<(), Error> {
        Ok(())
    }

    /// Changes a sensor of a machine whose throws have the names `_throws`.
    fn sense(&self, _sensor: &mut Sensor, _place: &Place, _throws: &[&str]) {}
}

/// An effect that acts in the equations.
impl Act for Law {
    fn act(&self, machine: &mut Machine, place: &effects::Place) -> Result<(), Error> {
        let checked = self.check(machine, place);
        checked.map_err(|clash| Error::clash(clash.key, clash.expected))?;
        machine.effects.push(Effect {
            law: self.clone(),
            place: *place,
        });
        Ok(())
    }
}
