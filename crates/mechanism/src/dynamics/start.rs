//! The state and the mode in which a machine starts, or goes on.

use super::Dynamics;
use crate::evaluation::{Evaluation, ThrowEvaluation};
use crate::joints::revolute::{JointModel, JointState, Revolute};
use crate::machine::{Machine, Throw};
use crate::mode::{ChamberMode, ContactMode, Mode, ThrowMode};
use crate::plane::origin;
use crate::scales::scales;
use crate::shaft::ShaftMotion;
use crate::state::Layout;
use crate::throw::Response;
use crate::watch::watches;
use scalar::Scalar;

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
            frame_motion: [origin(); 2],
        };
        let mut dynamics = Self {
            scales: scales(&machine, &layout),
            watches: watches(&machine),
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
}

fn place_on_link<S: Scalar>(joint: &Revolute<S>, at: Option<usize>, y: &mut [S]) {
    if let (Some(i), Some(clear)) = (at, joint.clear())
        && clear.model == JointModel::MasslessLink
    {
        y[i] = -clear.clearance;
    }
}
