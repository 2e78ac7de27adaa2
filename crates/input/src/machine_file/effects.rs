//! Effects of the catalogue.

use crate::error::Error;
use crate::quantity::{Force, ForcePerPressure, FromZero, NonNegative, Number, Positive, Velocity};
use mechanism::effects::{Effect, RingFriction, ValveLoss};
use schemars::JsonSchema;
use serde::Deserialize;

/// Physics beyond the first model.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum EffectSection {
    /// Pressure drop across open valves.
    ValveLoss(ValveLossSection),
    /// Friction of piston rings and packing.
    RingFriction(RingFrictionSection),
}

/// Pressure drop over an open valve: line pressure × coefficient × (piston speed / crank-pin
/// speed)².
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ValveLossSection {
    /// Loss coefficient of the suction valve; plausible from 0 to 0.5.
    suction: Number<FromZero>,
    /// Loss coefficient of the discharge valve; plausible from 0 to 0.5.
    discharge: Number<FromZero>,
}

/// Friction of the rings: a constant part and one that grows with the gas pressure.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RingFrictionSection {
    /// Friction force without gas pressure.
    coulomb_force: NonNegative<Force>,
    /// Friction force per head-end pressure.
    per_pressure: NonNegative<ForcePerPressure>,
    /// Piston speed over which the change of sign is spread.
    slip_speed: Positive<Velocity>,
}

/// The effects of a list that names each at most once.
pub(super) fn resolve(sections: &[EffectSection]) -> Result<Vec<Effect>, Error> {
    let effects: Vec<Effect> = sections.iter().map(EffectSection::resolve).collect();
    for (i, effect) in effects.iter().enumerate() {
        let kind = std::mem::discriminant(effect);
        if let Some(first) = effects[..i]
            .iter()
            .position(|e| std::mem::discriminant(e) == kind)
        {
            let found = format_args!("the effect of effects.{first} again");
            return Err(Error::found(
                i.to_string(),
                found,
                "each effect at most once",
            ));
        }
    }
    Ok(effects)
}

impl EffectSection {
    fn resolve(&self) -> Effect {
        match self {
            Self::ValveLoss(section) => Effect::ValveLoss(ValveLoss {
                suction: section.suction.get(),
                discharge: section.discharge.get(),
            }),
            Self::RingFriction(section) => Effect::RingFriction(RingFriction {
                coulomb_force: section.coulomb_force.si(),
                per_pressure: section.per_pressure.si(),
                slip_speed: section.slip_speed.si(),
            }),
        }
    }
}
