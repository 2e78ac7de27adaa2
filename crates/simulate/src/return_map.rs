//! The machine under way from one passage of its section to the next.

use crate::error::Error;
use crate::run::LONGEST_STEP;
use crate::section::{Impact, Joint, JointPoint, Revolution, ThrowPoint, clear_joints};
use crate::warm_start::rescale;
use integrate::{Integrator, Step, System};
use mechanism::mode::{ContactMode, Mode};
use mechanism::{Dynamics, Machine};
use std::f64::consts::TAU;

/// The integration is asked for so much of a reference period at a time.
const STRETCH: f64 = 0.25;
/// Reference periods without a revolution after which a free crank counts as stalled.
const PATIENCE: f64 = 50.0;
/// Shares of a step at which the acceleration is looked at for its peak.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A machine that runs from one passage of the section to the next.
pub(crate) struct ReturnMap {
    watched: Watched,
    integrator: Integrator<f64>,
    tolerance: f64,
}

impl ReturnMap {
    /// The machine at rest in its initial state.
    pub fn start(machine: &Machine, angle: f64, tolerance: f64) -> Self {
        let watched = Watched::new(machine, angle);
        let state = watched.dynamics.initial_state();
        Self::at(watched, 0.0, &state, tolerance)
    }

    fn at(mut watched: Watched, time: f64, state: &[f64], tolerance: f64) -> Self {
        let longest = LONGEST_STEP * watched.period();
        Self {
            integrator: Integrator::new(&mut watched, time, state, tolerance, longest),
            watched,
            tolerance,
        }
    }

    /// The motion goes on in `machine`, whose parameters differ: crank angle and speed, rates and
    /// contacts stay as they are. Where a clearance differs, a journal in contact keeps its
    /// penetration, and one in flight its place relative to the clearance. A machine of another
    /// build, or one that turns the other way, starts afresh. Impacts and peaks of the revolution
    /// under way are forgotten.
    pub fn carried(mut self, machine: &Machine) -> Self {
        let mut watched = Watched::new(machine, self.watched.section);
        let before = &mut self.watched.dynamics;
        let same_sense = watched.sense == self.watched.sense;
        if !same_sense || before.layout() != watched.dynamics.layout() {
            return Self::start(machine, self.watched.section, self.tolerance);
        }
        let mut y = self.integrator.state().to_vec();
        let at = before.evaluate(self.integrator.time(), &y);
        let (turned, speed) = ((watched.sense * at.angle).rem_euclid(TAU), at.speed);
        rescale(before.machine(), &watched.dynamics, &mut y);
        let reference = watched.dynamics.machine().drive.reference_speed();
        let time = turned / reference.abs();
        if let Some(i) = watched.dynamics.layout().crank {
            y[i] = 0.0;
            y[i + 1] = speed - reference;
        }
        watched.dynamics.resume(time, &y, before.mode());
        // The section was passed less than half a revolution ago.
        let passages = (turned - watched.sense * watched.section) / TAU;
        watched.next = (passages + 0.5).floor() + 1.0;
        Self::at(watched, time, &y, self.tolerance)
    }

    /// Goes on to the next passage, and up to a quarter beyond; with `peaks` the peak of the
    /// acceleration is looked for on the way (0 otherwise).
    pub fn revolve(&mut self, peaks: bool) -> Result<Revolution, Error> {
        let begin = self.integrator.time();
        let period = self.watched.period();
        loop {
            if let Some(revolution) = self.watched.finished.take() {
                return Ok(revolution);
            }
            let time = self.integrator.time();
            if time - begin > PATIENCE * period {
                return Err(Error::Stalled { time });
            }
            let end = time + STRETCH * period;
            let observe = |watched: &mut Watched, step: &mut Step<f64>| {
                if peaks {
                    step.extend(watched);
                    watched.look_for_peaks(step);
                }
            };
            self.integrator.watch(&mut self.watched, end, observe)?;
            if !self.integrator.state().iter().all(|y| y.is_finite()) {
                return Err(Error::NotFinite { time: end });
            }
        }
    }
}

/// The machine as a system with one guard more: the section.
struct Watched {
    dynamics: Dynamics<f64>,
    joints: Vec<Joint>,
    /// Crank angle of the section, rad.
    section: f64,
    sense: f64,
    /// Number of the passage to come.
    next: f64,
    impacts: Vec<Impact>,
    /// Peak of each throw in this revolution.
    peaks: Vec<f64>,
    /// The revolution that ended and was not taken yet.
    finished: Option<Revolution>,
    /// Room for a state.
    state: Vec<f64>,
}

/// A contact before a switch.
struct Contact {
    joint: Joint,
    corner: usize,
    touching: bool,
    offset: [f64; 2],
    approach: f64,
}

impl Watched {
    fn new(machine: &Machine, section: f64) -> Self {
        let mut machine = machine.clone();
        // The frame only listens, and no section looks at it.
        machine.frame = None;
        let sense = machine.drive.reference_speed().signum();
        let joints = clear_joints(&machine);
        let dynamics = Dynamics::new(machine, false);
        Self {
            joints,
            section,
            sense,
            // A whole revolution at least.
            next: (-sense * section / TAU).ceil() + 1.0,
            impacts: Vec::new(),
            peaks: vec![0.0; dynamics.machine().throws.len()],
            finished: None,
            state: dynamics.initial_state(),
            dynamics,
        }
    }

    /// Period of the reference speed, s.
    fn period(&self) -> f64 {
        TAU / self.dynamics.machine().drive.reference_speed().abs()
    }

    /// Angle that the crank has yet to turn to the next passage where it was evaluated last, rad.
    fn ahead(&self) -> f64 {
        let angle = self.dynamics.evaluation().angle;
        self.next * TAU - self.sense * (angle - self.section)
    }

    /// Ends a revolution.
    fn pass(&mut self, t: f64, y: &[f64]) {
        let at = self.dynamics.evaluate(t, y);
        let peaks = self.peaks.iter_mut().map(std::mem::take);
        let throws = at.throws.iter().zip(peaks).map(|(throw, peak)| ThrowPoint {
            velocity: throw.motion.crosshead_rate,
            acceleration: throw.accelerations.crosshead,
            peak_acceleration: peak,
        });
        let (angle, throws) = (at.angle, throws.collect());
        let joints = self.joints.iter().map(|joint| self.point(*joint));
        self.finished = Some(Revolution {
            time: t,
            angle,
            joints: joints.collect(),
            throws,
            impacts: std::mem::take(&mut self.impacts),
        });
        self.next += 1.0;
    }

    /// A joint at the last evaluation.
    fn point(&self, joint: Joint) -> JointPoint {
        let at = self.dynamics.evaluation();
        let [offset, rate] = match joint {
            Joint::Main => [at.main.offset, at.main.rate],
            Joint::BigEnd(i) => {
                let joint = &at.throws[i].joints.big_end;
                [joint.offset, joint.rate]
            }
            Joint::SmallEnd(i) => {
                let joint = &at.throws[i].joints.small_end;
                [joint.offset, joint.rate]
            }
            Joint::Guide(i) => {
                let guide = &at.throws[i].joints.guide;
                [guide.position, guide.rate]
            }
        };
        JointPoint {
            offset: [offset.x, offset.y],
            rate: [rate.x, rate.y],
        }
    }

    /// All contacts at the last evaluation.
    fn contacts(&self) -> Vec<Contact> {
        let at = self.dynamics.evaluation();
        let mut contacts = Vec::new();
        for &joint in &self.joints {
            let modes = contact_modes(self.dynamics.mode(), joint);
            for (corner, mode) in modes.iter().enumerate() {
                contacts.push(Contact {
                    joint,
                    corner,
                    touching: mode.touching > 0.0,
                    offset: self.point(joint).offset,
                    approach: match joint {
                        Joint::Main => at.main.penetration_rate,
                        Joint::BigEnd(i) => at.throws[i].joints.big_end.penetration_rate,
                        Joint::SmallEnd(i) => at.throws[i].joints.small_end.penetration_rate,
                        Joint::Guide(i) => {
                            at.throws[i].joints.guide.corners[corner].penetration_rate
                        }
                    },
                });
            }
        }
        contacts
    }

    /// Keeps the largest acceleration of each throw within `step`.
    fn look_for_peaks(&mut self, step: &Step<f64>) {
        let mut seen = vec![[0.0; LOOKS.len()]; self.peaks.len()];
        for (look, share) in LOOKS.into_iter().enumerate() {
            step.interpolate(share, &mut self.state);
            let t = step.start + share * step.length;
            let at = self.dynamics.evaluate(t, &self.state);
            for (seen, throw) in seen.iter_mut().zip(&at.throws) {
                seen[look] = throw.accelerations.crosshead.abs();
            }
        }
        for (peak, seen) in self.peaks.iter_mut().zip(&seen) {
            *peak = peak.max(top(seen));
        }
    }
}

/// The top of the parabolas through neighbouring values.
fn top(values: &[f64; LOOKS.len()]) -> f64 {
    let highest = values.iter().copied().fold(0.0, f64::max);
    let vertex = |three: &[f64]| {
        let [before, at, after] = [three[0], three[1], three[2]];
        let inside = at > before && at > after;
        let curvature = before - 2.0 * at + after;
        inside.then(|| at - (after - before).powi(2) / (8.0 * curvature))
    };
    values.windows(3).filter_map(vertex).fold(highest, f64::max)
}

fn contact_modes(mode: &Mode<f64>, joint: Joint) -> &[ContactMode<f64>] {
    match joint {
        Joint::Main => std::slice::from_ref(&mode.main),
        Joint::BigEnd(i) => std::slice::from_ref(&mode.throws[i].big_end),
        Joint::SmallEnd(i) => std::slice::from_ref(&mode.throws[i].small_end),
        Joint::Guide(i) => &mode.throws[i].guide,
    }
}

impl System<f64> for Watched {
    fn dimension(&self) -> usize {
        self.dynamics.dimension()
    }

    #[inline(always)]
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) {
        self.dynamics.derivative(t, y, dy);
    }

    fn scales(&self) -> &[f64] {
        self.dynamics.scales()
    }

    fn guard_count(&self) -> usize {
        self.dynamics.guard_count() + 1
    }

    fn guards(&mut self, t: f64, y: &[f64], guards: &mut [f64]) {
        let (own, theirs) = guards.split_at_mut(1);
        self.dynamics.guards(t, y, theirs);
        own[0] = self.ahead();
    }

    fn guards_here(&mut self, guards: &mut [f64]) -> bool {
        let (own, theirs) = guards.split_at_mut(1);
        own[0] = self.ahead();
        self.dynamics.guards_here(theirs)
    }

    fn switch(&mut self, guard: usize, t: f64, y: &mut [f64]) {
        let Some(guard) = guard.checked_sub(1) else {
            return self.pass(t, y);
        };
        let angle = self.dynamics.evaluate(t, y).angle.rem_euclid(TAU);
        let before = self.contacts();
        self.dynamics.switch(guard, t, y);
        for contact in before.into_iter().filter(|contact| !contact.touching) {
            let modes = contact_modes(self.dynamics.mode(), contact.joint);
            if modes[contact.corner].touching > 0.0 {
                self.impacts.push(Impact {
                    joint: contact.joint,
                    corner: contact.corner,
                    time: t,
                    angle,
                    offset: contact.offset,
                    approach: contact.approach,
                });
            }
        }
    }
}
