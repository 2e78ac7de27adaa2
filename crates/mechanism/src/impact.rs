//! Impact without rebound, for joints of the two-mode model.

use crate::drive::Drive;
use crate::dynamics::Dynamics;
use crate::plane::{Vec2, origin};
use crate::shaft::{Shaft, Turning};
use crate::watch::Place;
use scalar::Scalar;

impl<S: Scalar> Dynamics<S> {
    /// Lets the journal at `place` hit its bearing without rebound: the rates in `y` jump, so that
    /// it no longer approaches. The energy lost is entered as damping.
    ///
    /// An impulse obeys the same equations as a force, with rates in place of their derivatives
    /// and nothing but the impulse at work.
    pub(crate) fn catch(&mut self, place: Place, t: S, y: &mut [S]) {
        self.evaluate_forces(t, y);
        let before = self.energy().total();
        let wanted = -self.joint(place).1.penetration_rate;
        for at in &mut self.evaluation_mut().throws {
            at.loads = at.loads.silent();
        }
        match place {
            Place::Main => {}
            Place::BigEnd(i) => self.evaluation_mut().throws[i].loads.big_target = wanted,
            Place::SmallEnd(i) => self.evaluation_mut().throws[i].loads.small_target = wanted,
        }
        self.evaluation_mut().main.force = origin();
        let main_target = match place {
            Place::Main => wanted,
            _ => S::zero(),
        };
        let (sine, cosine) = self.evaluation().angle.sin_cos();
        let direction = Vec2::new(cosine, sine);
        let shaft = Shaft::new(self.machine(), direction, S::zero(), origin());
        let turning = match &self.machine().drive {
            Drive::Given(_) => Turning::Acceleration(S::zero()),
            Drive::Free(_) => Turning::Torque(S::zero()),
        };
        self.respond();
        self.turn(shaft, turning, main_target);
        self.follow_apart();
        self.add_jumps(y);

        self.evaluate_forces(t, y);
        if let Some(i) = self.layout().ledger {
            y[i + 3] += before - self.energy().total();
        }
    }

    /// Adds the "accelerations" of an impulse to the rates.
    fn add_jumps(&self, y: &mut [S]) {
        let mut add = |at: Option<usize>, jump: Vec2<S>| {
            if let Some(i) = at {
                y[i + 2] += jump.x;
                y[i + 3] += jump.y;
            }
        };
        let (layout, at) = (self.layout(), self.evaluation());
        let mut stretches = Vec::new();
        add(layout.main, at.shaft.centre);
        for (layout, throw) in layout.throws.iter().zip(&at.throws) {
            add(layout.big_end, throw.accelerations.big_end);
            add(layout.small_end, throw.accelerations.small_end);
            add(layout.guide, throw.accelerations.guide);
            if let Some(i) = layout.rod {
                stretches.push((i, throw.accelerations.stretch));
            }
        }
        for (i, jump) in stretches {
            y[i + 1] += jump;
        }
        if let Some(i) = layout.crank {
            y[i + 1] += at.shaft.angular;
        }
    }
}
