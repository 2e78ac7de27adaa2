//! The equations of motion of the whole machine.

use super::Dynamics;
use crate::drive::Drive;
use crate::effects::{Acting, AtJoint, Joint};
use crate::evaluation::{Evaluation, Standing, along_x, direction, find_joint, pair};
use crate::machine::Throw;
use crate::plane::{Vec2, moment, origin, turned};
use crate::shaft::{Shaft, Turning};
use crate::throw::{Response, following_target};
use scalar::Scalar;

impl<S: Scalar> Dynamics<S> {
    /// Crank angle and speed.
    #[inline(always)]
    pub(super) fn crank(&self, t: S, y: &[S]) -> (S, S) {
        match (&self.machine.drive, self.layout.crank) {
            (Drive::Free(motor), Some(i)) => {
                let reference = motor.reference_speed;
                (reference * t + y[i], reference + y[i + 1])
            }
            (Drive::Free(motor), None) => (motor.reference_speed * t, motor.reference_speed),
            (Drive::Given(given), _) => {
                let [angle, speed, _] = given.motion(t);
                (angle, speed)
            }
        }
    }

    /// Evaluates the equations of motion in the present mode, at time `t` (s) and state `y` (SI, in
    /// the order of [`layout`](Self::layout)).
    pub fn evaluate(&mut self, t: S, y: &[S]) -> &Evaluation<S> {
        self.evaluate_forces(t, y);
        self.respond();
        self.turn_shaft(t);
        self.follow_apart();
        self.shake_frame(y);
        self.drive_housings(y);
        &self.evaluation
    }

    /// As [`evaluate`](Self::evaluate), without what sensors on crosshead, frame and cylinder do not see.
    pub fn evaluate_sensed(&mut self, t: S, y: &[S]) -> &Evaluation<S> {
        // Effects may shake the frame.
        if self.machine.effects.is_empty() {
            self.evaluate_rates(t, y);
            self.drive_housings(y);
        } else {
            self.evaluate(t, y);
        }
        &self.evaluation
    }

    /// Writes the derivative of the state `y` at `t` into `dy`. To be called within [`Scalar::vectorised`].
    #[inline(always)]
    pub(crate) fn rates(&mut self, t: S, y: &[S], dy: &mut [S]) {
        // With derivatives there would be too much of it to compile.
        let small = size_of::<S>() == size_of::<S::Plain>();
        if small && self.plain && self.layout.ledger.is_none() {
            self.forces::<true>(t, y);
            self.turn_and_follow(t, y);
        } else {
            self.evaluate_rates(t, y);
        }
        self.write_derivative(y, dy);
    }

    /// As [`evaluate`](Self::evaluate), but for what the state's derivative does not depend on.
    #[inline(never)]
    fn evaluate_rates(&mut self, t: S, y: &[S]) {
        if self.layout.ledger.is_some() {
            self.evaluate(t, y);
            return;
        }
        self.evaluate_forces(t, y);
        S::vectorised(
            #[inline(always)]
            || self.turn_and_follow(t, y),
        );
    }

    /// Finds the accelerations under the forces, as far as the state's derivative depends on them.
    #[inline(always)]
    fn turn_and_follow(&mut self, t: S, y: &[S]) {
        // A frame feels the main bearing's force.
        let framed = self.machine.frame.is_some();
        if self.rigid {
            self.respond();
        }
        if framed || self.pins_give {
            self.turn_shaft(t);
        }
        self.follow();
        if framed {
            self.shake_frame(y);
        }
    }

    /// Poses, rates, and the forces that follow from them.
    #[inline(never)]
    pub(crate) fn evaluate_forces(&mut self, t: S, y: &[S]) {
        S::vectorised(
            #[inline(always)]
            || match self.plain {
                true => self.forces::<true>(t, y),
                false => self.forces::<false>(t, y),
            },
        )
    }

    /// As [`evaluate_forces`](Self::evaluate_forces) of a machine that is plain or not.
    #[inline(always)]
    fn forces<const PLAIN: bool>(&mut self, t: S, y: &[S]) {
        let effects: &[_] = match PLAIN {
            true => &[],
            false => &self.machine.effects,
        };
        let (angle, speed) = self.crank(t, y);
        let is_constant = self.machine.drive.is_constant();
        let on_shaft = Acting::on_shaft(effects);
        self.evaluation.shaken = on_shaft.frame_acceleration(angle, speed);
        let gravity = self.gravity();
        let evaluation = &mut self.evaluation;
        evaluation.angle = angle;
        evaluation.speed = speed;
        find_joint::<S, PLAIN>(
            &mut evaluation.main,
            &self.machine.main,
            pair(y, self.layout.main),
            [speed, S::zero()],
            &self.mode.main,
            #[inline(always)]
            || AtJoint {
                acting: on_shaft,
                joint: Joint::Main,
                axes: [along_x(), direction(angle)],
            },
        );
        for (i, found) in evaluation.throws.iter_mut().enumerate() {
            let throw = &self.machine.throws[i];
            let (layout, mode) = (&self.layout.throws[i], &self.mode.throws[i]);
            let [place, rate] = pair(y, self.layout.main);
            let shaft = [throw.local(place), throw.local(rate)];
            let gravity = throw.local(gravity);
            let angle = throw.local_angle(angle);
            found.find::<PLAIN>(
                throw,
                Acting::on_throw(effects, i),
                Standing {
                    layout,
                    mode,
                    shaft,
                    angle,
                    speed,
                    is_constant,
                    gravity,
                },
                y,
            );
        }
    }

    /// Gravity, as a frame that is shaken feels it.
    #[inline(always)]
    fn gravity(&self) -> Vec2<S> {
        let gravity = Vec2::new(self.machine.gravity_x, self.machine.gravity_y);
        match self.evaluation.shaken {
            None => gravity,
            Some(acceleration) => gravity - acceleration,
        }
    }

    /// Finds how the shaft moves under the forces.
    #[inline(never)]
    fn turn_shaft(&mut self, t: S) {
        S::vectorised(
            #[inline(always)]
            || {
                let speed = self.evaluation.speed;
                let (sine, cosine) = self.evaluation.angle.sin_cos();
                let shaft = Shaft::new(
                    &self.machine,
                    Vec2::new(cosine, sine),
                    speed,
                    self.gravity(),
                );
                let turning = match &self.machine.drive {
                    Drive::Given(given) => Turning::Acceleration(given.motion(t)[2]),
                    Drive::Free(motor) => Turning::Torque(
                        motor.mean_torque + motor.slope * (motor.reference_speed - speed),
                    ),
                };
                let target = following_target(&self.evaluation.main);
                self.turn(shaft, turning, target);
            },
        )
    }

    /// Eliminates the throws' rigid joints from the loads stored in the evaluation.
    #[inline(never)]
    pub(crate) fn respond(&mut self) {
        S::vectorised(
            #[inline(always)]
            || {
                let throws = self.machine.throws.iter().zip(&self.evaluation.throws);
                let modes = self.mode.throws.iter().zip(&mut self.responses);
                for ((throw, at), (mode, response)) in throws.zip(modes) {
                    if throw.has_rigid_end() {
                        let touching = [mode.big_end.touching, mode.small_end.touching];
                        *response = Response::new(throw, &at.joints, &at.loads, touching);
                    }
                }
            },
        )
    }

    /// Joins throws and shaft, and finds how the shaft moves.
    #[inline(never)]
    pub(crate) fn turn(&mut self, mut shaft: Shaft<S>, turning: Turning<S>, target: S) {
        S::vectorised(
            #[inline(always)]
            || {
                let throws = self.machine.throws.iter().zip(&self.evaluation.throws);
                for ((throw, at), response) in throws.zip(&self.responses) {
                    shaft.add_force(throw.local(at.loads.pin_force), at.loads.pin_moment);
                    if throw.big_end.is_rigid() {
                        shaft.add_throw(
                            response.slope,
                            throw.local(response.offset),
                            throw.local(at.motion.pin),
                            throw.local(at.motion.pin + at.joints.big_end.arm),
                            throw.local(at.loads.pin_bias),
                        );
                    }
                }
                self.evaluation.shaft = shaft.solve(
                    &self.machine.main,
                    &self.evaluation.main,
                    self.mode.main.touching,
                    turning,
                    target,
                );
            },
        )
    }

    /// Finds the throws' accelerations under their loads and the shaft's motion.
    #[inline(always)]
    fn follow(&mut self) {
        let give = self.pins_give;
        let Evaluation { shaft, throws, .. } = &mut self.evaluation;
        let throws = self.machine.throws.iter().zip(throws);
        for ((throw, at), response) in throws.zip(&self.responses) {
            let mut pin = at.loads.pin_bias;
            if give {
                pin += throw.local(shaft.centre) + turned(at.motion.pin) * shaft.angular;
            }
            let forces = throw.has_rigid_end().then(
                #[inline(always)]
                || response.forces(pin),
            );
            at.accelerations
                .find(throw, &at.loads, &at.joints, pin, forces);
            if throw.guide.clear().is_none() {
                // What an ideal guide must bear, so that the crosshead stays on its line.
                let small = at.accelerations.small_force;
                at.joints.guide.force = Vec2::new(S::zero(), small.y - at.loads.crosshead_force.y);
                at.joints.guide.moment =
                    moment(at.joints.small_end.arm, small) - at.loads.crosshead_moment;
            }
        }
    }

    /// As [`follow`](Self::follow), with the processor's instructions.
    #[inline(never)]
    pub(crate) fn follow_apart(&mut self) {
        S::vectorised(
            #[inline(always)]
            || self.follow(),
        )
    }

    /// Force on the frame: the reactions of main bearing, guides and cylinder covers.
    #[inline(never)]
    fn shake_frame(&mut self, y: &[S]) {
        S::vectorised(
            #[inline(always)]
            || {
                let evaluation = &mut self.evaluation;
                let mut force = -evaluation.shaft.bearing_force;
                for (throw, at) in self.machine.throws.iter().zip(&evaluation.throws) {
                    let along = Vec2::new(at.gas.force + at.gas.effects, S::zero());
                    force += throw.local(-(along + at.joints.guide.force));
                }
                evaluation.frame_force = force;
                if let Some(frame) = &self.machine.frame {
                    let [place, rate] = pair(y, self.layout.frame);
                    evaluation.frame = frame.acceleration(force, place, rate);
                }
                let mut carried = evaluation.shaken;
                if self
                    .machine
                    .frame
                    .as_ref()
                    .is_some_and(|frame| frame.carries)
                {
                    carried = Some(carried.unwrap_or(origin()) + evaluation.frame);
                }
                if let Some(carried) = carried {
                    for (throw, at) in self.machine.throws.iter().zip(&mut evaluation.throws) {
                        at.carried = throw.local(carried);
                    }
                }
            },
        )
    }

    /// Where the frame is, and what drives the housings of the guides: nothing depends on them but sensors.
    #[inline(never)]
    fn drive_housings(&mut self, y: &[S]) {
        let stands = self.machine.frame.is_none() && self.machine.effects.is_empty();
        let is_bare = |throw: &Throw<S>| throw.housing.is_none();
        if stands && self.machine.throws.iter().all(is_bare) {
            return;
        }
        S::vectorised(
            #[inline(always)]
            || {
                let evaluation = &mut self.evaluation;
                let [mut place, mut rate] = pair(y, self.layout.frame);
                let on_shaft = Acting::on_shaft(&self.machine.effects);
                if let Some(shift) = on_shaft.frame_motion(evaluation.angle, evaluation.speed) {
                    place += shift[0];
                    rate += shift[1];
                }
                evaluation.frame_motion = [place, rate];
                for (throw, at) in self.machine.throws.iter().zip(&mut evaluation.throws) {
                    if let Some(housing) = &throw.housing {
                        let along = Vec2::new(at.gas.force + at.gas.effects, S::zero());
                        let force = -(along + at.joints.guide.force);
                        at.housing = housing.drive(force, [throw.local(place), throw.local(rate)]);
                    }
                }
            },
        )
    }
}
