//! What sensors see of a run: its motion at equally spaced instants.
//!
//! Instants are many, four to eight of them to a recorded sample, so that those within a step are
//! evaluated side by side.

use crate::chain::UnderWay;
use crate::run::{Instants, Run};
use crate::sensor::Sensor;
use crate::trace::Trace;
use integrate::Step;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Evaluation, lift};
use scalar::Lanes;
use std::ops::Range;

/// Instants that are evaluated side by side.
const WIDTH: usize = 8;

/// Series under way.
pub(crate) struct Sampler<'a> {
    sensors: &'a [Sensor],
    instants: Instants,
    seen: usize,
    series: Vec<UnderWay>,
    /// The motion itself, at the instants of which it is asked for.
    trace: Option<(Trace, Range<usize>)>,
    wide: Dynamics<Lanes<WIDTH>>,
    /// The mode that `wide` is in.
    mode: Mode,
    states: Vec<Lanes<WIDTH>>,
    state: Vec<f64>,
}

impl<'a> Sampler<'a> {
    /// Begins where the run stands. What lies before it started has its first value.
    pub fn begin(
        run: &mut Run<f64>,
        sensors: &'a [Sensor],
        series: Vec<UnderWay>,
        instants: Instants,
        trace: Option<(Trace, Range<usize>)>,
    ) -> Self {
        let dynamics = run.dynamics();
        let dimension = run.state().len();
        let mut sampler = Self {
            wide: Dynamics::new(
                lift::constants(dynamics.machine()),
                dynamics.layout().ledger.is_some(),
            ),
            mode: dynamics.mode().clone(),
            states: vec![Lanes([0.0; WIDTH]); dimension],
            state: vec![0.0; dimension],
            series,
            sensors,
            instants,
            seen: 0,
            trace,
        };
        *sampler.wide.mode_mut() = lift::constants(&sampler.mode);
        let now = run.time();
        let first = run.evaluate();
        while sampler.seen < instants.count && instants.at(sampler.seen) <= now {
            sampler.look(first);
        }
        sampler
    }

    /// The last instant, s.
    pub fn end(&self) -> f64 {
        self.instants.at(self.instants.count.saturating_sub(1))
    }

    fn look(&mut self, at: &Evaluation<f64>) {
        for (sensor, series) in self.sensors.iter().zip(&mut self.series) {
            series.extend([sensor.measured.value(at)]);
        }
        if let Some((trace, range)) = &mut self.trace
            && range.contains(&self.seen)
        {
            trace.push(at);
        }
        self.seen += 1;
    }

    /// Looks at the instants within a step.
    pub fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &Step<f64>) {
        let stop = step.start + step.length;
        let left = self.instants.count - self.seen;
        let mut within = 0;
        while within < left && self.instants.at(self.seen + within) <= stop {
            within += 1;
        }
        if self.trace.is_some() {
            for _ in 0..within {
                let t = self.instants.at(self.seen);
                let mut state = std::mem::take(&mut self.state);
                step.interpolate((t - step.start) / step.length, &mut state);
                self.look(dynamics.evaluate(t, &state));
                self.state = state;
            }
            return;
        }
        if within > 0 && *dynamics.mode() != self.mode {
            self.mode.clone_from(dynamics.mode());
            *self.wide.mode_mut() = lift::constants(&self.mode);
        }
        while within > 0 {
            let count = within.min(WIDTH);
            self.look_at_several(step, count);
            within -= count;
        }
    }

    /// Looks at the next `count` instants, all of them within the step.
    fn look_at_several(&mut self, step: &Step<f64>, count: usize) {
        // Lanes without an instant of their own look at the last one.
        let instant = |lane: usize| self.instants.at(self.seen + lane.min(count - 1));
        let times = Lanes(std::array::from_fn(instant));
        let share = (times - step.start) / step.length;
        step.interpolate_lanes(share, &mut self.states);
        let at = self.wide.evaluate(times, &self.states);
        for (sensor, series) in self.sensors.iter().zip(&mut self.series) {
            let measured = sensor.measured;
            let values = measured.unwrapped(at);
            series.extend(values.0[..count].iter().map(|x| measured.wrapped(*x)));
        }
        self.seen += count;
    }

    /// What each sensor has recorded since `start`, s. Rounding may leave the very last instant beyond
    /// the last step.
    pub fn end_with(mut self, run: &mut Run<f64>, start: f64) -> (Vec<Vec<f64>>, Option<Trace>) {
        let last = run.evaluate();
        while self.seen < self.instants.count {
            self.look(last);
        }
        let series = self.series.into_iter().map(|series| series.end(start));
        (series.collect(), self.trace.map(|(trace, _)| trace))
    }
}
