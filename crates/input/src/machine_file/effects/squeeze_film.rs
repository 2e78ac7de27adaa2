//! Oil that is squeezed out of a joint.

use super::section::{Act, effect};
use crate::quantity::{AboveZero, Length, NonNegative, Number, Positive, Viscosity};
use mechanism::effects::{self, Law};

effect! {
    /// Squeeze force of the oil in a joint with clearance (short bearing); nothing in an ideal joint.
    SqueezeFilm at [throw, joint], Joint:
    "Oil in the bearing is squeezed out before the metal touches: the blows come late and soft." {
        /// Viscosity of the oil.
        viscosity: NonNegative<Viscosity>, 1e-4 to 0.2, start 0.02, absent 0.0;
        /// Length of the film along the journal: a film as long as the bearing is so stiff that
        /// nothing touches. 2 mm where it is left out.
        length: Positive<Length>, 0.0005 to 0.05, start 0.002;
        /// Share of the clearance that the roughness keeps open; 0.1 where it is left out.
        roughness: Number<AboveZero>, 0.05 to 0.5, start 0.1;
    }
}

impl Act for SqueezeFilm {
    fn law(&self) -> Option<Law> {
        Some(Law::SqueezeFilm(effects::SqueezeFilm {
            viscosity: self.viscosity(),
            length: self.length(),
            roughness: self.roughness(),
        }))
    }
}
