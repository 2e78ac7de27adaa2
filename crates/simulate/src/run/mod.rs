//! A machine on its way through time, over plain or dual numbers.

mod ledger;

pub(crate) use ledger::Ledger;

use crate::asked::Asked;
use crate::error::{Error, MOST_SLIP};
use crate::instants::Instants;
use crate::sensor::Sensor;
use integrate::{Course, Integrator, Real, Step, System, Work};
use mechanism::frame::{Frame, FrameMotion};
use mechanism::mode::Mode;
use mechanism::{Dynamics, Evaluation, Machine, lift};
use scalar::Scalar;
use std::f64::consts::{PI, TAU};

/// Longest step, as a share of a revolution: no event is further from a look than a twentieth.
pub(crate) const LONGEST_STEP: f64 = 0.05;
/// Steps in a longest step's time, of which a usual motion takes some 20.
const HURRIED: f64 = 1000.0;

/// A machine on its way.
pub(crate) struct Run<S: Scalar> {
    dynamics: Dynamics<S>,
    integrator: Integrator<S>,
    revolution: f64,
    state: Vec<S>,
    hurried: bool,
}

/// An angular speed, rad/s, as rev/min to four decimals.
fn rpm(speed: f64) -> f64 {
    (1e4 * speed * 30.0 / PI).round() / 1e4
}

/// Where a run stands.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    /// s.
    pub time: f64,
    /// The components.
    pub state: Vec<f64>,
    /// The contacts and valves.
    pub mode: Mode<f64>,
}

impl<S: Real> Run<S> {
    /// At rest relative to the ideal mechanism; with `ledger` the works are integrated along.
    pub(crate) fn start(machine: Machine<S>, tolerance: f64, ledger: bool) -> Self {
        let revolution = TAU / machine.drive.reference_speed().value();
        let mut dynamics = Dynamics::new(machine, ledger);
        let state = dynamics.initial_state();
        let longest = LONGEST_STEP * revolution;
        let integrator = Integrator::new(&mut dynamics, 0.0, &state, tolerance, longest);
        Self {
            dynamics,
            integrator,
            revolution,
            state,
            hurried: false,
        }
    }

    /// Begins as is asked: at rest, or where a motion near it has settled. `machine` is the asked one over these numbers.
    pub(crate) fn begin(asked: &Asked, machine: Machine<S>, ledger: bool) -> Self {
        let tolerance = asked.settings.tolerance;
        let mut run = Self::start(machine, tolerance, ledger);
        let warm_start = asked.warm_start;
        if let Some((state, mode)) = warm_start.and_then(|from| from.taken_over(asked.machine)) {
            let constants = state.iter().map(|y| S::constant(*y));
            for (y, value) in run.state.iter_mut().zip(constants) {
                *y = value;
            }
            let longest = LONGEST_STEP * run.revolution;
            let (dynamics, state) = (&mut run.dynamics, &run.state);
            dynamics.resume(S::zero(), state, &lift::constants(mode));
            run.integrator = Integrator::new(dynamics, 0.0, state, tolerance, longest);
        }
        run
    }

    /// Goes on where another run, of which these are the numbers, stands; with `ledger` the works, four
    /// zeros at the end of the state, are integrated along.
    pub(crate) fn resume(
        machine: Machine<S>,
        at: &Standing,
        state: &[S],
        tolerance: f64,
        ledger: bool,
    ) -> Self {
        let mut run = Self::start(machine, tolerance, ledger);
        *run.dynamics.mode_mut() = lift::constants(&at.mode);
        let longest = LONGEST_STEP * run.revolution;
        run.integrator = Integrator::new(&mut run.dynamics, at.time, state, tolerance, longest);
        run
    }

    /// Length of a revolution at the reference speed, s.
    pub(crate) fn revolution(&self) -> f64 {
        self.revolution
    }

    /// Steps tried so far, for each throw; one of dual numbers counts for what it takes.
    pub(crate) fn steps(&self) -> u64 {
        let work = self.integrator.work();
        let throws = self.dynamics.machine().throws.len() as u64;
        // A value, and for each tangent about seven tenths of what it takes.
        let tangents = (size_of::<S>() / size_of::<f64>() - 1) as u64;
        throws * work.tried() * (10 + 7 * tangents) / 10
    }

    /// What the integration took so far.
    pub(crate) fn work(&self) -> Work {
        self.integrator.work()
    }

    /// Where a revolution ends, s. A free crank does not keep to the reference speed: the time of its
    /// next revolution follows from the speed and the angle that it has now.
    pub(crate) fn end_of(&self, revolution: u32) -> f64 {
        let Some((angle, speed)) = self.free_crank() else {
            return f64::from(revolution) * self.revolution;
        };
        let ahead = TAU * f64::from(revolution) - angle;
        self.time() + ahead / speed
    }

    /// Relative local error of its steps.
    pub(crate) fn tolerance(&self) -> f64 {
        self.integrator.tolerance()
    }

    /// The time reached, s.
    pub(crate) fn time(&self) -> f64 {
        self.integrator.time()
    }

    /// Whether it gives up early.
    pub(crate) fn hurries(&self) -> bool {
        self.hurried
    }

    /// Gives up where a revolution takes more than [`HURRIED`] steps in each longest step's time: a
    /// search tries machines that rattle without end, and need not wait for them. Nor does it wait for
    /// one to settle that comes no nearer to that.
    pub(crate) fn hurry(&mut self) {
        self.hurried = true;
        self.integrator.set_budget(HURRIED);
    }

    /// Whether the crank turns as the forces on it make it.
    pub(crate) fn is_free(&self) -> bool {
        self.dynamics.layout().crank.is_some()
    }

    /// Angle and mean speed of a crank that is free, rad and rad/s.
    fn free_crank(&self) -> Option<(f64, f64)> {
        let at = self.dynamics.layout().crank?;
        let reference = TAU / self.revolution;
        let (y, time) = (self.integrator.state(), self.integrator.time());
        let angle = reference * time + y[at].value();
        let mean = if time > 0.0 { angle / time } else { reference };
        Some((angle, mean))
    }

    /// The state where the crank stands at a whole number of revolutions, without its angle: what
    /// is left of a revolution is made up to first order.
    pub(crate) fn strobe(&mut self) -> Vec<f64> {
        let mut state: Vec<f64> = self.integrator.state().iter().map(|y| y.value()).collect();
        let Some((angle, _)) = self.free_crank() else {
            return state;
        };
        let rates = self.rates();
        let y = self.integrator.state();
        let short = TAU * (angle / TAU).round() - angle;
        if let Some(at) = self.dynamics.layout().crank {
            let delay = short / (TAU / self.revolution + y[at + 1].value());
            for (y, rate) in state.iter_mut().zip(&rates) {
                *y += rate.value() * delay;
            }
            state[at] = 0.0;
        }
        state
    }

    /// The derivative of the state by time.
    pub(crate) fn rates(&mut self) -> Vec<S> {
        let y = self.integrator.state();
        let mut rates = vec![S::zero(); y.len()];
        let time = S::constant(self.integrator.time());
        self.dynamics.derivative(time, y, &mut rates);
        rates
    }

    /// The components of the state.
    pub(crate) fn state(&self) -> &[S] {
        self.integrator.state()
    }

    /// What the forces depend on beside time, state and switches.
    pub(crate) fn memory(&mut self) -> Vec<&mut S> {
        self.dynamics.memory_mut()
    }

    /// What each component is measured by.
    pub(crate) fn scales(&self) -> Vec<f64> {
        self.dynamics.scales().iter().map(|s| s.value()).collect()
    }

    /// Which component is the angle of a crank that is free, beside that of the reference speed; its
    /// speed follows.
    pub(crate) fn crank(&self) -> Option<usize> {
        self.dynamics.layout().crank
    }

    /// Largest difference of two states, each component over its scale: of all, and without a linear frame, whose free vibration
    /// is known.
    pub(crate) fn distances(&self, a: &[f64], b: &[f64]) -> [f64; 2] {
        let frame = self.dynamics.machine().frame.as_ref();
        let is_linear = frame.is_some_and(|frame| frame.is_linear());
        let known = self.dynamics.layout().frame.filter(|_| is_linear);
        let known = known.map_or(0..0, |at| at..at + 4);
        let (mut of_all, mut of_others) = (0.0_f64, 0.0_f64);
        for (i, scale) in self.dynamics.scales().iter().enumerate() {
            let part = ((a[i] - b[i]) / scale.value()).abs();
            of_all = of_all.max(part);
            if !known.contains(&i) {
                of_others = of_others.max(part);
            }
        }
        [of_all, of_others]
    }

    /// Goes on to the end of a time, s.
    pub(crate) fn advance(&mut self, end: f64) -> Result<(), Error> {
        self.integrator.reach(&mut self.dynamics, end)?;
        self.check(end)
    }

    pub(crate) fn check(&self, time: f64) -> Result<(), Error> {
        if self
            .integrator
            .state()
            .iter()
            .all(|y| y.value().is_finite())
        {
            return self.check_crank();
        }
        Err(Error::NotFinite { time })
    }

    /// Checks that a free crank turns the way that its drive does.
    fn check_crank(&self) -> Result<(), Error> {
        let reference = TAU / self.revolution;
        let turning = self.dynamics.mode().turning.value() * reference;
        match self.free_crank() {
            Some((angle, _)) if turning < 0.0 => Err(Error::TurnsBack {
                time: self.time(),
                revolutions: angle * reference.signum() / TAU,
                stated: rpm(reference.abs()),
            }),
            _ => Ok(()),
        }
    }

    /// Checks that the crank keeps its speed, on average since `before`, where its angle and the time
    /// were taken; that speed, rad/s.
    pub(crate) fn mean_speed(&self, before: [f64; 2]) -> Result<f64, Error> {
        let reference = TAU / self.revolution;
        let Some((angle, _)) = self.free_crank() else {
            return Ok(reference);
        };
        let mean = (angle - before[0]) / (self.time() - before[1]);
        match (mean / reference - 1.0).abs() <= MOST_SLIP {
            true => Ok(mean),
            false => Err(Error::OffSpeed {
                mean: rpm(mean * reference.signum()),
                stated: rpm(reference.abs()),
            }),
        }
    }

    /// Angle of the crank and time, rad and s.
    pub(crate) fn crank_and_time(&self) -> [f64; 2] {
        let angle = self.free_crank().map_or(0.0, |(angle, _)| angle);
        [angle, self.time()]
    }

    /// Goes on to the last of the instants and shows each.
    pub(crate) fn show(
        &mut self,
        instants: Instants,
        mut look: impl FnMut(&Evaluation<S>),
    ) -> Result<(), Error> {
        let Instants { count, .. } = instants;
        let mut seen = 0;
        // Where the machine had not started yet, the first value holds.
        let now = self.integrator.time();
        let first = self
            .dynamics
            .evaluate(S::constant(now), self.integrator.state());
        while seen < count && instants.at(seen) <= now {
            look(first);
            seen += 1;
        }
        let end = instants.at(count.saturating_sub(1));
        let state = &mut self.state;
        let observe = |dynamics: &mut Dynamics<S>, step: &mut Step<S>| {
            let stop = step.start.value() + step.length.value();
            if seen < count && instants.at(seen) <= stop {
                step.extend(dynamics);
            }
            while seen < count && instants.at(seen) <= stop {
                let t = S::constant(instants.at(seen));
                step.interpolate((t - step.start) / step.length, state);
                look(dynamics.evaluate(t, state));
                seen += 1;
            }
        };
        self.integrator.watch(&mut self.dynamics, end, observe)?;
        // Rounding may leave the very last instant beyond the last step.
        let last = self
            .dynamics
            .evaluate(S::constant(end), self.integrator.state());
        for _ in seen..count {
            look(last);
        }
        self.check(end)
    }
}

impl Run<f64> {
    /// The way from here to `end`.
    pub(crate) fn course(&self, end: f64) -> Course {
        self.integrator.course(end)
    }

    /// What carries it on, and what is carried.
    pub(crate) fn both(&mut self) -> (&mut Integrator<f64>, &mut Dynamics<f64>) {
        (&mut self.integrator, &mut self.dynamics)
    }

    /// What carries it on.
    pub(crate) fn integrator(&self) -> &Integrator<f64> {
        &self.integrator
    }

    /// What carries it on.
    pub(crate) fn integrator_mut(&mut self) -> &mut Integrator<f64> {
        &mut self.integrator
    }

    /// What is carried.
    pub(crate) fn dynamics(&self) -> &Dynamics<f64> {
        &self.dynamics
    }

    /// A linear frame, and how it stands.
    pub(crate) fn linear_frame(&self) -> Option<(&Frame<f64>, FrameMotion)> {
        let frame = self.dynamics.machine().frame.as_ref();
        let at = self.dynamics.layout().frame?;
        let motion = self.state().get(at..)?.first_chunk()?;
        let frame = frame.filter(|frame| frame.is_linear())?;
        Some((frame, *motion))
    }

    /// What sensors see where it stands, but for this motion of the frame.
    pub(crate) fn seen_with_frame(
        &mut self,
        motion: FrameMotion,
        sensors: &[Sensor],
    ) -> Option<Vec<f64>> {
        let at = self.dynamics.layout().frame?;
        let mut state = self.state().to_vec();
        state[at..at + 4].copy_from_slice(&motion);
        let now = self.integrator.time();
        let evaluation = self.dynamics.evaluate(now, &state);
        let seen = sensors.iter().map(|s| s.measured.unwrapped(evaluation));
        Some(seen.collect())
    }

    /// The motion where it stands.
    pub(crate) fn evaluate(&mut self) -> &Evaluation<f64> {
        let now = self.integrator.time();
        self.dynamics.evaluate(now, self.integrator.state())
    }

    /// Goes on to the end of a time, s, and shows each step, which may be extended.
    pub(crate) fn watch(
        &mut self,
        end: f64,
        observe: impl FnMut(&mut Dynamics<f64>, &mut Step<f64>),
    ) -> Result<(), Error> {
        self.integrator.watch(&mut self.dynamics, end, observe)?;
        self.check(end)
    }

    /// Where it stands.
    pub(crate) fn standing(&self) -> Standing {
        Standing {
            time: self.integrator.time(),
            state: self.integrator.state().to_vec(),
            mode: self.dynamics.mode().clone(),
        }
    }

    /// Goes on until the crank has turned by so many revolutions.
    pub(crate) fn turn(&mut self, revolutions: u32) -> Result<(), Error> {
        let turns = TAU * f64::from(revolutions);
        let time = self.integrator.time();
        let Some((start, _)) = self.free_crank() else {
            return self.advance(time + f64::from(revolutions) * self.revolution);
        };
        let reference = TAU / self.revolution;
        let mut rate = reference;
        // A little less than what is left at a time, and then all of it: Newton's method.
        for share in [0.99, 0.99, 1.0, 1.0, 1.0] {
            let (angle, _) = self.free_crank().unwrap_or_default();
            let ahead = share * (start + turns - angle) / rate;
            if ahead <= 4.0 * f64::EPSILON * time.abs() {
                break;
            }
            self.advance(self.integrator.time() + ahead)?;
            rate = self
                .crank()
                .map_or(reference, |i| reference + self.state()[i + 1]);
        }
        Ok(())
    }
}
