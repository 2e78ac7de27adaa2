//! The crankshaft: the equation that couples the throws.
//!
//! Unknown are the angular acceleration (free crank) and the acceleration of the shaft's centre
//! (main bearing with clearance). With a rigid big end the throw's force on the crank pin depends
//! on them, as `throw::Response` gives it. Any number of throws leads to at most three
//! equations:
//!
//! ```text
//! J θ̈ + m ε turned(u)·Ö      = T + Σ moments + m ε turned(u)·g + moment at the main bearing
//! m (Ö + ε turned(u) θ̈ − ε u θ̇²) = Σ pin forces + main bearing's force + m g
//! ```

use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::Machine;
use crate::plane::{Mat2, Vec2, diagonal, moment, origin, outer, turned};
use scalar::{Scalar, inlined};

/// The shaft's equations of motion as `matrix × (θ̈, Ö) = right`, throws included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaft<S> {
    /// Coefficient of θ̈ in the moment equation, kg m².
    pub inertia: S,
    /// Coefficients of Ö in the moment equation, and of θ̈ in the force equation.
    pub coupling: [Vec2<S>; 2],
    /// Coefficient of Ö in the force equation, kg.
    pub mass: Mat2<S>,
    /// Right side of the moment equation, without the drive's torque.
    pub moment: S,
    /// Right side of the force equation.
    pub force: Vec2<S>,
}

/// What is known of the shaft's turning.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Turning<S> {
    /// The drive's torque, N m: the crank is free.
    Torque(S),
    /// The angular acceleration, rad/s²: the motion is given.
    Acceleration(S),
}

/// How the shaft moves.
#[derive(Clone, Copy, Debug)]
pub struct ShaftMotion<S> {
    /// Angular acceleration θ̈, rad/s².
    pub angular: S,
    /// Acceleration of the shaft's centre, m/s².
    pub centre: Vec2<S>,
    /// Torque of the drive on the shaft, N m.
    pub torque: S,
    /// Force of the main bearing on the shaft, N.
    pub bearing_force: Vec2<S>,
    /// Push of a rigidly following main bearing, N.
    pub(crate) push: S,
}

impl<S: Scalar> Shaft<S> {
    /// The shaft alone, in direction `u` turning at `speed`, under gravity.
    #[inline(always)]
    pub fn new(machine: &Machine<S>, u: Vec2<S>, speed: S, gravity: Vec2<S>) -> Self {
        let shaft = &machine.crankshaft;
        let lever = turned(u) * (shaft.mass * shaft.eccentricity);
        Self {
            inertia: shaft.inertia,
            coupling: [lever, lever],
            mass: diagonal(shaft.mass, shaft.mass),
            moment: lever.dot(&gravity),
            force: gravity * shaft.mass + u * (shaft.mass * shaft.eccentricity * speed * speed),
        }
    }

    /// Adds a known force on a crank pin.
    #[inline(always)]
    pub fn add_force(&mut self, force: Vec2<S>, moment: S) {
        self.force += force;
        self.moment += moment;
    }

    /// Adds the throw's rigid big-end force: on the pin acts `−(slope A + offset)`, where the pin's
    /// acceleration is `A = Ö + θ̈ turned(pin) + bias`. `arm` is where it acts.
    #[inline(always)]
    pub fn add_throw(
        &mut self,
        slope: Mat2<S>,
        offset: Vec2<S>,
        pin: Vec2<S>,
        arm: Vec2<S>,
        bias: Vec2<S>,
    ) {
        let along = turned(pin);
        let known = slope * bias + offset;
        self.mass = self.mass + slope;
        self.coupling[1] += slope * along;
        self.coupling[0] += slope.transpose() * turned(arm);
        self.inertia += turned(arm).dot(&(slope * along));
        self.add_force(-known, -moment(arm, known));
    }

    /// Solves for the shaft's motion; `joint` is the main bearing.
    #[inline(always)]
    pub fn solve(
        &self,
        main: &Revolute<S>,
        joint: &JointState<S>,
        touching: S,
        turning: Turning<S>,
        target: S,
    ) -> ShaftMotion<S> {
        let (zero, one) = (S::zero(), S::one());
        // With the motion given θ̈ is known and the moment equation yields the torque.
        let (give, drive, given) = match turning {
            Turning::Torque(torque) => (one / self.inertia, torque, zero),
            Turning::Acceleration(angular) => (zero, zero, angular),
        };
        let torque_for = inlined(
            #[inline(always)]
            |angular: S, moment: S| match turning {
                Turning::Torque(torque) => torque,
                Turning::Acceleration(_) => self.inertia * angular - moment,
            },
        );
        let clear = match main {
            Revolute::Ideal => {
                let angular = given + give * (self.moment + drive);
                let bearing_force = self.coupling[1] * angular - self.force;
                return ShaftMotion {
                    angular,
                    centre: origin(),
                    torque: torque_for(angular, self.moment),
                    bearing_force,
                    push: zero,
                };
            }
            Revolute::Clear(clear) => clear,
        };
        let contact_moment = moment(joint.arm, joint.force);
        // Eliminate θ̈ = given + give (moment + drive − coupling·Ö + ...).
        let condensed = self.mass - outer(self.coupling[1], self.coupling[0]) * give;
        let answer = condensed.inverse();
        let centre_for = inlined(
            #[inline(always)]
            |force: Vec2<S>, moment: S| {
                answer
                    * (self.force + force
                        - self.coupling[1] * (given + give * (self.moment + drive + moment)))
            },
        );
        let mut force = joint.force;
        let mut moment_of = contact_moment;
        let mut centre = centre_for(force, moment_of);
        let mut push = zero;
        if clear.model != JointModel::ThreeMode {
            // The bearing pushes the journal back along −(n + μ t).
            let active = match clear.model {
                JointModel::MasslessLink => one,
                _ => touching,
            };
            let unit = -(joint.normal + turned(joint.normal) * joint.coefficient);
            let unit_moment = moment(joint.arm, unit);
            let effect = answer * (unit - self.coupling[1] * (give * unit_moment));
            push = active * (target - joint.normal.dot(&centre)) / joint.normal.dot(&effect);
            force = unit * push;
            moment_of = unit_moment * push;
            centre = centre_for(force, moment_of);
        }
        let moment = self.moment + moment_of - self.coupling[0].dot(&centre);
        let angular = given + give * (moment + drive);
        ShaftMotion {
            angular,
            centre,
            torque: torque_for(angular, moment),
            bearing_force: force,
            push,
        }
    }
}
