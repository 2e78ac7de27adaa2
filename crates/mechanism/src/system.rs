//! The machine as a system to integrate: derivatives, guards, switches.

use crate::dynamics::Dynamics;
use crate::effects::{Acting, Acts, End};
use crate::gas::GasState;
use crate::joints::contact_guards::switch_contact;
use crate::joints::guide::Guide;
use crate::joints::revolute::{JointModel, Revolute};
use crate::mode::{ContactMode, flagged};
use crate::plane::Vec2;
use crate::watch::{Place, Watch, Watched};
use integrate::{Real, System};
use scalar::{Scalar, inlined};

/// Writes the derivative of the two coordinates at `index` and of their rates.
#[inline(always)]
fn write<S: Scalar>(index: Option<usize>, second: Vec2<S>, y: &[S], dy: &mut [S]) {
    let Some(i) = index else { return };
    if let ([_, _, first @ ..], [to, ..]) = (&y[i..i + 4], dy[i..i + 4].as_chunks_mut().0) {
        *to = [first[0], first[1], second.x, second.y];
    }
}

impl<S: Scalar> Dynamics<S> {
    /// Writes the derivative of the state that belongs to the last evaluation.
    #[inline(always)]
    pub(crate) fn write_derivative(&self, y: &[S], dy: &mut [S]) {
        let (layout, at) = (self.layout(), self.evaluation());
        write(layout.main, at.shaft.centre, y, dy);
        for (layout, throw) in layout.throws.iter().zip(&at.throws) {
            write(layout.big_end, throw.accelerations.big_end, y, dy);
            write(layout.small_end, throw.accelerations.small_end, y, dy);
            write(layout.guide, throw.accelerations.guide, y, dy);
            if let Some(i) = layout.rod {
                dy[i] = y[i + 1];
                dy[i + 1] = throw.accelerations.stretch;
            }
            if let Some(i) = layout.gas {
                dy[i..i + 2].copy_from_slice(&throw.gas.drift);
            }
        }
        write(layout.frame, at.frame, y, dy);
        if let Some(i) = layout.crank {
            dy[i] = y[i + 1];
            dy[i + 1] = at.shaft.angular;
        }
        if layout.ledger.is_some() {
            self.write_powers(dy);
        }
    }

    /// Writes the derivative of the works.
    #[inline(never)]
    fn write_powers(&self, dy: &mut [S]) {
        let Some(i) = self.layout().ledger else {
            return;
        };
        let powers = self.powers();
        dy[i] = powers.gas;
        dy[i + 1] = powers.drive;
        dy[i + 2] = powers.friction;
        dy[i + 3] = powers.damping;
    }

    /// True where a joint's guard needs the forces of rigid joints; an impact there takes energy at once.
    #[inline(always)]
    pub fn has_two_mode_joint(&self) -> bool {
        let two_mode = |joint: &Revolute<S>| {
            joint
                .clear()
                .is_some_and(|c| c.model == JointModel::TwoMode)
        };
        two_mode(&self.machine().main)
            || self
                .machine()
                .throws
                .iter()
                .any(|t| two_mode(&t.big_end) || two_mode(&t.small_end))
    }

    /// Writes the guards in the order of [`watches`](crate::watch::watches).
    #[inline(never)]
    pub(crate) fn write_guards(&self, guards: &mut [S]) {
        S::vectorised(
            #[inline(always)]
            || {
                let (machine, at, mode) = (self.machine(), self.evaluation(), self.mode());
                let mut rest = guards.iter_mut();
                let mut put = inlined(
                    #[inline(always)]
                    |values: &[S]| {
                        // The values first, so that the one after the last is not taken off the guards.
                        for (value, guard) in values.iter().zip(rest.by_ref()) {
                            *guard = *value;
                        }
                    },
                );
                if let Revolute::Clear(clear) = &machine.main {
                    put(&clear.guards(&at.main, &mode.main, at.shaft.push));
                }
                let turning = mode.turning;
                let throws = || machine.throws.iter().zip(&at.throws).zip(&mode.throws);
                for ((throw, at), mode) in throws() {
                    let forces = &at.accelerations;
                    if let Revolute::Clear(clear) = &throw.big_end {
                        let state = &at.joints.big_end;
                        let push = state.normal.dot(&forces.big_force);
                        put(&clear.guards(state, &mode.big_end, push));
                    }
                    if let Revolute::Clear(clear) = &throw.small_end {
                        let state = &at.joints.small_end;
                        let push = state.normal.dot(&forces.small_force);
                        put(&clear.guards(state, &mode.small_end, push));
                    }
                }
                for ((throw, at), mode) in throws() {
                    if let Guide::Clear(clear) = &throw.guide {
                        for (corner, mode) in at.joints.guide.corners.iter().zip(&mode.guide) {
                            put(&clear.guards(corner, mode));
                        }
                    }
                    let sine = at.motion.angle_sin_cos.0 * turning;
                    put(&[flagged(mode.outward, sine, -sine)]);
                    put(&at.gas.head_end.guards(&mode.head_end));
                    if throw.cylinder.crank_end.is_some() {
                        put(&at.gas.crank_end.guards(&mode.crank_end));
                    }
                }
                if !machine.drive.is_constant() {
                    put(&[at.speed * turning]);
                }
            },
        )
    }
}

impl<S: Real> System<S> for Dynamics<S> {
    fn dimension(&self) -> usize {
        self.layout().dimension
    }

    #[inline(always)]
    fn derivative(&mut self, t: S, y: &[S], dy: &mut [S]) {
        self.rates(t, y, dy);
    }

    fn scales(&self) -> &[S] {
        self.tolerance_scales()
    }

    fn guard_count(&self) -> usize {
        self.watches().len()
    }

    fn guards(&mut self, t: S, y: &[S], guards: &mut [S]) {
        if self.has_two_mode_joint() {
            self.evaluate(t, y);
        } else {
            self.evaluate_forces(t, y);
        }
        self.write_guards(guards);
    }

    fn guards_here(&mut self, guards: &mut [S]) -> bool {
        self.write_guards(guards);
        true
    }

    fn switch(&mut self, guard: usize, t: S, y: &mut [S]) {
        self.evaluate(t, y);
        let Watch { place, part } = self.watches()[guard];
        match place {
            Watched::Joint(place) => self.switch_joint(place, part, t, y),
            Watched::Corner(throw, corner) => {
                let rate =
                    self.evaluation().throws[throw].joints.guide.corners[corner].penetration_rate;
                let mode = &mut self.mode_mut().throws[throw].guide[corner];
                switch_contact(mode, part, rate);
            }
            Watched::Gas(throw) if part == 0 => {
                self.begin_stroke(throw, t, y, GasState::past_centre);
            }
            Watched::Gas(throw) => self.switch_valve(throw, part),
            Watched::Crank => self.turn_back(t, y),
        }
    }
}

impl<S: Real> Dynamics<S> {
    fn switch_joint(&mut self, place: Place, guard: usize, t: S, y: &mut [S]) {
        let (model, rate) = {
            let (joint, state) = self.joint(place);
            let model = joint.clear().map(|c| c.model);
            (model, state.penetration_rate)
        };
        if model == Some(JointModel::TwoMode) {
            let touching = self.contact_mode(place).touching;
            if touching.value() > 0.0 {
                self.contact_mode(place).touching = S::zero();
            } else {
                self.contact_mode(place).touching = S::one();
                self.catch(place, t, y);
            }
        } else {
            switch_contact(self.contact_mode(place), guard, rate);
        }
    }

    /// What the present forces depend on beside time, state and switches:
    ///
    /// - the approach speeds of closed contacts whose law has a coefficient of restitution, m/s;
    /// - what chambers have trapped where no dead centre has set it.
    pub fn memory_mut(&mut self) -> Vec<&mut S> {
        let Dynamics { machine, mode, .. } = self;
        let joint = |joint: &Revolute<S>| {
            joint
                .clear()
                .is_some_and(|c| c.model == JointModel::ThreeMode && c.contact.remembers())
        };
        let mut contacts = vec![(joint(&machine.main), &mut mode.main)];
        let mut chambers = Vec::new();
        for (throw, mode) in machine.throws.iter().zip(&mut mode.throws) {
            contacts.push((joint(&throw.big_end), &mut mode.big_end));
            contacts.push((joint(&throw.small_end), &mut mode.small_end));
            let guide = matches!(&throw.guide, Guide::Clear(c) if c.contact.remembers());
            contacts.extend(mode.guide.iter_mut().map(|corner| (guide, corner)));
            chambers.extend([&mut mode.head_end, &mut mode.crank_end]);
        }
        let remembered = contacts
            .into_iter()
            .filter(|(remembers, contact)| *remembers && contact.touching.value() > 0.0)
            .map(|(_, contact)| &mut contact.approach);
        let trapped = chambers.into_iter().map(|chamber| &mut chamber.trapped);
        remembered
            .chain(trapped.filter(|trapped| trapped.value() != 1.0))
            .collect()
    }

    fn contact_mode(&mut self, place: Place) -> &mut ContactMode<S> {
        let mode = self.mode_mut();
        match place {
            Place::Main => &mut mode.main,
            Place::BigEnd(throw) => &mut mode.throws[throw].big_end,
            Place::SmallEnd(throw) => &mut mode.throws[throw].small_end,
        }
    }

    /// The crank turns back: every stroke ends where it is.
    fn turn_back(&mut self, t: S, y: &mut [S]) {
        let mode = self.mode_mut();
        mode.turning = -mode.turning;
        for throw in 0..self.machine().throws.len() {
            self.begin_stroke(throw, t, y, |before, next, _, _| before.turned_back(next));
        }
    }

    /// The next stroke of a throw begins: at a dead centre, or where the crank turns back. `trapped` is what
    /// each chamber takes over into it, from the gas before and after, whether it expands, and whether its
    /// suction valve is held.
    fn begin_stroke(
        &mut self,
        throw: usize,
        t: S,
        y: &mut [S],
        trapped: impl Fn(&GasState<S>, &GasState<S>, S, bool) -> S,
    ) {
        let before = self.evaluation().throws[throw].gas;
        if let Some(i) = self.layout().throws[throw].gas {
            y[i..i + 2].fill(S::zero());
        }
        let mode = &mut self.mode_mut().throws[throw];
        mode.outward = S::one() - mode.outward;
        let outward = mode.outward;
        mode.head_end.trapped = S::one();
        mode.crank_end.trapped = S::one();
        self.evaluate(t, y);
        let next = self.evaluation().throws[throw].gas;
        let held = [End::Head, End::Crank].map(|end| {
            let effects = Acting::on_throw(&self.machine().effects, throw);
            effects.at_end(end).any(|e| e.suction_held().is_some())
        });
        let double = self.machine().throws[throw].cylinder.crank_end.is_some();
        let mode = &mut self.mode_mut().throws[throw];
        mode.head_end.trapped = trapped(&before.head_end, &next.head_end, outward, held[0]);
        if double {
            let expanding = S::one() - outward;
            mode.crank_end.trapped =
                trapped(&before.crank_end, &next.crank_end, expanding, held[1]);
        }
        self.evaluate(t, y);
        // The new polytrope decides which valves are open.
        let gas = self.evaluation().throws[throw].gas;
        gas.set_valves(&mut self.mode_mut().throws[throw]);
    }

    /// A valve opens or closes.
    fn switch_valve(&mut self, throw: usize, part: usize) {
        let mode = &mut self.mode_mut().throws[throw];
        let chamber = if part <= 2 {
            &mut mode.head_end
        } else {
            &mut mode.crank_end
        };
        let valve = if part % 2 == 1 {
            &mut chamber.suction
        } else {
            &mut chamber.discharge
        };
        *valve = S::one() - *valve;
    }
}
