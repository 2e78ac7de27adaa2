//! What sensors see of a run: its motion at equally spaced instants.
//!
//! Instants are many, four to eight of them to a recorded sample, so that those within a step are
//! evaluated side by side.

use crate::chain::UnderWay;
use crate::lookout::{self, Lookout};
use crate::run::{Instants, Run};
use crate::sensor::Sensor;
use crate::trace::Trace;
use integrate::Step;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Evaluation};
use std::ops::Range;

/// Series under way.
pub(crate) struct Sampler<'a> {
    sensors: &'a [Sensor],
    instants: Instants,
    seen: usize,
    series: Vec<UnderWay>,
    /// The motion itself, at the instants of which it is asked for.
    trace: Option<(Trace, Range<usize>)>,
    lookout: Box<dyn Lookout>,
    /// The mode that the lookout's machine is in.
    mode: Mode,
    /// Instants within a step.
    times: Vec<f64>,
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
            lookout: lookout::at(dynamics.machine(), dynamics.layout().ledger.is_some()),
            mode: dynamics.mode().clone(),
            times: Vec::new(),
            state: vec![0.0; dimension],
            series,
            sensors,
            instants,
            seen: 0,
            trace,
        };
        sampler.lookout.set_mode(&sampler.mode);
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
        if within == 0 {
            return;
        }
        if *dynamics.mode() != self.mode {
            self.finish();
            self.mode.clone_from(dynamics.mode());
            self.lookout.set_mode(&self.mode);
        }
        let instants = self.seen..self.seen + within;
        self.times.clear();
        self.times.extend(instants.map(|i| self.instants.at(i)));
        let series = &mut self.series;
        let mut show = |i: usize, seen: &[f64]| series[i].extend(seen.iter().copied());
        self.lookout
            .look(step, &self.times, self.sensors, &mut show);
        self.seen += within;
    }

    /// Looks at the instants that wait.
    fn finish(&mut self) {
        let series = &mut self.series;
        let mut show = |i: usize, seen: &[f64]| series[i].extend(seen.iter().copied());
        self.lookout.finish(self.sensors, &mut show);
    }

    /// What each sensor has recorded since `start`, s. Rounding may leave the very last instant beyond
    /// the last step.
    pub fn end_with(mut self, run: &mut Run<f64>, start: f64) -> (Vec<Vec<f64>>, Option<Trace>) {
        self.finish();
        let last = run.evaluate();
        while self.seen < self.instants.count {
            self.look(last);
        }
        let series = self.series.into_iter().map(|series| series.end(start));
        (series.collect(), self.trace.map(|(trace, _)| trace))
    }
}
