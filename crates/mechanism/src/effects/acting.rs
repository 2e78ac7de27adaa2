//! The effects that act at one place of a machine.

use super::acts::{Acts, JointAt, RodSpring, Shape};
use super::place::{End, Joint, Place};
use super::{Effect, Law};
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
        self.all().find_map(|effect| effect.rod())
    }

    /// Acceleration of the frame, m/s²; none where it stands still.
    #[inline(always)]
    pub fn frame_acceleration(self, angle: S, speed: S) -> Option<Vec2<S>> {
        if !self.any() {
            return None;
        }
        let moves = self
            .all()
            .filter_map(|effect| effect.frame_acceleration(angle, speed));
        moves.reduce(|sum, more| sum + more)
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
    /// How far the joint is out of round in the direction `normal`; none where it is round.
    #[inline(always)]
    pub fn shape(&self, normal: Vec2<S>) -> Option<Shape<S>> {
        if !self.acting.any() {
            return None;
        }
        let within = inlined(
            #[inline(always)]
            |axis: Vec2<S>| Vec2::new(axis.dot(&normal), turned(axis).dot(&normal)),
        );
        let [bearing, journal] = self.axes;
        let effects = self.acting.at_joint(self.joint);
        let shapes = effects.filter_map(|effect| effect.shape(within(bearing), within(journal)));
        shapes.reduce(
            #[inline(always)]
            |a, b| Shape {
                wider: a.wider + b.wider,
                change: [a.change[0] + b.change[0], a.change[1] + b.change[1]],
            },
        )
    }

    /// Force of the film on the journal along the normal, N.
    #[inline(always)]
    pub fn film_force(&self, at: &JointAt<S>) -> S {
        if !self.acting.any() {
            return S::zero();
        }
        let effects = self.acting.at_joint(self.joint);
        effects.fold(S::zero(), |sum, effect| sum + effect.film_force(at))
    }
}
