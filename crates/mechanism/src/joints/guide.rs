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
use super::contact_guards::{CONTACT_GUARDS, contact_guards};
use super::friction::FrictionLaw;
use crate::lift::{Lift, parameters};
use crate::mode::{ContactMode, flagged};
use crate::plane::{Vec2, moment, origin};
use scalar::Scalar;

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

/// The corners of a crosshead, as signs of (along, across): upper rear, upper front, lower rear,
/// lower front.
const CORNERS: [[f64; 2]; 4] = [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];

/// A guide at an instant.
#[derive(Clone, Copy, Debug)]
pub struct GuideState<S> {
    /// Shift y of the pin, m, and tilt τ, rad.
    pub position: Vec2<S>,
    /// Their rates, m/s and rad/s.
    pub rate: Vec2<S>,
    /// Force on the crosshead, N; of an ideal guide too.
    pub force: Vec2<S>,
    /// Moment on the crosshead about its pin, N m.
    pub moment: S,
    /// Power lost to friction, W.
    pub friction_power: S,
    /// Power lost to damping, W.
    pub damping_power: S,
    /// The four corners.
    pub corners: [CornerState<S>; 4],
}

/// One corner of a crosshead at an instant.
#[derive(Clone, Copy, Debug)]
pub struct CornerState<S> {
    /// Penetration δ, m.
    pub penetration: S,
    /// Its rate, m/s.
    pub penetration_rate: S,
    /// Normal force, N.
    pub normal_force: S,
    /// Slip speed along the guide, m/s.
    pub(crate) slip: S,
    pub(crate) excess: [S; 2],
}

impl<S: Scalar> GuideState<S> {
    /// An ideal guide, whose force is not known yet.
    #[inline(always)]
    pub(crate) fn ideal() -> Self {
        let zero = S::zero();
        let corner = CornerState {
            penetration: zero,
            penetration_rate: zero,
            normal_force: zero,
            slip: zero,
            excess: [zero, S::one()],
        };
        Self {
            position: origin(),
            rate: origin(),
            force: origin(),
            moment: zero,
            friction_power: zero,
            damping_power: zero,
            corners: [corner; 4],
        }
    }

    /// Lets go of the crosshead.
    #[inline(always)]
    pub(crate) fn release(&mut self) {
        self.force = origin();
        self.moment = S::zero();
    }
}

impl<S: Scalar> GuideClearance<S> {
    /// Finds the guide with the crosshead at `position` and `rate`, running along it at `speed`, m/s.
    #[inline(never)]
    pub(crate) fn find(
        &self,
        guide: &mut GuideState<S>,
        position: Vec2<S>,
        rate: Vec2<S>,
        speed: S,
        modes: &[ContactMode<S>; 4],
    ) {
        S::vectorised(
            #[inline(always)]
            || {
                guide.release();
                guide.friction_power = S::zero();
                guide.damping_power = S::zero();
                guide.position = position;
                guide.rate = rate;
                let (sine, cosine) = position.y.sin_cos();
                // 1 − cos τ without cancellation.
                let versine = sine * sine / (cosine + 1.0);
                for (i, ([along, across], mode)) in CORNERS.into_iter().zip(modes).enumerate() {
                    // Arm from the pin to the corner, and how far the corner has moved across.
                    let arm = Vec2::new(
                        self.half_length * cosine * along - self.half_height * sine * across,
                        self.half_length * sine * along + self.half_height * cosine * across,
                    );
                    let moved = position.x + self.half_length * sine * along
                        - self.half_height * versine * across;
                    let penetration = moved * across - self.clearance;
                    let penetration_rate = (rate.x + rate.y * arm.x) * across;
                    let slip = speed - rate.y * arm.y;
                    let law = self.contact.force(penetration, penetration_rate, mode);
                    let normal_force = flagged(mode.pressed, law.raw, S::zero());
                    let stored = flagged(mode.touching, law.elastic, S::zero());
                    let friction = self.friction.coefficient(slip) * normal_force;
                    let force = Vec2::new(-friction, normal_force * -across);
                    guide.force += force;
                    guide.moment += moment(arm, force);
                    guide.friction_power += friction * slip;
                    guide.damping_power += (normal_force - stored) * penetration_rate;
                    guide.corners[i] = CornerState {
                        penetration,
                        penetration_rate,
                        normal_force,
                        slip,
                        excess: law.excess,
                    };
                }
            },
        )
    }

    /// The guards of one corner in `mode`.
    #[inline(always)]
    pub(crate) fn guards(
        &self,
        corner: &CornerState<S>,
        mode: &ContactMode<S>,
    ) -> [S; CONTACT_GUARDS] {
        contact_guards(
            &self.contact,
            &self.friction,
            corner.penetration,
            corner.excess,
            corner.slip,
            mode,
        )
    }
}
