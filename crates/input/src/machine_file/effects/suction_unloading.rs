//! A suction valve that closes late.

use super::section::{Act, effect};
use crate::quantity::{Angle, Bound, FromZero, Number, Quantity};
use mechanism::effects::{self, Law};
use schemars::Schema;

/// Angles from 0, below half a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::machine_file) struct OnTheStroke;

impl Bound for OnTheStroke {
    const NAME: &'static str = "Stroke";
    const WORDS: &'static str = " from 0 to 170 deg";
    fn holds(value: f64) -> bool {
        (0.0..=2.968).contains(&value)
    }
    fn keywords(_: &mut Schema) {}
}

effect! {
    /// Suction valve held open into the compression stroke: gas flows back into the suction line.
    SuctionUnloading at [throw, end], Gas, PerEnd:
    "The suction valve closes late, or is held open: part of the gas is pushed back before the compression starts." {
        /// Crank angle after the dead centre at which the valve closes.
        held: Quantity<Angle, OnTheStroke>, 0.02 to 2.5, start 0.5, absent 0.0;
        /// Loss coefficient of the valve while it is held; 0 where it is left out.
        loss: Number<FromZero>, 0.002 to 0.5, start 0.05, absent 0.0;
    }
}

impl Act for SuctionUnloading {
    fn law(&self) -> Option<Law> {
        Some(Law::SuctionUnloading(effects::SuctionUnloading {
            held: self.held(),
            loss: self.loss(),
        }))
    }
}
