//! The forces of rigid joints, by eliminating the small end, then the big end.

use super::joints::Joints;
use super::loads::{Loads, crosshead_give};
use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::Throw;
use crate::plane::{Mat2, Vec2, diagonal, origin, outer, turned};
use scalar::{Scalar, inlined};

/// How a joint constrains its two centres at an instant.
#[derive(Clone, Copy, Debug)]
enum Constraint<S> {
    /// Not at all: the force is known.
    Open,
    /// In both directions.
    Pinned,
    /// Along a normal, by a push along `force` (which friction tilts away from the normal).
    /// `active` is 1 while it holds.
    Following {
        normal: Vec2<S>,
        force: Vec2<S>,
        active: S,
    },
}

impl<S: Scalar> Constraint<S> {
    #[inline(always)]
    fn new(joint: &Revolute<S>, state: &JointState<S>, touching: S) -> Self {
        let following = inlined(
            #[inline(always)]
            |active| Constraint::Following {
                normal: state.normal,
                force: state.normal + turned(state.normal) * state.coefficient,
                active,
            },
        );
        match joint {
            Revolute::Ideal => Constraint::Pinned,
            Revolute::Clear(clear) => match clear.model {
                JointModel::ThreeMode => Constraint::Open,
                JointModel::TwoMode => following(touching),
                JointModel::MasslessLink => following(S::one()),
            },
        }
    }

    /// The matrix that turns the missing relative acceleration into the joint's force, given how
    /// the relative acceleration answers to that force. `Fn`, as the compiler keeps calls of a `FnOnce` out of line.
    #[inline(always)]
    fn stiffen(&self, answer: impl Fn() -> Mat2<S>) -> Option<Mat2<S>> {
        match *self {
            Constraint::Open => None,
            Constraint::Pinned => Some(answer().inverse()),
            Constraint::Following {
                normal,
                force,
                active,
            } => {
                let give = normal.dot(&(answer() * force));
                Some(outer(force, normal) * (active / give))
            }
        }
    }
}

/// The forces of rigid joints as functions of the crank pin's acceleration A:
/// big end `slope A + offset`, both as forces on the rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response<S> {
    pub slope: Mat2<S>,
    pub offset: Vec2<S>,
    /// Small-end force on the rod: `small_offset − small_slope × big-end force`.
    small_slope: Mat2<S>,
    small_offset: Vec2<S>,
}

impl<S: Scalar> Response<S> {
    /// That of joints whose forces are known.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = diagonal(S::zero(), S::zero());
        Self {
            slope: zero,
            offset: origin(),
            small_slope: zero,
            small_offset: origin(),
        }
    }

    /// Eliminates the throw's rigid joints. `touching` are the flags of big and small end.
    #[inline(always)]
    pub fn new(throw: &Throw<S>, joints: &Joints<S>, loads: &Loads<S>, touching: [S; 2]) -> Self {
        let arms = &loads.arms;
        let [of_big, of_small] = arms.shares;
        let (mass, inertia) = (throw.rod.mass, loads.rod_inertia);
        // Acceleration of an eye for a unit force: W = 1/m + (turned arm of the eye)(turned arm
        // of the force)ᵀ / I; an elastic rod gives along its axis too.
        let answer = inlined(
            #[inline(always)]
            |[eye, force]: [Vec2<S>; 2], shares: [S; 2]| {
                let light = S::one() / mass;
                let rigid = diagonal(light, light)
                    + outer(turned(eye), turned(force)) * (S::one() / inertia);
                match loads.stretch {
                    None => rigid,
                    Some(_) => {
                        let give = shares[0] * shares[1] / throw.rod.inertia;
                        rigid + outer(arms.along, arms.along) * give
                    }
                }
            },
        );
        let free = loads.free_rod(throw);
        let free_at = inlined(
            #[inline(always)]
            |eye: Vec2<S>, share: S, bias: Vec2<S>| {
                let rigid = free.0 + turned(eye) * free.1 + bias;
                match loads.stretch {
                    None => rigid,
                    Some(stretch) => rigid + arms.along * (share * stretch),
                }
            },
        );

        let mut response = Self::none();
        let small = Constraint::new(&throw.small_end, &joints.small_end, touching[1]);
        let small_answer = inlined(
            #[inline(always)]
            || answer([arms.small, arms.small_force], [of_small; 2]) + crosshead_give(throw),
        );
        if let Some(stiff) = small.stiffen(small_answer) {
            let missing = loads.free_crosshead(throw)
                - free_at(arms.small, of_small, loads.small_bias)
                - joints.small_end.normal * loads.small_target;
            response.small_offset = stiff * missing;
            response.small_slope = stiff * answer([arms.small, arms.big_force], [of_small, of_big]);
        }
        let big = Constraint::new(&throw.big_end, &joints.big_end, touching[0]);
        let through = inlined(
            #[inline(always)]
            || answer([arms.big, arms.small_force], [of_big, of_small]),
        );
        let big_answer = inlined(
            #[inline(always)]
            || answer([arms.big, arms.big_force], [of_big; 2]) - through() * response.small_slope,
        );
        if let Some(stiff) = big.stiffen(big_answer) {
            let free_eye =
                free_at(arms.big, of_big, loads.big_bias) + through() * response.small_offset;
            response.slope = stiff;
            response.offset = -(stiff * (free_eye + joints.big_end.normal * loads.big_target));
        }
        response
    }

    /// The forces of big and small end on the rod, once the crank pin's acceleration is known.
    #[inline(always)]
    pub fn forces(&self, pin: Vec2<S>) -> [Vec2<S>; 2] {
        let big = self.slope * pin + self.offset;
        [big, self.small_offset - self.small_slope * big]
    }
}
