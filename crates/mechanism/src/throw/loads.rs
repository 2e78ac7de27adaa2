//! What acts on the bodies of a throw.

use super::joints::Joints;
use super::motion::Motion;
use crate::effects::RodSpring;
use crate::gas::Gas;
use crate::joints::revolute::{JointState, Revolute};
use crate::machine::Throw;
use crate::plane::{Mat2, Vec2, diagonal, moment, origin, turned};
use scalar::{Scalar, inlined};

/// Rate, 1/s, at which a following journal is drawn back onto its surface should rounding have
/// moved it off (Baumgarte 1972).
const STABILISATION: f64 = 300.0;

/// What acts on the bodies of one throw, as far as it follows from poses and rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loads<S> {
    pub rod_force: Vec2<S>,
    pub rod_moment: S,
    pub crosshead_force: Vec2<S>,
    pub crosshead_moment: S,
    /// Force on the crank pin, and its moment about the shaft's centre.
    pub pin_force: Vec2<S>,
    pub pin_moment: S,
    /// Centripetal acceleration of the crank pin about the shaft's centre, and of the eyes about
    /// the rod's centre of mass.
    pub pin_bias: Vec2<S>,
    pub big_bias: Vec2<S>,
    pub small_bias: Vec2<S>,
    pub arms: Arms<S>,
    /// Moment of inertia of the stretched rod about its centre of mass, kg m².
    pub rod_inertia: S,
    /// Wanted relative acceleration of following joints along their normal.
    pub big_target: S,
    pub small_target: S,
    /// Second rate of the rod's stretch without the forces of rigid joints, 1/s²; none where the
    /// rod is rigid.
    pub stretch: Option<S>,
}

impl<S: Scalar> Loads<S> {
    /// No loads: with a target, the answer to an impulse instead of a force.
    #[inline(always)]
    pub fn none(elastic: bool) -> Self {
        let zero = S::zero();
        Self {
            rod_force: origin(),
            rod_moment: zero,
            crosshead_force: origin(),
            crosshead_moment: zero,
            pin_force: origin(),
            pin_moment: zero,
            pin_bias: origin(),
            big_bias: origin(),
            small_bias: origin(),
            arms: Arms::none(),
            rod_inertia: S::one(),
            big_target: zero,
            small_target: zero,
            stretch: elastic.then_some(zero),
        }
    }
}

impl<S: Scalar> Loads<S> {
    /// Finds the loads, with the rod as the spring that it is.
    #[inline(always)]
    pub fn find<const PLAIN: bool>(
        &mut self,
        throw: &Throw<S>,
        spring: Option<&RodSpring<S>>,
        gravity: Vec2<S>,
        speed: S,
        motion: &Motion<S>,
        joints: &Joints<S>,
        gas: &Gas<S>,
    ) {
        let arms = Arms::new(throw, motion, joints);
        let (big, small) = (&joints.big_end, &joints.small_end);
        let whirl = motion.stretch_rate * motion.rod_rate * 2.0;
        let rate2 = motion.rod_rate * motion.rod_rate;
        let across = turned(arms.along);
        let [of_big, of_small] = arms.shares;
        let target = inlined(
            #[inline(always)]
            |joint: &Revolute<S>, state| match !PLAIN && joint.is_following() {
                true => following_target(state),
                false => S::zero(),
            },
        );
        self.rod_force = gravity.mul_add(throw.rod.mass, -(big.force + small.force));
        let moments = moment(arms.big_force, big.force) + moment(arms.small_force, small.force);
        self.rod_moment = (throw.rod.inertia * motion.lengthening()).mul_add(-whirl, -moments);
        let pushes =
            small.force + joints.guide.force + Vec2::new(gas.force + gas.effects, S::zero());
        self.crosshead_force = gravity.mul_add(throw.crosshead.mass, pushes);
        self.crosshead_moment = moment(small.arm, small.force) + joints.guide.moment;
        self.pin_force = big.force;
        self.pin_moment = moment(motion.pin + big.arm, big.force);
        self.pin_bias = -(motion.pin * (speed * speed));
        self.big_bias = across.mul_add(of_big * whirl, -(arms.big * rate2));
        self.small_bias = across.mul_add(of_small * whirl, -(arms.small * rate2));
        self.arms = arms;
        self.rod_inertia = arms.inertia(throw, motion);
        self.big_target = target(&throw.big_end, big);
        self.small_target = target(&throw.small_end, small);
        self.stretch = spring.map(
            #[inline(always)]
            |spring| {
                let pull = -(big.force * of_big + small.force * of_small).dot(&arms.along);
                motion.lengthening() * rate2
                    + (pull + spring.pull(throw, motion)) / throw.rod.inertia
            },
        );
    }

    /// What is left of the loads where an impulse takes the place of every force.
    #[inline(always)]
    pub fn silent(&self) -> Self {
        Self {
            arms: self.arms,
            rod_inertia: self.rod_inertia,
            ..Self::none(self.stretch.is_some())
        }
    }

    /// Acceleration of the rod's centre of mass, and its angular one, without rigid joints' forces.
    #[inline(always)]
    pub(super) fn free_rod(&self, throw: &Throw<S>) -> (Vec2<S>, S) {
        // One division for both: they take long.
        let (mass, inertia) = (throw.rod.mass, self.rod_inertia);
        let both = S::one() / (mass * inertia);
        (
            self.rod_force * (both * inertia),
            self.rod_moment * (both * mass),
        )
    }

    /// The crosshead's acceleration without rigid joints' forces.
    #[inline(always)]
    pub(super) fn free_crosshead(&self, throw: &Throw<S>) -> Vec2<S> {
        crosshead_give(throw) * self.crosshead_force
    }
}

/// How the crosshead's acceleration answers to a force on it: an ideal guide lets it move along
/// alone.
#[inline(always)]
pub(super) fn crosshead_give<S: Scalar>(throw: &Throw<S>) -> Mat2<S> {
    let light = S::one() / throw.crosshead.mass;
    let across = match throw.guide.clear() {
        Some(_) => light,
        None => S::zero(),
    };
    diagonal(light, across)
}

/// Arms from the rod's centre of mass to its eyes and to where the rigid joints' forces act.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arms<S> {
    /// Unit vector along the rod.
    pub(super) along: Vec2<S>,
    /// Where big and small end lie on the unloaded rod, from its centre of mass, m.
    pub(super) shares: [S; 2],
    pub(super) big: Vec2<S>,
    pub(super) small: Vec2<S>,
    pub(super) big_force: Vec2<S>,
    pub(super) small_force: Vec2<S>,
}

impl<S: Scalar> Arms<S> {
    #[inline(always)]
    fn none() -> Self {
        Self {
            along: origin(),
            shares: [S::zero(); 2],
            big: origin(),
            small: origin(),
            big_force: origin(),
            small_force: origin(),
        }
    }

    #[inline(always)]
    fn new(throw: &Throw<S>, motion: &Motion<S>, joints: &Joints<S>) -> Self {
        let along = motion.along_rod();
        let shares = [
            -throw.rod.centre_of_mass,
            throw.rod.length - throw.rod.centre_of_mass,
        ];
        let big = along * (shares[0] * motion.lengthening());
        let small = along * (shares[1] * motion.lengthening());
        Self {
            along,
            shares,
            big,
            small,
            big_force: big + joints.big_end.offset + joints.big_end.arm,
            small_force: small + joints.small_end.offset + joints.small_end.arm,
        }
    }

    /// Moment of inertia of the stretched rod about its centre of mass, kg m².
    #[inline(always)]
    fn inertia(&self, throw: &Throw<S>, motion: &Motion<S>) -> S {
        throw.rod.inertia * motion.lengthening() * motion.lengthening()
    }
}

/// The target that keeps a following journal at its clearance: r̈ = 0 with stabilisation.
#[inline(always)]
pub(crate) fn following_target<S: Scalar>(joint: &JointState<S>) -> S {
    let tangent = turned(joint.normal).dot(&joint.rate);
    let distance = joint
        .offset
        .dot(&joint.offset)
        .sqrt()
        .max(S::constant(1e-30));
    -(tangent * tangent) / distance
        - joint.penetration_rate * (2.0 * STABILISATION)
        - joint.penetration * (STABILISATION * STABILISATION)
}
