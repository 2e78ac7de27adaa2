//! The catalogue of effects as the machine file has it, one file per effect.
//!
//! A new effect is a file here and a line in [`catalogue!`]: its section (see [`section::effect!`])
//! and what it does, as methods of [`section::Act`]. If it acts in the equations of motion, its law
//! is a file and a line in [`mechanism::effects`] as well.

mod catalogue;
mod section;

pub use catalogue::{Choice, Entry, Kind, Parameter, Proposal, at_path, entry};

use super::Sections;
use crate::error::{Error, Problem};
use mechanism::effects::Effect;
use mechanism::{Machine, Throw};
use schemars::JsonSchema;
use section::{Act, Described};
pub(super) use section::{Joint, Place};
use serde::Deserialize;
use simulate::Sensor;

/// The one list of effects: it makes the modules, the sections of the machine file, and
/// [`CATALOGUE`].
macro_rules! catalogue {
    ($( $module:ident::$kind:ident, )*) => {
        $( mod $module; use $module::$kind; )*

        /// Physics beyond the first model.
        #[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub(super) enum EffectSection {
            $( #[schemars(description = <$kind as Described>::SENTENCE)] $kind(Box<$kind>), )*
        }

        /// All effects.
        pub const CATALOGUE: &[Entry] = &[$( Entry {
            name: stringify!($module),
            sentence: <$kind as Described>::SENTENCE,
            kind: <$kind as Described>::KIND,
            proposal: <$kind as Described>::PROPOSAL,
            parameters: <$kind as Described>::PARAMETERS,
            places: <$kind as Described>::PLACES,
        } ),*];

        impl EffectSection {
            fn name(&self) -> &'static str {
                match self {
                    $( Self::$kind(_) => stringify!($module), )*
                }
            }

            fn section(&self) -> &dyn Act {
                match self {
                    $( Self::$kind(section) => &**section, )*
                }
            }
        }
    };
}

catalogue! {
    valve_loss::ValveLoss,
    suction_unloading::SuctionUnloading,
    ring_leakage::RingLeakage,
    heat_transfer::HeatTransfer,
    gas_pulsation::GasPulsation,
    valve_flutter::ValveFlutter,
    ring_friction::RingFriction,
    squeeze_film::SqueezeFilm,
    guide_clearance::GuideClearance,
    extra_clearance::ExtraClearance,
    thermal_clearance::ThermalClearance,
    bearing_ovality::BearingOvality,
    rod_flexibility::RodFlexibility,
    frame_compliance::FrameCompliance,
    rotating_unbalance::RotatingUnbalance,
    misalignment::Misalignment,
    speed_fluctuation::SpeedFluctuation,
    crank_angle_offset::CrankAngleOffset,
    sensor_resonance::SensorResonance,
    sensor_gain::SensorGain,
    mains_hum::MainsHum,
    empirical_force::EmpiricalForce,
}

impl EffectSection {
    /// Whether nothing is left of it: all its amplitudes are where it vanishes.
    fn is_absent(&self) -> bool {
        let section = self.section();
        let values = section.values();
        let mut amplitudes = section.parameters().iter().zip(values);
        let mut any = false;
        amplitudes.all(|(parameter, value)| match parameter.absent {
            None => true,
            Some(absent) => {
                any = true;
                absent == value
            }
        }) && any
    }

    /// An effect must say how large it is.
    fn check(&self) -> Result<(), Error> {
        let section = self.section();
        let stated = section.stated();
        let parts = section.parameters().iter().zip(stated);
        let amplitudes: Vec<_> = parts.filter(|(p, _)| p.absent.is_some()).collect();
        match amplitudes.first() {
            Some((first, _)) if amplitudes.iter().all(|(_, stated)| !stated) => {
                let expected = None;
                Err(Error::new(first.key, Problem::Missing { expected }))
            }
            _ => Ok(()),
        }
    }
}

/// The effects of a file, each at most once at its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Effects(Vec<(usize, EffectSection)>);

impl Effects {
    /// Those of the list `sections` that are there at all.
    pub fn new(sections: &[EffectSection]) -> Result<Self, Error> {
        for (i, effect) in sections.iter().enumerate() {
            effect
                .check()
                .map_err(|e| e.under(effect.name()).under(i))?;
            let alike = |other: &EffectSection| {
                let [a, b] = [effect, other].map(EffectSection::section);
                effect.name() == other.name() && a.place() == b.place() && a.order() == b.order()
            };
            if let Some(first) = sections[..i].iter().position(alike) {
                let found = format_args!("the effect of effects.{first} again");
                let expected = "each effect at most once at its place";
                return Err(Error::found(i.to_string(), found, expected));
            }
        }
        let present = sections.iter().cloned().enumerate();
        Ok(Self(
            present.filter(|(_, effect)| !effect.is_absent()).collect(),
        ))
    }

    /// Changes what the file says, before the machine is made of it.
    pub fn prepare(&self, file: &mut Sections) -> Result<(), Error> {
        self.each(|effect| effect.section().prepare(file))
    }

    /// Changes the machine.
    pub fn act(&self, machine: &mut Machine) -> Result<(), Error> {
        self.each(|effect| {
            let section = effect.section();
            let place = section.place().resolve(&machine.throws)?;
            if let Some(law) = section.law() {
                machine.effects.push(Effect { law, place });
            }
            section.act(machine, &place)
        })
    }

    /// Changes a sensor of a machine with these throws.
    pub fn sense(&self, sensor: &mut Sensor, throws: &[Throw]) {
        let names: Vec<&str> = throws.iter().map(|t| t.name.as_str()).collect();
        for (_, effect) in &self.0 {
            effect.section().sense(sensor, &names);
        }
    }

    fn each(&self, mut act: impl FnMut(&EffectSection) -> Result<(), Error>) -> Result<(), Error> {
        let mut each = self.0.iter();
        each.try_for_each(|(i, effect)| act(effect).map_err(|e| e.under(effect.name()).under(i)))
    }
}
