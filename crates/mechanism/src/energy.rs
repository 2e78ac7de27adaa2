//! Energy of the moving parts, and the ledger of works that must balance it:
//!
//! ```text
//! Δ(kinetic + potential + elastic) = work of gas + work of drive − friction loss − damping loss
//! ```

use crate::effects::Acting;
use crate::evaluation::{Evaluation, ThrowEvaluation};
use crate::joints::guide::Guide;
use crate::joints::revolute::{JointState, Revolute};
use crate::machine::{Machine, Throw};
use crate::plane::{Vec2, turned};
use scalar::{Scalar, inlined};

/// Energy of the machine's moving parts, J.
#[derive(Clone, Copy, Debug)]
pub struct Energy<S> {
    /// Of motion. The shaft's rotation counts only where the crank is free to change it.
    pub kinetic: S,
    /// Of height.
    pub potential: S,
    /// Of contact deformation.
    pub elastic: S,
}

impl<S: Scalar> Energy<S> {
    /// All together.
    #[inline(always)]
    pub fn total(&self) -> S {
        self.kinetic + self.potential + self.elastic
    }
}

/// The rates of the ledger's four works, W.
#[derive(Clone, Copy, Debug)]
pub struct Powers<S> {
    /// Of the gas (and line pressures) on the crosshead bodies.
    pub gas: S,
    /// Of the drive on the shaft, and of the effects that shake the frame.
    pub drive: S,
    /// Lost to friction, rings included.
    pub friction: S,
    /// Lost to contact damping, with what `max(0, .)` takes.
    pub damping: S,
}

#[inline(always)]
pub(crate) fn energy<S: Scalar>(machine: &Machine<S>, at: &Evaluation<S>) -> Energy<S> {
    let gravity = Vec2::new(machine.gravity_x, machine.gravity_y);
    let shaft = &machine.crankshaft;
    let (sine, cosine) = at.angle.sin_cos();
    let lever = Vec2::new(cosine, sine) * shaft.eccentricity;
    let mut energy = Energy {
        kinetic: shaft.inertia * at.speed * at.speed * 0.5
            + shaft.mass
                * (at.main.rate.dot(&at.main.rate) * 0.5
                    + at.main.rate.dot(&turned(lever)) * at.speed),
        potential: -gravity.dot(&(at.main.offset + lever)) * shaft.mass,
        elastic: stored(&machine.main, &at.main),
    };
    for (i, (throw, part)) in machine.throws.iter().zip(&at.throws).enumerate() {
        let down = throw.local(gravity);
        let motion = &part.motion;
        let [centre, velocity] = part.rod_centre(throw);
        let spin = motion.lengthening() * motion.rod_rate;
        let guide = &part.joints.guide;
        let crosshead = Vec2::new(motion.crosshead, guide.position.x);
        let crosshead_rate = Vec2::new(motion.crosshead_rate, guide.rate.x);
        energy.kinetic += (throw.rod.mass * velocity.dot(&velocity)
            + throw.rod.inertia * (spin * spin + motion.stretch_rate * motion.stretch_rate)
            + throw.crosshead.mass * crosshead_rate.dot(&crosshead_rate)
            + throw.crosshead.inertia * guide.rate.y * guide.rate.y)
            * 0.5;
        energy.potential +=
            -(down.dot(&centre) * throw.rod.mass + down.dot(&crosshead) * throw.crosshead.mass);
        energy.elastic += stored(&throw.big_end, &part.joints.big_end);
        energy.elastic += stored(&throw.small_end, &part.joints.small_end);
        if let Some(spring) = Acting::on_throw(&machine.effects, i).rod() {
            let longer = motion.stretch * throw.rod.length;
            energy.elastic += spring.energy(longer, motion.stretch);
        }
        if let Guide::Clear(clear) = &throw.guide {
            for corner in &guide.corners {
                energy.elastic += clear.contact.stored_energy(corner.penetration);
            }
        }
    }
    energy
}

#[inline(always)]
fn stored<S: Scalar>(joint: &Revolute<S>, state: &JointState<S>) -> S {
    match joint {
        Revolute::Clear(clear) if !joint.is_rigid() => {
            clear.contact.stored_energy(state.penetration)
        }
        _ => S::zero(),
    }
}

/// Momentum of the moving parts in the frame, kg m/s.
#[inline(always)]
fn momentum<S: Scalar>(machine: &Machine<S>, at: &Evaluation<S>) -> Vec2<S> {
    let shaft = &machine.crankshaft;
    let (sine, cosine) = at.angle.sin_cos();
    let lever = turned(Vec2::new(cosine, sine)) * (shaft.eccentricity * at.speed);
    let mut momentum = (at.main.rate + lever) * shaft.mass;
    for (throw, part) in machine.throws.iter().zip(&at.throws) {
        let [_, rod] = part.rod_centre(throw);
        let crosshead = Vec2::new(part.motion.crosshead_rate, part.joints.guide.rate.x);
        momentum += throw.local(rod * throw.rod.mass + crosshead * throw.crosshead.mass);
    }
    momentum
}

impl<S: Scalar> ThrowEvaluation<S> {
    /// Centre of mass of the rod, m, and its velocity, m/s.
    #[inline(always)]
    fn rod_centre(&self, throw: &Throw<S>) -> [Vec2<S>; 2] {
        let motion = &self.motion;
        let along = motion.along_rod() * throw.rod.centre_of_mass;
        let arm = along * motion.lengthening();
        let growth = along * motion.stretch_rate;
        let [eye, rate] = motion.big_eye;
        [eye + arm, rate + turned(arm) * motion.rod_rate + growth]
    }
}

/// The rates at which the works of the ledger grow.
#[inline(always)]
pub(crate) fn powers<S: Scalar>(machine: &Machine<S>, at: &Evaluation<S>) -> Powers<S> {
    let mut powers = Powers {
        gas: S::zero(),
        drive: at.shaft.torque * at.speed,
        friction: at.main.friction_power(at.shaft.push),
        damping: at.main.damping_power,
    };
    if let Some(acceleration) = at.shaken {
        powers.drive -= momentum(machine, at).dot(&acceleration);
    }
    for (i, (throw, part)) in machine.throws.iter().zip(&at.throws).enumerate() {
        if let Some(spring) = Acting::on_throw(&machine.effects, i).rod() {
            let rate = part.motion.stretch_rate;
            powers.damping += spring.damping(throw) * rate * rate;
        }
        let (joints, motion) = (&part.joints, &part.motion);
        let push = inlined(
            #[inline(always)]
            |joint: &Revolute<S>, state: &JointState<S>, force: Vec2<S>| {
                if joint.is_rigid() {
                    state.friction_power(state.normal.dot(&force))
                } else {
                    state.friction_power(S::zero())
                }
            },
        );
        let accelerations = &part.accelerations;
        powers.gas += part.gas.force * motion.crosshead_rate;
        powers.friction += push(&throw.big_end, &joints.big_end, accelerations.big_force)
            + push(
                &throw.small_end,
                &joints.small_end,
                accelerations.small_force,
            )
            + joints.guide.friction_power
            - part.gas.effects * motion.crosshead_rate;
        powers.damping += joints.big_end.damping_power
            + joints.small_end.damping_power
            + joints.guide.damping_power;
    }
    powers
}

impl<S: Scalar> JointState<S> {
    /// Power lost to friction, W; `push` is the normal force of a rigid joint model.
    #[inline(always)]
    fn friction_power(&self, push: S) -> S {
        (self.friction_force + self.coefficient * push) * self.slip
    }
}
