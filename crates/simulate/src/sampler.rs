//! What sensors see of a run: its motion at equally spaced instants.
//!
//! A recorded sample takes four to eight instants. Where many of them lie within a step, the motion is evaluated at a few
//! others, and a polynomial through these values gives what the sensors see. Those within a step are evaluated side by side;
//! where several runs are in lanes, those within their steps are.

use crate::chain::UnderWay;
use crate::instants::Instants;
use crate::lookout::{self, Lookout};
use crate::penetration::{Penetration, Watch};
use crate::polynomial::{NODES, Nodes, Polynomial};
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
    series: Series,
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

/// What is kept of what a sensor sees.
pub(crate) enum Taken {
    /// Its record.
    Recorded(Box<UnderWay>),
    /// The inner samples themselves.
    Inner(Vec<f64>),
}

impl Taken {
    fn extend(&mut self, inner: impl IntoIterator<Item = f64>) {
        match self {
            Self::Recorded(under_way) => under_way.extend(inner),
            Self::Inner(all) => all.extend(inner),
        }
    }

    fn end(self, start: f64) -> Vec<f64> {
        match self {
            Self::Recorded(under_way) => under_way.end(start),
            Self::Inner(all) => all,
        }
    }
}

/// What the sensors have seen.
struct Series {
    /// What is kept of each sensor.
    taken: Vec<Taken>,
    /// Largest magnitude that each has seen.
    largest: Vec<f64>,
    /// Of the integration.
    tolerance: f64,
    nodes: Nodes,
    /// Scratch: shares of a step, and values there.
    shares: Vec<f64>,
    values: Vec<f64>,
    polynomials: Vec<Polynomial>,
}

/// What was seen of a run.
pub(crate) struct Seen {
    /// What was kept of each sensor.
    pub series: Vec<Vec<f64>>,
    /// The motion itself, where it was asked for.
    pub trace: Option<Trace>,
    /// How deep each joint with clearance was pressed in.
    pub penetrations: Vec<Penetration>,
}

impl Series {
    fn new(taken: Vec<Taken>, tolerance: f64) -> Self {
        Self {
            largest: vec![0.0; taken.len()],
            polynomials: Vec::with_capacity(taken.len()),
            tolerance,
            nodes: Nodes::new(),
            shares: Vec::new(),
            values: Vec::new(),
            taken,
        }
    }

    /// Takes in what sensor number `i` sees at the next instants.
    fn extend(&mut self, i: usize, sensor: &Sensor, seen: impl Iterator<Item = f64>) {
        let largest = &mut self.largest[i];
        self.taken[i].extend(seen.map(|x| {
            *largest = largest.max(x.abs());
            sensor.measured.wrapped(x)
        }));
    }

    /// Takes in what the sensors see at these shares of a step by polynomials through what `seen` gives for each sensor at
    /// each node. False, and nothing taken in, where one of them leaves out too much.
    fn interpolate(
        &mut self,
        sensors: &[Sensor],
        shares: impl Iterator<Item = f64>,
        seen: impl Fn(usize, usize) -> f64,
    ) -> bool {
        self.polynomials.clear();
        for i in 0..sensors.len() {
            let values = std::array::from_fn(|node| seen(i, node));
            let through = self.nodes.through(&values, self.largest[i], self.tolerance);
            let Some(polynomial) = through else {
                return false;
            };
            self.polynomials.push(polynomial);
        }
        self.shares.clear();
        self.shares.extend(shares);
        for (i, sensor) in sensors.iter().enumerate() {
            let mut values = std::mem::take(&mut self.values);
            self.polynomials[i].evaluate(&self.shares, &mut values);
            self.extend(i, sensor, values.iter().copied());
            self.values = values;
        }
        true
    }
}

impl<'a> Sampler<'a> {
    /// Begins where the run stands. What lies before it started has its first value.
    pub fn begin(
        run: &mut Run<f64>,
        sensors: &'a [Sensor],
        taken: Vec<Taken>,
        instants: Instants,
        trace: Option<(Trace, Range<usize>)>,
    ) -> Self {
        let dimension = run.state().len();
        let mut sampler = Self {
            joints: Watch::new(run.dynamics()),
            lookout: None,
            times: Vec::new(),
            state: vec![0.0; dimension],
            series: Series::new(taken, run.tolerance()),
            sensors,
            instants,
            seen: 0,
            trace,
        };
        let now = run.time();
        let first = run.evaluate();
        while sampler.seen < instants.count && instants.at(sampler.seen) <= now {
            sampler.trace(first, sampler.seen);
            sampler.sample(first);
        }
        sampler
    }

    /// The last instant, s.
    pub fn end(&self) -> f64 {
        self.instants.end()
    }

    fn sample(&mut self, at: &Evaluation<f64>) {
        for (i, sensor) in self.sensors.iter().enumerate() {
            let seen = sensor.measured.unwrapped(at);
            self.series.extend(i, sensor, std::iter::once(seen));
        }
        self.seen += 1;
    }

    fn trace(&mut self, at: &Evaluation<f64>, instant: usize) {
        if let Some((trace, range)) = &mut self.trace
            && range.contains(&instant)
        {
            trace.push(at);
        }
    }

    /// Takes in the instants within a step by what `seen` gives for each sensor at each node. False, and nothing taken in,
    /// where that is not exact enough.
    fn interpolate(
        &mut self,
        [start, length]: [f64; 2],
        within: usize,
        seen: impl Fn(usize, usize) -> f64,
    ) -> bool {
        let instants = self.instants;
        let shares = (self.seen..self.seen + within).map(|i| (instants.at(i) - start) / length);
        let taken = self.series.interpolate(self.sensors, shares, seen);
        if taken {
            self.seen += within;
        }
        taken
    }

    /// Looks at the instants within a step.
    pub fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        self.joints.update(|i| step.to[i]);
        let within = self.instants.within(self.seen, step.start + step.length);
        if within == 0 {
            return;
        }
        step.extend(dynamics);
        if self.trace.is_some() {
            let mut state = std::mem::take(&mut self.state);
            for instant in self.seen..self.seen + within {
                let t = self.instants.at(instant);
                step.interpolate((t - step.start) / step.length, &mut state);
                self.trace(dynamics.evaluate(t, &state), instant);
            }
            self.state = state;
        }
        self.face(dynamics);
        if NODES < within {
            let (shares, start, length) = (self.series.nodes.shares, step.start, step.length);
            let seen = self.see(step, &shares.map(|share| start + length * share));
            if self.interpolate([start, length], within, |i, node| seen[i][node]) {
                return;
            }
        }
        let mut times = std::mem::take(&mut self.times);
        times.clear();
        times.extend((self.seen..self.seen + within).map(|i| self.instants.at(i)));
        let (sensors, series) = (self.sensors, &mut self.series);
        let mut show = |i: usize, seen: &[f64]| series.extend(i, &sensors[i], seen.iter().copied());
        if let Some((lookout, _)) = &mut self.lookout {
            lookout.observe(step, &times, sensors, &mut show);
        }
        self.times = times;
        self.seen += within;
    }

    /// Has a lookout at the machine in the mode that it is in.
    fn face(&mut self, dynamics: &Dynamics<f64>) {
        if (self.lookout.as_ref()).is_some_and(|(_, mode)| mode == dynamics.mode()) {
            return;
        }
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

    /// What each sensor sees at these times within a step. No instant waits after it.
    fn see(&mut self, step: &Step<f64>, times: &[f64]) -> Vec<Vec<f64>> {
        self.finish();
        let mut all = vec![Vec::with_capacity(times.len()); self.sensors.len()];
        let mut show = |i: usize, seen: &[f64]| all[i].extend_from_slice(seen);
        if let Some((lookout, _)) = &mut self.lookout {
            lookout.observe(step, times, self.sensors, &mut show);
            lookout.finish(self.sensors, &mut show);
        }
        all
    }

    /// Looks at the instants that wait.
    fn finish(&mut self) {
        let (sensors, series) = (self.sensors, &mut self.series);
        let mut show = |i: usize, seen: &[f64]| series.extend(i, &sensors[i], seen.iter().copied());
        if let Some((lookout, _)) = &mut self.lookout {
            lookout.finish(sensors, &mut show);
        }
    }

    /// What each sensor has recorded since `start`, s. Rounding may leave the very last instant beyond
    /// the last step.
    pub fn end_with(mut self, run: &mut Run<f64>, start: f64) -> Seen {
        self.finish();
        let last = run.evaluate();
        while self.seen < self.instants.count {
            self.trace(last, self.seen);
            self.sample(last);
        }
        let taken = self.series.taken.into_iter();
        Seen {
            series: taken.map(|taken| taken.end(start)).collect(),
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
            within[lane] = sampler.instants.within(sampler.seen, stop.get(lane));
        }
    }
    if within == [0; W] {
        return;
    }
    step.extend(machines);
    let times = |sampler: &Sampler, lane: usize, i: usize| match NODES < within[lane] {
        true => {
            let share = sampler.series.nodes.shares[i];
            step.start.get(lane) + step.length.get(lane) * share
        }
        false => sampler.instants.at(sampler.seen + i),
    };
    let seen = see_lanes(
        samplers,
        machines,
        step,
        within.map(|n| n.min(NODES)),
        times,
    );
    let mut left = [0; W];
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        let Some(sampler) = sampler else { continue };
        if within[lane] <= NODES {
            sampler.take(lane, within[lane], &seen);
            continue;
        }
        let (count, here) = (sampler.sensors.len(), [step.start, step.length]);
        let seen = |i: usize, node: usize| seen[node * count + i].get(lane);
        if !sampler.interpolate(here.map(|x| x.get(lane)), within[lane], seen) {
            left[lane] = within[lane];
        }
    }
    if left == [0; W] {
        return;
    }
    let times = |sampler: &Sampler, _: usize, i: usize| sampler.instants.at(sampler.seen + i);
    let seen = see_lanes(samplers, machines, step, left, times);
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let Some(sampler) = sampler {
            sampler.take(lane, left[lane], &seen);
        }
    }
}

/// What the sensors see at so many instants within the steps of the lanes, sensor after sensor at each. `times` gives
/// the instants of a lane.
fn see_lanes<L: Lanes<W>, const W: usize>(
    samplers: &[Option<&mut Sampler>; W],
    machines: &mut SideBySide<L>,
    step: &Step<L>,
    counts: [usize; W],
    times: impl Fn(&Sampler, usize, usize) -> f64,
) -> Vec<L> {
    let most = counts.into_iter().max().unwrap_or(0);
    let sensors = samplers.iter().flatten().map(|s| s.sensors).next();
    let sensors = sensors.unwrap_or_default();
    let mut state = vec![L::zero(); step.from.len()];
    let mut seen = Vec::with_capacity(most * sensors.len());
    for i in 0..most {
        let mut instants = step.start;
        for (lane, sampler) in samplers.iter().enumerate() {
            if let Some(sampler) = sampler
                && i < counts[lane]
            {
                instants.set(lane, times(sampler, lane, i));
            }
        }
        let share = L::vectorised(
            #[inline(always)]
            || (instants - step.start) / step.length,
        );
        step.interpolate(share, &mut state);
        let at = machines.evaluate_sensed(instants, &state);
        for sensor in sensors {
            seen.push(L::vectorised(
                #[inline(always)]
                || sensor.measured.unwrapped(at),
            ));
        }
    }
    seen
}

impl Sampler<'_> {
    /// Takes in what is seen of this lane at the next instants.
    fn take<L: Lanes<W>, const W: usize>(&mut self, lane: usize, count: usize, seen: &[L]) {
        for (i, sensor) in self.sensors.iter().enumerate() {
            let of_sensor = seen.iter().skip(i).step_by(self.sensors.len()).take(count);
            self.series
                .extend(i, sensor, of_sensor.map(|x| x.get(lane)));
        }
        self.seen += count;
    }
}
