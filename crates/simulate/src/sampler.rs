//! What sensors see of a run: its motion at equally spaced instants.
//!
//! A recorded sample takes four to eight instants. Those within a step are evaluated side by side. Where
//! several runs are in lanes, those within their steps are.

use crate::chain::UnderWay;
use crate::instants::Instants;
use crate::lookout::{self, Lookout};
use crate::penetration::{Penetration, Watch};
use crate::run::Run;
use crate::sensor::Sensor;
use crate::trace::Trace;
use integrate::Step;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Evaluation, SideBySide};
use scalar::Lanes;
use std::ops::Range;

/// Series under way.
pub(crate) struct Sampler<'a> {
    sensors: &'a [Sensor],
    instants: Instants,
    seen: usize,
    series: Vec<UnderWay>,
    /// The motion itself, at the instants of which it is asked for.
    trace: Option<(Trace, Range<usize>)>,
    /// How deep joints are pressed in.
    joints: Watch,
    /// Where it looks at a run that is in no lane, and the mode that its machine is in.
    lookout: Option<(Box<dyn Lookout>, Mode)>,
    /// Instants within a step.
    times: Vec<f64>,
    state: Vec<f64>,
}

/// What was seen of a run.
pub(crate) struct Seen {
    /// What each sensor has recorded.
    pub series: Vec<Vec<f64>>,
    /// The motion itself, where it was asked for.
    pub trace: Option<Trace>,
    /// How deep each joint with clearance was pressed in.
    pub penetrations: Vec<Penetration>,
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
        let dimension = run.state().len();
        let mut sampler = Self {
            joints: Watch::new(run.dynamics()),
            lookout: None,
            times: Vec::new(),
            state: vec![0.0; dimension],
            series,
            sensors,
            instants,
            seen: 0,
            trace,
        };
        let now = run.time();
        let first = run.evaluate();
        while sampler.seen < instants.count && instants.at(sampler.seen) <= now {
            sampler.sample(first);
        }
        sampler
    }

    /// The last instant, s.
    pub fn end(&self) -> f64 {
        self.instants.at(self.instants.count.saturating_sub(1))
    }

    fn sample(&mut self, at: &Evaluation<f64>) {
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

    /// How many instants come up to the time `stop`, s.
    fn within(&self, stop: f64) -> usize {
        let left = self.instants.count - self.seen;
        let mut within = 0;
        while within < left && self.instants.at(self.seen + within) <= stop {
            within += 1;
        }
        within
    }

    /// Looks at the instants within a step.
    pub fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        self.joints.update(|i| step.to[i]);
        let within = self.within(step.start + step.length);
        if within == 0 {
            return;
        }
        step.extend(dynamics);
        if self.trace.is_some() {
            for _ in 0..within {
                let t = self.instants.at(self.seen);
                let mut state = std::mem::take(&mut self.state);
                step.interpolate((t - step.start) / step.length, &mut state);
                self.sample(dynamics.evaluate(t, &state));
                self.state = state;
            }
            return;
        }
        if (self.lookout.as_ref()).is_none_or(|(_, mode)| mode != dynamics.mode()) {
            self.finish();
            let (mut lookout, mut mode) = self.lookout.take().unwrap_or_else(|| {
                let ledger = dynamics.layout().ledger.is_some();
                let lookout = lookout::at(dynamics.machine(), ledger);
                (lookout, dynamics.mode().clone())
            });
            mode.clone_from(dynamics.mode());
            lookout.set_mode(&mode);
            self.lookout = Some((lookout, mode));
        }
        let instants = self.seen..self.seen + within;
        self.times.clear();
        self.times.extend(instants.map(|i| self.instants.at(i)));
        let series = &mut self.series;
        let mut show = |i: usize, seen: &[f64]| series[i].extend(seen.iter().copied());
        if let Some((lookout, _)) = &mut self.lookout {
            lookout.look(step, &self.times, self.sensors, &mut show);
        }
        self.seen += within;
    }

    /// Looks at the instants that wait.
    fn finish(&mut self) {
        let series = &mut self.series;
        let mut show = |i: usize, seen: &[f64]| series[i].extend(seen.iter().copied());
        if let Some((lookout, _)) = &mut self.lookout {
            lookout.finish(self.sensors, &mut show);
        }
    }

    /// What each sensor has recorded since `start`, s. Rounding may leave the very last instant beyond
    /// the last step.
    pub fn end_with(mut self, run: &mut Run<f64>, start: f64) -> Seen {
        self.finish();
        let last = run.evaluate();
        while self.seen < self.instants.count {
            self.sample(last);
        }
        let series = self.series.into_iter().map(|series| series.end(start));
        Seen {
            series: series.collect(),
            trace: self.trace.map(|(trace, _)| trace),
            penetrations: self.joints.end(),
        }
    }
}

/// Looks at the instants within the steps of the lanes that stand, whose samplers see the same quantities.
pub(crate) fn observe_lanes<L: Lanes<W>, const W: usize>(
    samplers: &mut [Option<&mut Sampler>; W],
    machines: &mut SideBySide<L>,
    step: &mut Step<L>,
    stands: [bool; W],
) {
    let stop = step.start + step.length;
    let mut within = [0; W];
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let Some(sampler) = sampler
            && stands[lane]
        {
            sampler.joints.update(|i| step.to[i].get(lane));
            within[lane] = sampler.within(stop.get(lane));
        }
    }
    let Some(sensors) = samplers.iter().flatten().map(|s| s.sensors).next() else {
        return;
    };
    let most = within.into_iter().max().unwrap_or(0);
    if most == 0 {
        return;
    }
    step.extend(machines);
    let mut state = vec![L::zero(); step.from.len()];
    let mut found: Vec<L> = Vec::with_capacity(most * sensors.len());
    for i in 0..most {
        let mut instants = step.start;
        for (lane, sampler) in samplers.iter().enumerate() {
            if let Some(sampler) = sampler
                && i < within[lane]
            {
                instants.set(lane, sampler.instants.at(sampler.seen + i));
            }
        }
        let share = L::vectorised(
            #[inline(always)]
            || (instants - step.start) / step.length,
        );
        step.interpolate(share, &mut state);
        let at = machines.evaluate_sensed(instants, &state);
        for sensor in sensors {
            found.push(L::vectorised(
                #[inline(always)]
                || sensor.measured.unwrapped(at),
            ));
        }
    }
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let Some(sampler) = sampler {
            let series = sampler.sensors.iter().zip(&mut sampler.series);
            for (i, (sensor, series)) in series.enumerate() {
                let seen = found
                    .iter()
                    .skip(i)
                    .step_by(sensors.len())
                    .take(within[lane]);
                series.extend(seen.map(|x| sensor.measured.wrapped(x.get(lane))));
            }
            sampler.seen += within[lane];
        }
    }
}
