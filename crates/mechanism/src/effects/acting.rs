//! The effects that act at one place of a machine.
//!
//! Loops add up what they do: a closure that is handed to an iterator is compiled without the instructions of lanes, and
//! calls a function for each multiplication that is fused with an addition.

use super::acts::{Acts, JointAt, RodSpring, Shape};
use super::place::{End, Joint, Place};
use super::{Effect, Law};
use crate::declaration::Kind;
use crate::plane::{Vec2, turned};
use scalar::{Scalar, inlined};

/// The effects that act on one throw, or with none on the shaft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acting<'a, S> {
    effects: &'a [Effect<S>],
    throw: Option<usize>,
}

impl<'a, S: Scalar> Acting<'a, S> {
    /// Those that act on the throw with the index `throw`.
    #[inline(always)]
    pub fn on_throw(effects: &'a [Effect<S>], throw: usize) -> Self {
        let throw = Some(throw);
        Self { effects, throw }
    }

    /// Those that act on the shaft and what it turns in.
    #[inline(always)]
    pub fn on_shaft(effects: &'a [Effect<S>]) -> Self {
        let throw = None;
        Self { effects, throw }
    }

    #[inline(always)]
    fn wherever(self, holds: impl Fn(&Place) -> bool) -> impl Iterator<Item = &'a Law<S>> {
        let here = move |place: &Place| place.throw.is_none() || place.throw == self.throw;
        let acting = move |effect: &&'a Effect<S>| here(&effect.place) && holds(&effect.place);
        self.effects.iter().filter(acting).map(|effect| &effect.law)
    }

    /// Whether the machine has any effects. Where the compiler knows the answer, it removes the code that
    /// asks first.
    #[inline(always)]
    pub fn any(self) -> bool {
        !self.effects.is_empty()
    }

    /// Whether any of them acts on this part of the machine.
    #[inline(always)]
    pub fn any_on(self, part: Kind) -> bool {
        for effect in self.all() {
            if effect.kind() == part {
                return true;
            }
        }
        false
    }

    /// All of them.
    #[inline(always)]
    pub fn all(self) -> impl Iterator<Item = &'a Law<S>> {
        self.wherever(|_| true)
    }

    /// The spring that the throw's connecting rod is; none where it is rigid.
    #[inline(always)]
    pub fn rod(self) -> Option<RodSpring<S>> {
        if !self.any() {
            return None;
        }
        for effect in self.all() {
            let rod = effect.rod();
            if rod.is_some() {
                return rod;
            }
        }
        None
    }

    /// Acceleration of the frame, m/s²; none where it stands still.
    #[inline(always)]
    pub fn frame_acceleration(self, angle: S, speed: S) -> Option<Vec2<S>> {
        if !self.any() {
            return None;
        }
        let mut sum: Option<Vec2<S>> = None;
        for effect in self.all() {
            if let Some(more) = effect.frame_acceleration(angle, speed) {
                sum = Some(match sum {
                    Some(sum) => sum + more,
                    None => more,
                });
            }
        }
        sum
    }

    /// Place, m, and rate, m/s, of the frame that effects shake; none where they leave it alone.
    #[inline(always)]
    pub fn frame_motion(self, angle: S, speed: S) -> Option<[Vec2<S>; 2]> {
        let mut sum: Option<[Vec2<S>; 2]> = None;
        for effect in self.all() {
            if let Some(more) = effect.frame_motion(angle, speed) {
                sum = Some(match sum {
                    Some(sum) => [sum[0] + more[0], sum[1] + more[1]],
                    None => more,
                });
            }
        }
        sum
    }

    /// Those that act at a joint.
    #[inline(always)]
    pub fn at_joint(self, joint: Joint) -> impl Iterator<Item = &'a Law<S>> {
        self.wherever(move |place| place.joint.is_none_or(|j| j == joint))
    }

    /// Those that act in a chamber.
    #[inline(always)]
    pub fn at_end(self, end: End) -> impl Iterator<Item = &'a Law<S>> {
        self.wherever(move |place| place.end.is_none_or(|e| e == end))
    }
}

/// The effects at one joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtJoint<'a, S> {
    /// The effects.
    pub acting: Acting<'a, S>,
    /// The joint.
    pub joint: Joint,
    /// Where the x axes of bearing and journal point.
    pub axes: [Vec2<S>; 2],
}

impl<S: Scalar> AtJoint<'_, S> {
    /// How far the joint of this clearance, m, is out of round in the direction `normal`; none where it is round.
    #[inline(always)]
    pub fn shape(&self, normal: Vec2<S>, clearance: S) -> Option<Shape<S>> {
        if !self.acting.any() {
            return None;
        }
        let within = inlined(
            #[inline(always)]
            |axis: Vec2<S>| Vec2::new(axis.dot(&normal), turned(axis).dot(&normal)),
        );
        let [bearing, journal] = self.axes;
        let (bearing, journal) = (within(bearing), within(journal));
        let mut sum: Option<Shape<S>> = None;
        for effect in self.acting.at_joint(self.joint) {
            if let Some(more) = effect.shape(bearing, journal, clearance) {
                sum = Some(match sum {
                    Some(sum) => Shape {
                        wider: sum.wider + more.wider,
                        change: [
                            sum.change[0] + more.change[0],
                            sum.change[1] + more.change[1],
                        ],
                    },
                    None => more,
                });
            }
        }
        sum
    }

    /// Force of the film on the journal along the normal, N.
    #[inline(always)]
    pub fn film_force(&self, at: &JointAt<S>) -> S {
        if !self.acting.any() {
            return S::zero();
        }
        let mut sum = S::zero();
        for effect in self.acting.at_joint(self.joint) {
            sum += effect.film_force(at);
        }
        sum
    }
}
