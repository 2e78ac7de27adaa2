//! A machine on its way through time, over plain or dual numbers.

use crate::record::Error;
use crate::settings::Transient;
use integrate::{Integrator, Real, Step, System, Work};
use mechanism::{Dynamics, Evaluation, Machine};
use std::f64::consts::TAU;

/// Longest step, as a share of a revolution: no event is further from a look than a twentieth.
const LONGEST_STEP: f64 = 0.05;
/// Steps in a longest step's time, of which a usual motion takes some 20.
const HURRIED: f64 = 1000.0;
/// Periods, in revolutions, that count as settled.
const PERIODS: [u32; 3] = [1, 2, LONGEST_PERIOD as u32];
const LONGEST_PERIOD: usize = 4;

/// A machine on its way.
pub(crate) struct Run<S> {
    dynamics: Dynamics<S>,
    integrator: Integrator<S>,
    revolution: f64,
    state: Vec<S>,
}

/// Equally spaced instants at which a run is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instants {
    /// The first, s.
    pub first: f64,
    /// How many a second.
    pub rate: f64,
    /// How many in all.
    pub count: usize,
}

impl Instants {
    fn at(&self, index: usize) -> f64 {
        self.first + index as f64 / self.rate
    }
}

/// Energy and works at an instant, J.
pub(crate) struct Ledger {
    energy: f64,
    works: [f64; 4],
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
        }
    }

    /// Length of a revolution at the reference speed, s.
    pub(crate) fn revolution(&self) -> f64 {
        self.revolution
    }

    /// What the integration took so far.
    pub(crate) fn work(&self) -> Work {
        self.integrator.work()
    }

    /// Leaves the start behind, but for the last revolution, which leads into the record. Tells how
    /// many revolutions the transient takes, and after how many the motion repeats itself, if it had
    /// settled.
    pub(crate) fn leave_transient(
        &mut self,
        transient: Transient,
    ) -> Result<(u32, Option<u32>), Error> {
        let (change, at_most) = match transient {
            Transient::Revolutions(count) => (0.0, count),
            Transient::Settled { change, at_most } => (change, at_most),
        };
        let mut strobes = vec![self.strobe()];
        for revolution in 1..at_most {
            self.revolve(revolution)?;
            let now = self.strobe();
            let repeats = |period: &u32| {
                let earlier = strobes.len().checked_sub(*period as usize);
                earlier.is_some_and(|i| self.distance(&now, &strobes[i]) < change)
            };
            // Not before the start has had a revolution to pass.
            if revolution > 1
                && let Some(period) = PERIODS.into_iter().find(repeats)
            {
                return Ok((revolution + 1, Some(period)));
            }
            strobes.push(now);
            let keep = strobes.len().saturating_sub(LONGEST_PERIOD);
            strobes.drain(..keep);
        }
        Ok((at_most, None))
    }

    /// Goes on to the end of a revolution. A free crank does not keep to the reference speed: the
    /// time of its next revolution follows from the speed and the angle that it has now.
    fn revolve(&mut self, revolution: u32) -> Result<(), Error> {
        let end = f64::from(revolution) * self.revolution;
        let Some((angle, speed)) = self.free_crank() else {
            return self.advance(end);
        };
        let ahead = TAU * f64::from(revolution) - angle;
        self.advance(self.integrator.time() + ahead / speed)
    }

    /// Gives up where a revolution takes more than [`HURRIED`] steps in each longest step's time: a
    /// search tries machines that rattle without end, and need not wait for them.
    pub(crate) fn hurry(&mut self) {
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
    fn strobe(&mut self) -> Vec<f64> {
        let mut state: Vec<f64> = self.integrator.state().iter().map(|y| y.value()).collect();
        let Some((angle, _)) = self.free_crank() else {
            return state;
        };
        let y = self.integrator.state().to_vec();
        let mut rates = vec![S::zero(); y.len()];
        let time = S::constant(self.integrator.time());
        self.dynamics.derivative(time, &y, &mut rates);
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

    /// Largest difference of two states, each component over its scale.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let scales = self.dynamics.scales();
        let parts = a.iter().zip(b).zip(scales);
        parts
            .map(|((a, b), scale)| ((a - b) / scale.value()).abs())
            .fold(0.0, f64::max)
    }

    fn advance(&mut self, end: f64) -> Result<(), Error> {
        self.integrator
            .advance(&mut self.dynamics, end, |_, _| ())?;
        self.check(end)
    }

    fn check(&self, time: f64) -> Result<(), Error> {
        if self
            .integrator
            .state()
            .iter()
            .all(|y| y.value().is_finite())
        {
            return Ok(());
        }
        Err(Error::NotFinite { time })
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
        let observe = |dynamics: &mut Dynamics<S>, step: &Step<S>| {
            let stop = step.start.value() + step.length.value();
            while seen < count && instants.at(seen) <= stop {
                let t = S::constant(instants.at(seen));
                step.interpolate((t - step.start) / step.length, state);
                look(dynamics.evaluate(t, state));
                seen += 1;
            }
        };
        self.integrator.advance(&mut self.dynamics, end, observe)?;
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
    /// Where energy and works stand.
    pub(crate) fn ledger(&mut self) -> Ledger {
        let y = self.integrator.state().to_vec();
        self.dynamics.evaluate(self.integrator.time(), &y);
        let mut works = [0.0; 4];
        if let Some(i) = self.dynamics.layout().ledger {
            works.copy_from_slice(&y[i..i + 4]);
        }
        Ledger {
            energy: self.dynamics.energy().total(),
            works,
        }
    }

    /// What the ledger misses since `before`, over the larger of the works.
    pub(crate) fn residual(&mut self, before: &Ledger) -> f64 {
        let now = self.ledger();
        let [gas, drive, friction, damping] =
            std::array::from_fn(|i| now.works[i] - before.works[i]);
        let missing = now.energy - before.energy - (gas + drive - friction - damping);
        let turned = gas.abs() + drive.abs() + friction.abs() + damping.abs();
        if turned > 0.0 { missing / turned } else { 0.0 }
    }
}
