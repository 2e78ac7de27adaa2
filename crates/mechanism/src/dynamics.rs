//! The equations of motion of the whole machine, written once for every scalar.

use crate::drive::Drive;
use crate::effects::{Acting, AtJoint, Joint};
use crate::energy::{self, Energy};
use crate::evaluation::{
    Evaluation, Standing, ThrowEvaluation, along_x, direction, find_joint, pair,
};
use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::{Machine, Throw};
use crate::mode::{ChamberMode, ContactMode, Mode, ThrowMode};
use crate::plane::{Vec2, moment, origin, turned};
use crate::shaft::{Shaft, ShaftMotion, Turning};
use crate::state::Layout;
use crate::system::{self, Watch};
use crate::throw::{Response, following_target};
use scalar::Scalar;

/// A machine in motion: parameters, mode, and what the last evaluation found.
#[derive(Clone, Debug)]
pub struct Dynamics<S> {
    pub(crate) machine: Machine<S>,
    layout: Layout,
    pub(crate) mode: Mode<S>,
    scales: Vec<S>,
    watches: Vec<Watch>,
    evaluation: Evaluation<S>,
    /// The throws' eliminated joints.
    responses: Vec<Response<S>>,
    /// Whether the machine is plain.
    plain: bool,
    /// Whether a force at an end of a rod follows from accelerations.
    rigid: bool,
    /// Whether the crank pins' accelerations are more than their bias: not at constant speed in an ideal
    /// main bearing.
    pins_give: bool,
}

impl<S: Scalar> Dynamics<S> {
    /// The machine at rest in its mode at t = 0: contacts apart, valves as the dead centres say.
    /// With `ledger` the state carries the energy ledger along.
    pub fn new(machine: Machine<S>, ledger: bool) -> Self {
        let layout = Layout::new(&machine, ledger);
        let zero = S::zero();
        let throws = machine.throws.len();
        let mode = Mode {
            turning: S::one(),
            main: ContactMode::apart(),
            throws: vec![
                ThrowMode {
                    big_end: ContactMode::apart(),
                    small_end: ContactMode::apart(),
                    guide: [ContactMode::apart(); 4],
                    outward: S::one(),
                    head_end: ChamberMode::closed(),
                    crank_end: ChamberMode::closed(),
                };
                throws
            ],
        };
        let evaluation = Evaluation {
            angle: zero,
            speed: zero,
            shaft: ShaftMotion {
                angular: zero,
                centre: origin(),
                torque: zero,
                bearing_force: origin(),
                push: zero,
            },
            main: JointState::ideal(),
            throws: vec![ThrowEvaluation::none(); throws],
            frame: origin(),
            shaken: None,
            frame_force: origin(),
        };
        let mut dynamics = Self {
            scales: system::scales(&machine, &layout),
            watches: system::watches(&machine),
            plain: machine.is_plain(),
            rigid: machine.throws.iter().any(Throw::has_rigid_end),
            pins_give: !machine.drive.is_constant() || machine.main.clear().is_some(),
            machine,
            layout,
            mode,
            evaluation,
            responses: vec![Response::none(); throws],
        };
        dynamics.start();
        dynamics
    }

    /// Sets the mode that the initial state calls for.
    fn start(&mut self) {
        let y = self.initial_state();
        self.close_links();
        self.set_outward(S::zero(), &y);
        self.set_valves(S::zero(), &y);
    }

    /// Puts the machine into the mode of the state `y` at `t`, which another machine of the same
    /// build left in the mode `left`. Contacts are taken over: where the new parameters contradict
    /// them, a guard is overdue, and the integrator switches it at once. Strokes and valves follow from
    /// the state; a stroke that is no longer the same forgets what its chambers had trapped.
    pub fn resume(&mut self, t: S, y: &[S], left: &Mode<S>) {
        self.mode.clone_from(left);
        self.set_outward(t, y);
        for (mode, left) in self.mode.throws.iter_mut().zip(&left.throws) {
            let other = S::zero().lt((mode.outward - left.outward).abs());
            for chamber in [&mut mode.head_end, &mut mode.crank_end] {
                chamber.trapped = S::select(other, S::one(), chamber.trapped);
            }
        }
        self.set_valves(t, y);
    }

    /// Sets the valves that the state calls for.
    fn set_valves(&mut self, t: S, y: &[S]) {
        self.evaluate(t, y);
        for (mode, throw) in self.mode.throws.iter_mut().zip(&self.evaluation.throws) {
            throw.gas.set_valves(mode);
        }
    }

    /// Journals on massless links follow from the beginning.
    fn close_links(&mut self) {
        let link = |joint: &Revolute<S>, mode: &mut ContactMode<S>| {
            if joint
                .clear()
                .is_some_and(|c| c.model == JointModel::MasslessLink)
            {
                mode.touching = S::one();
            }
        };
        link(&self.machine.main, &mut self.mode.main);
        for (throw, mode) in self.machine.throws.iter().zip(&mut self.mode.throws) {
            link(&throw.big_end, &mut mode.big_end);
            link(&throw.small_end, &mut mode.small_end);
        }
    }

    fn set_outward(&mut self, t: S, y: &[S]) {
        let (angle, speed) = self.crank(t, y);
        let turning = S::select(speed.lt(S::zero()), -S::one(), S::one());
        self.mode.turning = turning;
        for (throw, mode) in self.machine.throws.iter().zip(&mut self.mode.throws) {
            let (sine, cosine) = throw.local_angle(angle).sin_cos();
            // At a dead centre the sine is rounding; there the new phase counts.
            let tiny = S::constant(1e-12);
            let at_centre = sine.abs().lt(tiny);
            let by_sine = S::select((sine * turning).lt(S::zero()), S::zero(), S::one());
            let by_cosine = S::select(cosine.lt(S::zero()), S::zero(), S::one());
            mode.outward = S::select(at_centre, by_cosine, by_sine);
        }
    }

    /// The machine.
    pub fn machine(&self) -> &Machine<S> {
        &self.machine
    }

    /// What the state vector holds.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The present mode.
    pub fn mode(&self) -> &Mode<S> {
        &self.mode
    }

    /// The present mode, to be changed: whoever steps lanes puts each lane into its own.
    pub fn mode_mut(&mut self) -> &mut Mode<S> {
        &mut self.mode
    }

    /// Puts the machine into a mode of a plain one of its build.
    pub fn set_mode(&mut self, mode: &Mode) {
        self.mode.each(mode, |number, of| *number = S::constant(of));
    }

    pub(crate) fn watches(&self) -> &[Watch] {
        &self.watches
    }

    pub(crate) fn tolerance_scales(&self) -> &[S] {
        &self.scales
    }

    /// A revolute joint and its state at the last evaluation.
    pub(crate) fn joint(&self, place: Place) -> (&Revolute<S>, &JointState<S>) {
        let (machine, at) = (&self.machine, &self.evaluation);
        match place {
            Place::Main => (&machine.main, &at.main),
            Place::BigEnd(i) => (&machine.throws[i].big_end, &at.throws[i].joints.big_end),
            Place::SmallEnd(i) => (&machine.throws[i].small_end, &at.throws[i].joints.small_end),
        }
    }

    pub(crate) fn evaluation_mut(&mut self) -> &mut Evaluation<S> {
        &mut self.evaluation
    }

    /// What the last evaluation found.
    pub fn evaluation(&self) -> &Evaluation<S> {
        &self.evaluation
    }

    /// The state of MODEL.md, section 4: the ideal mechanism's pose and rates, journals centred.
    /// A journal on a massless link cannot be centred: it starts where the ideal joint's force
    /// would press it.
    pub fn initial_state(&self) -> Vec<S> {
        let mut y = vec![S::zero(); self.layout.dimension];
        for (throw, layout) in self.machine.throws.iter().zip(&self.layout.throws) {
            // Toward the head: the side on which inertia presses at top dead centre.
            for (joint, at) in [
                (&throw.big_end, layout.big_end),
                (&throw.small_end, layout.small_end),
            ] {
                place_on_link(joint, at, &mut y);
            }
        }
        place_on_link(&self.machine.main, self.layout.main, &mut y);
        y
    }

    /// Crank angle and speed.
    #[inline(always)]
    fn crank(&self, t: S, y: &[S]) -> (S, S) {
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

    /// Evaluates the equations of motion at `(t, y)` in the present mode.
    pub fn evaluate(&mut self, t: S, y: &[S]) -> &Evaluation<S> {
        self.evaluate_forces(t, y);
        self.respond();
        self.turn_shaft(t);
        self.follow_apart();
        self.shake_frame(y);
        &self.evaluation
    }

    /// As [`evaluate`](Self::evaluate), but for what sensors on crosshead, frame and cylinder do not see.
    pub fn evaluate_sensed(&mut self, t: S, y: &[S]) -> &Evaluation<S> {
        // Effects may shake the frame.
        if self.machine.effects.is_empty() {
            self.evaluate_rates(t, y);
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
            let forces = throw.has_rigid_end().then(|| response.forces(pin));
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

    /// Kinetic, potential and elastic energy at the last evaluation, J.
    #[inline(never)]
    pub fn energy(&self) -> Energy<S> {
        S::vectorised(
            #[inline(always)]
            || energy::of(&self.machine, &self.evaluation),
        )
    }
}

impl Dynamics<f64> {
    /// What gas and back pressure hold for the pistons at the last evaluation, J, to an unknown constant:
    /// with ideal valves they never do more work than this falls by. None where effects act on the
    /// machine, or where compression and expansion have different exponents (heat does work there).
    pub fn gas_energy(&self) -> Option<f64> {
        if !self.machine.effects.is_empty() {
            return None;
        }
        let throws = self.machine.throws.iter().zip(&self.evaluation.throws);
        throws
            .map(|(throw, at)| at.gas.held(throw, &at.motion))
            .sum()
    }
}

/// A revolute joint of the machine.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// The main bearing.
    Main,
    /// The big end of a throw.
    BigEnd(usize),
    /// The small end of a throw.
    SmallEnd(usize),
}

fn place_on_link<S: Scalar>(joint: &Revolute<S>, at: Option<usize>, y: &mut [S]) {
    if let (Some(i), Some(clear)) = (at, joint.clear())
        && clear.model == JointModel::MasslessLink
    {
        y[i] = -clear.clearance;
    }
}
