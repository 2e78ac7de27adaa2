//! One throw: from the crank pin's motion and the joints' offsets to forces and accelerations.
//!
//! Everything here is in the throw's own frame: x toward its head, origin at the shaft's ideal
//! axis. Two steps, because the crank's acceleration may depend on every throw:
//!
//! 1. [`Motion`] and [`Loads`]: poses, rates, and every force that follows from them.
//! 2. [`Response`]: the unknown forces of rigid joints as an affine function of the crank pin's
//!    acceleration, by eliminating the small end, then the big end. A joint with clearance has no
//!    unknown force, so with both ends clear nothing is solved at all.

use crate::effects::RodSpring;
use crate::gas::Gas;
use crate::joints::guide::GuideState;
use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::Throw;
use crate::plane::{Mat2, Vec2, diagonal, moment, origin, outer, turned};
use scalar::{Scalar, inlined};

/// Rate, 1/s, at which a following journal is drawn back onto its surface should rounding have
/// moved it off (Baumgarte 1972).
const STABILISATION: f64 = 300.0;

/// Poses and rates of one throw.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// Crank angle α since this throw's own top dead centre, rad.
    pub angle: S,
    /// Its sine and cosine.
    pub angle_sin_cos: (S, S),
    /// Crank pin, from the shaft's centre, m.
    pub pin: Vec2<S>,
    /// Sine and cosine of the rod's angle φ.
    pub rod_sin_cos: (S, S),
    /// Rod's angular speed, rad/s.
    pub rod_rate: S,
    /// Big-end eye, m, and its velocity, m/s.
    pub big_eye: [Vec2<S>; 2],
    /// Crosshead pin along x, m.
    pub crosshead: S,
    /// Its speed, m/s.
    pub crosshead_rate: S,
    /// Stretch η of the rod: by how much it is longer than without load, over its length.
    pub stretch: S,
    /// Its rate η̇, 1/s.
    pub stretch_rate: S,
}

/// What acts on the bodies of one throw, as far as poses and rates tell.
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
    /// the relative acceleration answers to that force.
    #[inline(always)]
    fn stiffen(&self, answer: impl FnOnce() -> Mat2<S>) -> Option<Mat2<S>> {
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

/// Arms from the rod's centre of mass to its eyes and to where the rigid joints' forces act.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arms<S> {
    /// Unit vector along the rod.
    along: Vec2<S>,
    /// Where big and small end lie on the unloaded rod, from its centre of mass, m.
    shares: [S; 2],
    big: Vec2<S>,
    small: Vec2<S>,
    big_force: Vec2<S>,
    small_force: Vec2<S>,
}

/// Accelerations of one throw, and its rigid joints' forces.
#[derive(Clone, Copy, Debug)]
pub struct Accelerations<S> {
    /// Crosshead along x, m/s².
    pub crosshead: S,
    /// Second rate of the big-end offset, m/s².
    pub big_end: Vec2<S>,
    /// Second rate of the small-end offset, m/s².
    pub small_end: Vec2<S>,
    /// Second rates of the crosshead's shift and tilt, m/s² and rad/s².
    pub guide: Vec2<S>,
    /// Force on the rod at the big end, of a rigid joint model (0 with compliant contact), N.
    pub big_force: Vec2<S>,
    /// The same at the small end.
    pub small_force: Vec2<S>,
    /// Rod's angular acceleration, rad/s².
    pub rod: S,
    /// Second rate of the rod's stretch, 1/s².
    pub(crate) stretch: S,
}

impl<S: Scalar> Motion<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = S::zero();
        Self {
            angle: zero,
            angle_sin_cos: (zero, zero),
            pin: origin(),
            rod_sin_cos: (zero, zero),
            rod_rate: zero,
            big_eye: [origin(); 2],
            crosshead: zero,
            crosshead_rate: zero,
            stretch: zero,
            stretch_rate: zero,
        }
    }

    /// Finds the pose with the shaft's centre at `shaft` (position and velocity), the crank at
    /// `angle` turning at `speed`, the given joint offsets and rates, and the rod's stretch η and its
    /// rate.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        throw: &Throw<S>,
        shaft: [Vec2<S>; 2],
        angle: S,
        speed: S,
        big: [Vec2<S>; 2],
        small: [Vec2<S>; 2],
        guide: [Vec2<S>; 2],
        [stretch, stretch_rate]: [S; 2],
    ) {
        let (sine, cosine) = angle.sin_cos();
        let pin = Vec2::new(cosine, sine) * throw.crank_radius;
        let eye = shaft[0] + pin - big[0];
        let eye_rate = turned(pin).mul_add(speed, shaft[1] - big[1]);
        // The small-end eye's height follows from the crosshead's, and gives the rod's angle.
        let rise = guide[0].x - small[0].y - eye.y;
        let rise_rate = guide[1].x - small[1].y - eye_rate.y;
        let length = throw.rod.length * (stretch + 1.0);
        let length_rate = throw.rod.length * stretch_rate;
        let rod_sine = rise / length;
        let rod_cosine = (-rod_sine).mul_add(rod_sine, S::one()).sqrt();
        let rod_rate = (-length_rate).mul_add(rod_sine, rise_rate) / (length * rod_cosine);
        self.angle = angle;
        self.angle_sin_cos = (sine, cosine);
        self.pin = pin;
        self.rod_sin_cos = (rod_sine, rod_cosine);
        self.rod_rate = rod_rate;
        self.big_eye = [eye, eye_rate];
        self.crosshead = length.mul_add(rod_cosine, eye.x + small[0].x);
        let rate = length_rate.mul_add(rod_cosine, eye_rate.x + small[1].x);
        self.crosshead_rate = (-rise).mul_add(rod_rate, rate);
        self.stretch = stretch;
        self.stretch_rate = stretch_rate;
    }

    /// Length of the rod over that without load, 1 + η.
    #[inline(always)]
    pub(crate) fn lengthening(&self) -> S {
        self.stretch + 1.0
    }

    /// Unit vector along the rod, from big to small end.
    #[inline(always)]
    pub(crate) fn along_rod(&self) -> Vec2<S> {
        Vec2::new(self.rod_sin_cos.1, self.rod_sin_cos.0)
    }
}

/// The joints of one throw at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Joints<S> {
    /// Big end: crank pin in the rod.
    pub big_end: JointState<S>,
    /// Small end: crosshead pin in the rod.
    pub small_end: JointState<S>,
    /// Crosshead in its guide.
    pub guide: GuideState<S>,
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
    fn free_rod(&self, throw: &Throw<S>) -> (Vec2<S>, S) {
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
    fn free_crosshead(&self, throw: &Throw<S>) -> Vec2<S> {
        crosshead_give(throw) * self.crosshead_force
    }
}

/// How the crosshead's acceleration answers to a force on it: an ideal guide lets it move along
/// alone.
#[inline(always)]
fn crosshead_give<S: Scalar>(throw: &Throw<S>) -> Mat2<S> {
    let light = S::one() / throw.crosshead.mass;
    let across = match throw.guide.clear() {
        Some(_) => light,
        None => S::zero(),
    };
    diagonal(light, across)
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
}

impl<S: Scalar> Arms<S> {
    /// Moment of inertia of the stretched rod about its centre of mass, kg m².
    #[inline(always)]
    fn inertia(&self, throw: &Throw<S>, motion: &Motion<S>) -> S {
        throw.rod.inertia * motion.lengthening() * motion.lengthening()
    }
}

impl<S: Scalar> RodSpring<S> {
    /// Moment of the spring and its damping on the stretch η, N m: −L² (k η + c η̇), with c so that
    /// the free rod has the damping ratio.
    #[inline(always)]
    fn pull(&self, throw: &Throw<S>, motion: &Motion<S>) -> S {
        let length = throw.rod.length;
        -(self.stiffness * length * length * motion.stretch)
            - self.damping(throw) * motion.stretch_rate
    }

    /// Damping L² c of the stretch, N m s.
    #[inline(always)]
    pub(crate) fn damping(&self, throw: &Throw<S>) -> S {
        let critical = (self.stiffness * throw.rod.inertia).sqrt() * throw.rod.length * 2.0;
        self.damping_ratio * critical
    }
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

impl<S: Scalar> Accelerations<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = S::zero();
        Self {
            crosshead: zero,
            big_end: origin(),
            small_end: origin(),
            guide: origin(),
            big_force: origin(),
            small_force: origin(),
            rod: zero,
            stretch: zero,
        }
    }

    /// Finds the accelerations under the loads and the rigid joints' forces, if there are any, with
    /// the crank pin's own.
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        throw: &Throw<S>,
        loads: &Loads<S>,
        joints: &Joints<S>,
        pin: Vec2<S>,
        forces: Option<[Vec2<S>; 2]>,
    ) {
        let arms = &loads.arms;
        let (mut centre, mut rod) = loads.free_rod(throw);
        let mut crosshead = loads.free_crosshead(throw);
        let mut tilting = loads.crosshead_moment;
        let [of_big, of_small] = arms.shares;
        let mut stretch = loads.stretch;
        let [big_force, small_force] = forces.unwrap_or([origin(); 2]);
        if forces.is_some() {
            centre += (big_force + small_force) / throw.rod.mass;
            rod += (moment(arms.big_force, big_force) + moment(arms.small_force, small_force))
                / loads.rod_inertia;
            crosshead -= crosshead_give(throw) * small_force;
            tilting -= moment(joints.small_end.arm, small_force);
            let pull = (big_force * of_big + small_force * of_small).dot(&arms.along);
            stretch = stretch.map(|stretch| stretch + pull / throw.rod.inertia);
        }
        let mut big_eye = turned(arms.big).mul_add(rod, centre + loads.big_bias);
        let mut small_eye = turned(arms.small).mul_add(rod, centre + loads.small_bias);
        if let Some(stretch) = stretch {
            big_eye += arms.along * (of_big * stretch);
            small_eye += arms.along * (of_small * stretch);
        }
        self.crosshead = crosshead.x;
        self.big_end = pin - big_eye;
        self.small_end = crosshead - small_eye;
        self.guide = match throw.guide.clear() {
            None => origin(),
            Some(_) => Vec2::new(crosshead.y, tilting / throw.crosshead.inertia),
        };
        self.big_force = big_force;
        self.small_force = small_force;
        self.rod = rod;
        self.stretch = stretch.unwrap_or(S::zero());
    }
}
