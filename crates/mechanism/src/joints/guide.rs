//! The crosshead guide: ideal, or with clearance above and below.
//!
//! A crosshead with clearance can shift by y and tilt by τ. It touches at its four corners: front
//! and rear (±`half_length` from the pin along the guide), top and bottom (±`half_height`). With
//! the pin at height y the corner at (ξ, ±h) stands at y + ξ sin τ ± h cos τ; the guide faces lie
//! at ±(h + c). Penetration is what a corner stands beyond its face:
//!
//! ```text
//! upper: δ =  y + ξ sin τ + h (cos τ − 1) − c        lower: δ = −y − ξ sin τ + h (cos τ − 1) − c
//! ```
//!
//! Each corner has its own normal force (along y) and friction (along x).
//! Source of the geometry: Flores, Leine and Glocker 2010, section 5 (without its rigid contact).

use super::contact::ContactLaw;
use super::friction::FrictionLaw;
use crate::lift::{Lift, parameters};

/// The guide of a crosshead.
#[derive(Clone, Debug, PartialEq)]
pub enum Guide<S = f64> {
    /// The crosshead moves along x alone.
    Ideal,
    /// The crosshead shifts and tilts between two faces.
    Clear(GuideClearance<S>),
}

parameters! {
    /// A crosshead between two faces.
    pub struct GuideClearance<S> {
        /// Gap c between crosshead and each face when centred, m.
        pub clearance: S,
        /// Half the length of the crosshead's shoes, m.
        pub half_length: S,
        /// Half the height of the crosshead, m.
        pub half_height: S,
        /// Normal force at a corner.
        pub contact: ContactLaw<S>,
        /// Friction at a corner.
        pub friction: FrictionLaw<S>,
    }
}

impl<S> Lift<S> for Guide<f64> {
    type Lifted = Guide<S>;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Guide<S> {
        let parts: Vec<&GuideClearance> = machines.iter().filter_map(|g| g.clear()).collect();
        assert!(
            parts.is_empty() || parts.len() == machines.len(),
            "machines of different build"
        );
        if parts.is_empty() {
            Guide::Ideal
        } else {
            Guide::Clear(GuideClearance::lift(&parts, pack))
        }
    }
}

impl<S> Guide<S> {
    /// The clearance, where there is one.
    pub fn clear(&self) -> Option<&GuideClearance<S>> {
        match self {
            Guide::Ideal => None,
            Guide::Clear(clearance) => Some(clearance),
        }
    }
}
