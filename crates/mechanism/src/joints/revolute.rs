//! A pin in a bearing: ideal, or with radial clearance.

use super::contact::{ContactLaw, NormalForce};
use super::contact_guards::{CONTACT_GUARDS, contact_guards};
use super::friction::FrictionLaw;
use crate::effects::{AtJoint, JointAt, Shape};
use crate::lift::{Lift, parameters};
use crate::mode::{ContactMode, flagged};
use crate::plane::{Vec2, origin, turned};
use scalar::{Scalar, inlined};

/// A revolute joint.
#[derive(Clone, Debug, PartialEq)]
pub enum Revolute<S = f64> {
    /// Journal and bearing centres coincide.
    Ideal,
    /// The journal moves inside the bearing.
    Clear(Clearance<S>),
}

parameters! {
    /// A journal of radius R_j inside a bearing of radius R_j + c.
    pub struct Clearance<S> {
        /// Radial clearance c, m.
        pub clearance: S,
        /// Journal radius R_j, m.
        pub journal_radius: S,
        /// Normal force between the surfaces.
        pub contact: ContactLaw<S>,
        /// Tangential force between the surfaces.
        pub friction: FrictionLaw<S>,
        fixed {
            /// Which motions of the journal the joint distinguishes.
            pub model: JointModel,
        }
    }
}

/// Which motions of the journal inside its bearing a joint distinguishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum JointModel {
    /// Free flight, impact and following: all three come out of the one contact law (Miedema and
    /// Mansour 1976 name the modes; Ravn 1998 lets a continuous force produce them).
    #[default]
    ThreeMode,
    /// Free flight and following, no impact: at touch the approach velocity is lost without
    /// rebound, the journal then follows the rigid surface until the force would pull.
    TwoMode,
    /// Following only: a massless link of constant length c joins the centres (Earles and Wu
    /// 1973). It has no friction and can pull.
    MasslessLink,
}

impl<S> Lift<S> for Revolute<f64> {
    type Lifted = Revolute<S>;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Revolute<S> {
        let parts: Vec<&Clearance> = machines.iter().filter_map(|r| r.clear()).collect();
        assert!(
            parts.is_empty() || parts.len() == machines.len(),
            "machines of different build"
        );
        if parts.is_empty() {
            Revolute::Ideal
        } else {
            Revolute::Clear(Clearance::lift(&parts, pack))
        }
    }
}

impl<S> Revolute<S> {
    /// The clearance, where there is one.
    #[inline(always)]
    pub fn clear(&self) -> Option<&Clearance<S>> {
        match self {
            Revolute::Ideal => None,
            Revolute::Clear(clearance) => Some(clearance),
        }
    }

    /// True where the joint's force is not known from the offset, but makes the centres keep
    /// their distance.
    #[inline(always)]
    pub(crate) fn is_rigid(&self) -> bool {
        self.clear().is_none() || self.is_following()
    }

    /// True where the journal follows a rigid surface.
    #[inline(always)]
    pub(crate) fn is_following(&self) -> bool {
        self.clear()
            .is_some_and(|c| c.model != JointModel::ThreeMode)
    }
}

/// A joint at an instant: where the journal stands in its bearing, and the contact's forces.
#[derive(Clone, Copy, Debug)]
pub struct JointState<S> {
    /// Offset e of the journal's centre from the bearing's, m.
    pub offset: Vec2<S>,
    /// Its rate, m/s.
    pub rate: Vec2<S>,
    /// Direction n from the bearing's centre to the journal's.
    pub normal: Vec2<S>,
    /// Penetration δ = |e| − c, m.
    pub penetration: S,
    /// Its rate, m/s.
    pub penetration_rate: S,
    /// Slip speed of the surfaces, m/s.
    pub slip: S,
    /// Normal force F_N, N.
    pub normal_force: S,
    /// Friction F_T, N.
    pub friction_force: S,
    /// Force on the journal, N.
    pub force: Vec2<S>,
    /// By how much the contact law pushes more than its spring ([`pressing`]).
    pub(crate) excess: [S; 2],
    /// Power lost to damping, W.
    pub damping_power: S,
    /// Arm R_j n from the journal's centre to the point of contact, m.
    pub(crate) arm: Vec2<S>,
    /// Friction coefficient with its sign.
    pub(crate) coefficient: S,
}

/// The surfaces of a joint at an instant.
struct Surface<S> {
    normal: Vec2<S>,
    uneven: Option<Uneven<S>>,
    penetration: S,
    penetration_rate: S,
    slip: S,
}

/// What makes the surfaces of a joint differ from circles.
struct Uneven<S> {
    /// Length of the penetration's gradient.
    steepness: S,
    /// Derivative of the clearance by the angle in the journal, m/rad.
    change: S,
}

impl<S: Scalar> JointState<S> {
    /// An ideal joint.
    #[inline(always)]
    pub(crate) fn ideal() -> Self {
        let zero = S::zero();
        Self {
            offset: origin(),
            rate: origin(),
            normal: origin(),
            penetration: zero,
            penetration_rate: zero,
            slip: zero,
            normal_force: zero,
            friction_force: zero,
            force: origin(),
            excess: [zero, S::one()],
            damping_power: zero,
            arm: origin(),
            coefficient: zero,
        }
    }
}

impl<S: Scalar> Clearance<S> {
    /// Finds the joint's `state` at offset `e` (m), rate `v` (m/s), with journal and bearing turning
    /// at `spins` (rad/s).
    #[inline(never)]
    pub(crate) fn find(
        &self,
        state: &mut JointState<S>,
        offset: [Vec2<S>; 2],
        spins: [S; 2],
        mode: &ContactMode<S>,
        effects: &AtJoint<'_, S>,
    ) {
        S::vectorised(
            #[inline(always)]
            || self.find_as(self.model, state, offset, spins, mode, effects),
        )
    }

    /// As [`find`](Self::find), with the joint's model as an argument, which may be known when compiled.
    #[inline(always)]
    pub(crate) fn find_as(
        &self,
        model: JointModel,
        state: &mut JointState<S>,
        [offset, rate]: [Vec2<S>; 2],
        spins: [S; 2],
        mode: &ContactMode<S>,
        effects: &AtJoint<'_, S>,
    ) {
        let surface = self.surface(model, offset, rate, spins, effects);
        let Surface {
            normal,
            uneven,
            penetration,
            penetration_rate,
            slip,
        } = surface;
        let tangent = turned(normal);
        let coefficient = match model {
            JointModel::MasslessLink => S::zero(),
            JointModel::ThreeMode | JointModel::TwoMode => self.friction.coefficient(slip),
        };
        let NormalForce {
            raw,
            elastic,
            excess,
        } = match model {
            JointModel::ThreeMode => self.contact.force(penetration, penetration_rate, mode),
            JointModel::TwoMode | JointModel::MasslessLink => NormalForce::none(),
        };
        let pressed = flagged(mode.pressed, raw, S::zero());
        let stored = flagged(mode.touching, elastic, S::zero());
        let film = effects.film_force(&JointAt {
            penetration,
            rate: penetration_rate,
            clearance: self.clearance,
            journal_radius: self.journal_radius,
        });
        let mut arm = match model {
            JointModel::MasslessLink => origin(),
            JointModel::ThreeMode | JointModel::TwoMode => normal * self.journal_radius,
        };
        let (mut normal_force, mut film_force) = (pressed, film);
        if let Some(uneven) = uneven {
            normal_force *= uneven.steepness;
            film_force *= uneven.steepness;
            arm -= tangent * (uneven.change / uneven.steepness);
        }
        let friction_force = coefficient * normal_force;
        state.offset = offset;
        state.rate = rate;
        state.normal = normal;
        state.penetration = penetration;
        state.penetration_rate = penetration_rate;
        state.slip = slip;
        state.normal_force = normal_force;
        state.friction_force = friction_force;
        state.force = normal.mul_add(film_force - normal_force, -(tangent * friction_force));
        state.excess = excess;
        state.damping_power = (pressed - stored - film) * penetration_rate;
        state.arm = arm;
        state.coefficient = coefficient;
    }

    /// The surfaces at offset `e`, as the shapes of bearing and journal have them.
    ///
    /// With a clearance c that depends on the angles γ − φ of the direction in the bearing and γ − ψ
    /// in the journal the penetration is δ = |e| − c, and its gradient n − (c'/|e|) t the normal. The
    /// force along it has the moments −F ∂c/∂φ on the bearing and −F ∂c/∂ψ on the journal: then energy
    /// is conserved.
    #[inline(always)]
    fn surface(
        &self,
        model: JointModel,
        offset: Vec2<S>,
        rate: Vec2<S>,
        [journal, bearing]: [S; 2],
        effects: &AtJoint<'_, S>,
    ) -> Surface<S> {
        let distance = offset.norm();
        // A centred journal has no direction; any will do, as nothing acts there.
        let least = S::constant(1e-300);
        let x = S::select(distance.lt(least), least, offset.x);
        let normal = Vec2::new(x, offset.y) / distance.max(least);
        let slip = inlined(
            #[inline(always)]
            |tangent: Vec2<S>, distance: S| {
                let sliding = journal.mul_add(self.journal_radius, tangent.dot(&rate));
                (-bearing).mul_add(self.journal_radius + distance, sliding)
            },
        );
        let shape = match model {
            JointModel::ThreeMode => effects.shape(normal, self.clearance),
            JointModel::TwoMode | JointModel::MasslessLink => None,
        };
        let Some(Shape { wider, change }) = shape else {
            return Surface {
                normal,
                uneven: None,
                penetration: distance - self.clearance,
                penetration_rate: normal.dot(&rate),
                slip: slip(turned(normal), distance),
            };
        };
        // Near the centre, where nothing touches, the direction of the gradient does not matter.
        let tilt = (change[0] + change[1]) / distance.max(self.clearance * 0.1);
        let gradient = normal - turned(normal) * tilt;
        let steepness = (tilt * tilt + 1.0).sqrt();
        let normal = gradient / steepness;
        Surface {
            normal,
            uneven: Some(Uneven {
                steepness,
                change: change[1],
            }),
            penetration: distance - self.clearance - wider,
            penetration_rate: gradient.dot(&rate) + change[0] * bearing + change[1] * journal,
            slip: slip(turned(normal), normal.dot(&offset)),
        }
    }

    /// The guards of this contact in `mode`; `pull` is the following force of a rigid model, N.
    #[inline(always)]
    pub(crate) fn guards(
        &self,
        joint: &JointState<S>,
        mode: &ContactMode<S>,
        push: S,
    ) -> [S; CONTACT_GUARDS] {
        match self.model {
            JointModel::ThreeMode => contact_guards(
                &self.contact,
                &self.friction,
                joint.penetration,
                joint.excess,
                joint.slip,
                mode,
            ),
            JointModel::TwoMode => {
                let mut guards = [S::one(); CONTACT_GUARDS];
                guards[0] = flagged(mode.touching, push, -joint.penetration);
                guards
            }
            JointModel::MasslessLink => [S::one(); CONTACT_GUARDS],
        }
    }
}
