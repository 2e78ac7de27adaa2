//! What one evaluation of the equations of motion finds, and the forces of one throw.

use crate::effects::{Acting, AtJoint, Joint};
use crate::gas::{CylinderAt, Gas};
use crate::joints::guide::{Guide, GuideState};
use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::{Direction, Throw};
use crate::mode::{ContactMode, ThrowMode};
use crate::plane::{Vec2, origin};
use crate::shaft::ShaftMotion;
use crate::state::ThrowLayout;
use crate::throw::{Accelerations, Joints, Loads, Motion};
use scalar::{Scalar, inlined};

/// Everything that one evaluation of the equations of motion finds.
#[derive(Clone, Debug)]
pub struct Evaluation<S> {
    /// Crank angle θ, unwrapped, rad.
    pub angle: S,
    /// Its rate, rad/s.
    pub speed: S,
    /// The shaft.
    pub shaft: ShaftMotion<S>,
    /// The main bearing.
    pub main: JointState<S>,
    /// Each throw.
    pub throws: Vec<ThrowEvaluation<S>>,
    /// Acceleration of the frame against its springs, m/s²; 0 without one.
    pub frame: Vec2<S>,
    /// Place of the frame, m, and its rate, m/s: on its springs, and as effects shake it. Found for sensors alone.
    pub frame_motion: [Vec2<S>; 2],
    /// Acceleration that effects give the frame and everything on it, m/s².
    pub(crate) shaken: Option<Vec2<S>>,
    /// Force of the machine on the frame, N.
    pub frame_force: Vec2<S>,
}

impl<S: Scalar> Evaluation<S> {
    /// Acceleration of the frame, m/s²: on its springs, and as effects shake it.
    #[inline(always)]
    pub fn frame_acceleration(&self) -> Vec2<S> {
        match self.shaken {
            None => self.frame,
            Some(shaken) => self.frame + shaken,
        }
    }
}

/// One throw's part of an [`Evaluation`].
#[derive(Clone, Copy, Debug)]
pub struct ThrowEvaluation<S> {
    /// Poses and rates.
    pub motion: Motion<S>,
    /// Joints, with their contact forces.
    pub joints: Joints<S>,
    /// Gas.
    pub gas: Gas<S>,
    /// Accelerations and rigid joints' forces.
    pub accelerations: Accelerations<S>,
    /// Acceleration of what the throw stands on, m/s²: what a sensor on the crosshead feels beside
    /// the crosshead's own. 0 where the frame does not carry.
    pub carried: Vec2<S>,
    /// What drives the housing of the guide, m/s²; see [`Housing`](crate::housing::Housing). Found for sensors alone, 0
    /// without a housing.
    pub housing: Vec2<S>,
    pub(crate) loads: Loads<S>,
}

/// Where and how a throw stands: what its evaluation needs beside the machine.
pub(crate) struct Standing<'a, S> {
    pub layout: &'a ThrowLayout,
    pub mode: &'a ThrowMode<S>,
    pub shaft: [Vec2<S>; 2],
    pub angle: S,
    pub speed: S,
    /// Whether the speed stays what it is.
    pub is_constant: bool,
    pub gravity: Vec2<S>,
}

impl<S: Scalar> ThrowEvaluation<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            motion: Motion::none(),
            joints: Joints {
                big_end: JointState::ideal(),
                small_end: JointState::ideal(),
                guide: GuideState::ideal(),
            },
            gas: Gas::none(),
            loads: Loads::none(false),
            accelerations: Accelerations::none(),
            carried: origin(),
            housing: origin(),
        }
    }

    /// Finds poses, rates and loads, in place: there is too much of it to be moved about. For `PLAIN` see
    /// [`Machine::is_plain`](crate::Machine::is_plain).
    #[inline(always)]
    pub(crate) fn find<const PLAIN: bool>(
        &mut self,
        throw: &Throw<S>,
        effects: Acting<'_, S>,
        at: Standing<'_, S>,
        y: &[S],
    ) {
        let layout = match PLAIN {
            true => at.layout.plain(),
            false => *at.layout,
        };
        let big = pair(y, layout.big_end);
        let small = pair(y, layout.small_end);
        let guide = pair(y, layout.guide);
        let two = inlined(
            #[inline(always)]
            |i: usize| [y[i], y[i + 1]],
        );
        let stretch = layout.rod.map_or([S::zero(); 2], two);
        self.motion.find(
            throw, at.shaft, at.angle, at.speed, big, small, guide, stretch,
        );
        let motion = &self.motion;
        let spin = motion.rod_rate;
        // Both ends' bearings are in the rod.
        let at_joint = inlined(
            #[inline(always)]
            |joint, journal| AtJoint {
                acting: effects,
                joint,
                axes: [motion.along_rod(), journal],
            },
        );
        let pin = motion.angle_sin_cos;
        let crosshead = layout.guide.map_or(along_x(), |_| direction(guide[0].y));
        let joints = &mut self.joints;
        find_joint::<S, PLAIN>(
            &mut joints.big_end,
            &throw.big_end,
            big,
            [at.speed, spin],
            &at.mode.big_end,
            #[inline(always)]
            || at_joint(Joint::BigEnd, Vec2::new(pin.1, pin.0)),
        );
        find_joint::<S, PLAIN>(
            &mut joints.small_end,
            &throw.small_end,
            small,
            [guide[1].y, spin],
            &at.mode.small_end,
            #[inline(always)]
            || at_joint(Joint::SmallEnd, crosshead),
        );
        match &throw.guide {
            // What an ideal guide must bear is found last.
            Guide::Ideal => joints.guide.release(),
            Guide::Clear(_) if PLAIN => {}
            Guide::Clear(clear) => {
                let (guide_at, mode) = (&mut joints.guide, &at.mode.guide);
                clear.find(guide_at, guide[0], guide[1], motion.crosshead_rate, mode);
            }
        }
        let cylinder = CylinderAt {
            throw,
            effects,
            motion,
            speed: at.speed,
            offsets: [big[0], small[0]],
            mode: at.mode,
            drift: layout.gas.map(two),
            centres: self.gas.centres.filter(|_| at.is_constant),
        };
        cylinder.find::<PLAIN>(&mut self.gas);
        let spring = effects.rod();
        self.loads.find::<PLAIN>(
            throw,
            spring.as_ref(),
            at.gravity,
            at.speed,
            motion,
            &self.joints,
            &self.gas,
        );
        self.carried = origin();
    }
}

impl<S: Scalar> Throw<S> {
    /// Angle since this throw's own top dead centre, rad.
    #[inline(always)]
    pub fn local_angle(&self, angle: S) -> S {
        match self.direction {
            Direction::Forward => angle + self.pin_angle,
            Direction::Opposed => angle + self.pin_angle - std::f64::consts::PI,
        }
    }

    /// Whether a force at an end of its rod follows from accelerations.
    #[inline(always)]
    pub(crate) fn has_rigid_end(&self) -> bool {
        self.big_end.is_rigid() || self.small_end.is_rigid()
    }

    /// A vector of the machine's frame in the throw's own, and back: an opposed throw's frame is
    /// turned by half a revolution.
    #[inline(always)]
    pub(crate) fn local(&self, v: Vec2<S>) -> Vec2<S> {
        match self.direction {
            Direction::Forward => v,
            Direction::Opposed => -v,
        }
    }
}

/// Two vectors at `at`: position and rate; zeros where there is nothing.
#[inline(always)]
pub(crate) fn pair<S: Scalar>(y: &[S], at: Option<usize>) -> [Vec2<S>; 2] {
    match at {
        None => [origin(); 2],
        Some(i) => [Vec2::new(y[i], y[i + 1]), Vec2::new(y[i + 2], y[i + 3])],
    }
}

/// The direction of the x axis.
#[inline(always)]
pub(crate) fn along_x<S: Scalar>() -> Vec2<S> {
    Vec2::new(S::one(), S::zero())
}

/// The direction at an angle, rad.
#[inline(always)]
pub(crate) fn direction<S: Scalar>(angle: S) -> Vec2<S> {
    let (sine, cosine) = angle.sin_cos();
    Vec2::new(cosine, sine)
}

/// Finds the state of a joint with clearance; that of an ideal one never changes.
#[inline(always)]
pub(crate) fn find_joint<'a, S: Scalar, const PLAIN: bool>(
    state: &mut JointState<S>,
    joint: &Revolute<S>,
    offset: [Vec2<S>; 2],
    spins: [S; 2],
    mode: &ContactMode<S>,
    effects: impl FnOnce() -> AtJoint<'a, S>,
) {
    match joint {
        Revolute::Ideal => {}
        Revolute::Clear(clear) if PLAIN => {
            let model = JointModel::ThreeMode;
            clear.find_as(model, state, offset, spins, mode, &effects());
        }
        Revolute::Clear(clear) => clear.find(state, offset, spins, mode, &effects()),
    }
}
