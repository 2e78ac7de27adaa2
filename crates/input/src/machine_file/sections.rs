//! Crank, rod, crosshead, cylinder, gravity and frame.

use crate::error::Error;
use crate::quantity::{
    AboveZero, Acceleration, Angle, Frequency, Inertia, Length, Mass, NonNegative, Number,
    Positive, Pressure, Quantity, Ratio, Speed, Torque, TorqueSlope,
};
use mechanism::drive::{Drive, GivenSpeed, MotorLine};
use mechanism::frame::Frame;
use mechanism::gas;
use mechanism::housing;
use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::Revolute;
use scalar::Scalar;
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::TAU;

/// Crank, flywheel and rotor, and what turns them.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Crank {
    /// Crank radius: half the stroke. A data sheet's `stroke` may stand in its place at the top of the file.
    pub radius: Positive<Length>,
    /// What turns the crank; `given` where it is left out.
    #[serde(default)]
    drive: DriveChoice,
    /// Mass of crankshaft and flywheel; needed where the main bearing has clearance.
    #[serde(default)]
    mass: Option<Positive<Mass>>,
    /// Distance of their centre of mass from the shaft's axis, toward the crank pin.
    #[serde(default)]
    #[schemars(example = "0.5 mm")]
    eccentricity: Option<NonNegative<Length>>,
}

/// What turns the crank.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum DriveChoice {
    /// The crank turns at the given speed, which no load changes.
    #[default]
    Given,
    /// A motor pulls on the free crank: torque = mean_torque + slope (speed − crank's speed).
    Free(Motor),
}

/// A motor on the straight part of its torque–speed line.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Motor {
    /// Moment of inertia of crankshaft, flywheel and rotor about the shaft.
    inertia: Positive<Inertia>,
    /// Torque at the machine's speed.
    mean_torque: Quantity<Torque>,
    /// Torque that the motor adds for every rad/s that the crank falls behind.
    slope: NonNegative<TorqueSlope>,
}

impl Crank {
    pub(super) fn crankshaft(&self, main: &Revolute) -> Result<mechanism::Crankshaft, Error> {
        if main.clear().is_some() && self.mass.is_none() {
            return Err(Error::missing("mass").against("/joints.main.clearance"));
        }
        if let (Some(mass), DriveChoice::Free(motor)) = (self.mass, &self.drive) {
            let words = format!(
                "{FARTHEST_FLYWHEEL} times the crank radius, {}",
                self.radius
            );
            check_inertia(
                motor.inertia,
                mass,
                FARTHEST_FLYWHEEL * self.radius.si(),
                &words,
            )
            .map_err(|error| error.under("drive.free").against("mass").against("radius"))?;
        }
        Ok(mechanism::Crankshaft {
            mass: self.mass.map_or(0.0, |m| m.si()),
            inertia: match &self.drive {
                DriveChoice::Given => 0.0,
                DriveChoice::Free(motor) => motor.inertia.si(),
            },
            eccentricity: self.eccentricity.map_or(0.0, |e| e.si()),
        })
    }

    pub(super) fn drive(&self, speed: Positive<Speed>) -> Drive {
        match &self.drive {
            DriveChoice::Given => Drive::Given(GivenSpeed {
                speed: speed.si(),
                fluctuation: Vec::new(),
            }),
            DriveChoice::Free(motor) => Drive::Free(MotorLine {
                reference_speed: speed.si(),
                mean_torque: motor.mean_torque.si(),
                slope: motor.slope.si(),
            }),
        }
    }
}

/// The connecting rod.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Rod {
    /// Distance between the centres of the two eyes.
    pub length: Positive<Length>,
    /// Mass.
    mass: Positive<Mass>,
    /// Distance from the big-end eye to the centre of mass.
    centre_of_mass: NonNegative<Length>,
    /// Moment of inertia about the centre of mass.
    inertia: Positive<Inertia>,
}

/// That `inertia` is not larger than that of the body's mass at `farthest` from the axis, which `words` say: larger ones are a
/// slip of the unit.
fn check_inertia(
    inertia: Positive<Inertia>,
    mass: Positive<Mass>,
    farthest: f64,
    words: &str,
) -> Result<(), Error> {
    let largest = mass.si() * farthest * farthest;
    if inertia.si() <= largest {
        return Ok(());
    }
    let gyration = (inertia.si() / mass.si()).sqrt();
    let expected = format_args!(
        "a moment of inertia up to {} kg m^2: the radius of gyration of {mass} would be {} m, more than {words}; check its unit",
        three_digits(largest),
        three_digits(gyration)
    );
    Err(Error::clash("inertia", expected))
}

/// A number with three digits, as messages show it.
fn three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// The farthest that mass of a crosshead's body is from its pin, as a multiple of the rod's length: beyond a piston at the far end
/// of a long piston rod.
const FARTHEST_PISTON: f64 = 5.0;

/// The farthest that mass of flywheel or rotor is from the shaft, as a multiple of the crank radius.
const FARTHEST_FLYWHEEL: f64 = 50.0;

/// The largest polytropic exponent. That of an ideal gas without loss of heat is at most 5/3, of a monatomic one; losses
/// make it smaller, leakage somewhat larger.
const STEEPEST_EXPONENT: f64 = 2.0;

impl Rod {
    /// The rod on a crank of radius `crank`.
    pub(super) fn resolve(&self, crank: Positive<Length>) -> Result<mechanism::Rod, Error> {
        let length = self.length;
        if length.si() <= crank.si() {
            let expected = format_args!("a length above the crank radius, {crank}");
            let error = Error::clash("length", expected).against("/crank.radius");
            return Err(error.against("/throws.*.crank_radius"));
        }
        if self.centre_of_mass.si() > length.si() {
            let expected = format_args!("a length up to that of the rod, {length}");
            return Err(Error::clash("centre_of_mass", expected).against("length"));
        }
        let words = format!("the rod's length, {length}");
        check_inertia(self.inertia, self.mass, length.si(), &words)
            .map_err(|error| error.against("mass").against("length"))?;
        Ok(mechanism::Rod {
            length: length.si(),
            mass: self.mass.si(),
            centre_of_mass: self.centre_of_mass.si(),
            inertia: self.inertia.si(),
        })
    }
}

/// Crosshead, crosshead pin, piston rod and piston: one body whose centre of mass is the crosshead pin.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Crosshead {
    /// Mass of all that moves to and fro without turning: crosshead, crosshead pin, piston rod, piston and rings. The
    /// connecting rod is not in it. Data sheets call it reciprocating weight.
    mass: Positive<Mass>,
    /// Moment of inertia about the pin; needed where the guide has clearance.
    #[serde(default)]
    inertia: Option<Positive<Inertia>>,
}

impl Crosshead {
    /// The crosshead in `guide` on a rod of length `rod`.
    pub(super) fn resolve(
        &self,
        guide: &Guide,
        rod: Positive<Length>,
    ) -> Result<mechanism::Crosshead, Error> {
        if let Some(inertia) = self.inertia {
            let words = format!("{FARTHEST_PISTON} times the rod's length, {rod}");
            check_inertia(inertia, self.mass, FARTHEST_PISTON * rod.si(), &words).map_err(
                |error| {
                    error
                        .against("mass")
                        .against("/rod.length")
                        .against("/throws.*.rod.length")
                },
            )?;
        }
        if guide.clear().is_some() && self.inertia.is_none() {
            let error = Error::missing("inertia").against("/joints.guide.clearance");
            return Err(error.against("/throws.*.joints.guide.clearance"));
        }
        Ok(mechanism::Crosshead {
            mass: self.mass.si(),
            inertia: self.inertia.map_or(0.0, |i| i.si()),
        })
    }
}

/// Cylinder, piston and gas. Pressures are absolute.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Cylinder {
    /// Radius of the piston: half the bore.
    piston_radius: Positive<Length>,
    /// Suction pressure, absolute. A gauge pressure such as `20 barg` needs the key ambient_pressure.
    suction: Positive<Pressure>,
    /// Discharge pressure, absolute.
    discharge: Positive<Pressure>,
    /// Pressure behind a single-acting piston, and on the end of a double-acting one's rod: the ambient one, 1.013 bar,
    /// where that side is open.
    back: NonNegative<Pressure>,
    /// Polytropic exponent of the gas.
    exponent: Number<AboveZero>,
    /// Polytropic exponent while the gas in the clearance expands; `exponent` where it is left out.
    #[serde(default)]
    #[schemars(example = 1.3)]
    expansion_exponent: Option<Number<AboveZero>>,
    /// Gap between piston and head at top dead centre, along the stroke. The clearance volume of a data sheet, in % of
    /// the swept volume, may stand in its place as `clearance_volume`: the gap is that share of the stroke.
    head_clearance: Positive<Length>,
    /// The second chamber of a double-acting cylinder.
    #[serde(default)]
    crank_end: Option<CrankEnd>,
}

/// The crank-end chamber of a double-acting cylinder.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CrankEnd {
    /// Radius of the piston rod: half its diameter.
    rod_radius: Positive<Length>,
    /// Gap between piston and crank-end cover at bottom dead centre, along the stroke; or `clearance_volume`.
    clearance: Positive<Length>,
}

impl Cylinder {
    /// Checks that no polytropic exponent is above the largest one.
    fn check_exponents(&self) -> Result<(), Error> {
        let stated = [
            ("exponent", Some(self.exponent)),
            ("expansion_exponent", self.expansion_exponent),
        ];
        let too_large = |exponent: Number<AboveZero>| exponent.get() > STEEPEST_EXPONENT;
        match stated
            .iter()
            .find(|(_, exponent)| exponent.is_some_and(too_large))
        {
            Some((key, _)) => {
                let expected =
                    format_args!("a polytropic exponent up to {STEEPEST_EXPONENT}, e.g. 1.3");
                Err(Error::clash(*key, expected))
            }
            None => Ok(()),
        }
    }

    pub(super) fn resolve(&self) -> Result<gas::Cylinder, Error> {
        let (suction, discharge, piston) = (self.suction, self.discharge, self.piston_radius);
        if discharge.si() < suction.si() {
            let expected = format_args!("a pressure of at least suction, {suction}");
            return Err(Error::clash("discharge", expected).against("suction"));
        }
        self.check_exponents()?;
        let crank_end = match &self.crank_end {
            Some(end) if end.rod_radius.si() >= piston.si() => {
                let expected = format_args!("a length below piston_radius, {piston}");
                return Err(Error::clash("crank_end.rod_radius", expected).against("piston_radius"));
            }
            other => other.as_ref().map(|end| gas::CrankEnd {
                rod_radius: end.rod_radius.si(),
                clearance: end.clearance.si(),
            }),
        };
        Ok(gas::Cylinder {
            piston_radius: piston.si(),
            suction: suction.si(),
            discharge: discharge.si(),
            back: self.back.si(),
            exponent: self.exponent.get(),
            expansion_exponent: self.expansion_exponent.unwrap_or(self.exponent).get(),
            head_clearance: self.head_clearance.si(),
            crank_end,
        })
    }
}

/// Gravity in the plane of motion; 9.81 m/s^2 at -90 deg where the section is left out.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Gravity {
    /// Its size; 9.81 m/s^2 where it is left out.
    #[serde(default)]
    acceleration: Option<NonNegative<Acceleration>>,
    /// Direction in which things fall, counter-clockwise from the cylinder's axis (x, toward the
    /// head): -90 deg for a horizontal machine (where it is left out), 180 deg for a vertical one
    /// with the cylinder on top.
    #[serde(default)]
    direction: Option<Quantity<Angle>>,
}

impl Gravity {
    /// Acceleration along x and y, m/s².
    pub(super) fn components(&self) -> [f64; 2] {
        let size = self.acceleration.map_or(9.81, |g| g.si());
        let angle = self.direction.map_or(-TAU / 4.0, |d| d.si());
        let (sine, cosine) = Scalar::sin_cos(angle);
        // Quarter turns are exact: what rounding leaves of them is not a component.
        [cosine, sine].map(|part| if part.abs() < 1e-15 { 0.0 } else { size * part })
    }
}

/// The elastically mounted frame. It is shaken by the machine and does not act back.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FrameSection {
    /// Mass of the frame.
    mass: Positive<Mass>,
    /// How it swings along the cylinder.
    x: Resonance,
    /// How it swings across the cylinder.
    y: Resonance,
}

/// A mass on a spring and a damper.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Resonance {
    /// Natural frequency without damping.
    pub frequency: Positive<Frequency>,
    /// Damping as a share of the critical one.
    pub damping_ratio: NonNegative<Ratio>,
}

impl FrameSection {
    pub(super) fn resolve(&self) -> Frame {
        let mass = self.mass.si();
        let stiffness = |r: &Resonance| mass * (TAU * r.frequency.si()) * (TAU * r.frequency.si());
        let damping = |r: &Resonance| 2.0 * r.damping_ratio.si() * mass * (TAU * r.frequency.si());
        Frame {
            mass,
            stiffness_x: stiffness(&self.x),
            stiffness_y: stiffness(&self.y),
            damping_x: damping(&self.x),
            damping_y: damping(&self.y),
            hardening: 0.0,
            carries: false,
        }
    }
}

/// The housing of the crosshead guide with distance piece and cylinder, as sensors on it feel it. The throw shakes it, and it
/// stands on the frame. It does not act back.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct HousingSection {
    /// Effective mass: that of a body which the force of the guide accelerates as the housing where the sensor sits.
    mass: Positive<Mass>,
    /// How it swings along the cylinder.
    x: Swing,
    /// How it swings across the guide.
    y: Swing,
}

/// A mass on a spring and a damper that swings itself out.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Swing {
    /// Natural frequency without damping.
    frequency: Positive<Frequency>,
    /// Damping as a share of the critical one.
    damping_ratio: Positive<Ratio>,
}

impl HousingSection {
    pub(super) fn resolve(&self) -> housing::Housing {
        let swing = |swing: &Swing| housing::Swing {
            frequency: TAU * swing.frequency.si(),
            damping_ratio: swing.damping_ratio.si(),
        };
        housing::Housing {
            mass: self.mass.si(),
            x: swing(&self.x),
            y: swing(&self.y),
        }
    }
}
