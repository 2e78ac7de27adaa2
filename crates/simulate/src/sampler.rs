//! What sensors see of a run: its motion at equally spaced instants.
//!
//! A recorded sample takes four to eight instants. Where many of them lie within a step, the motion is evaluated at a few
//! others, and a polynomial through these values gives what the sensors see. Those within a step are evaluated side by side;
//! where several runs are in lanes, those within their steps are. Of a motion that repeats itself one period is kept as such
//! polynomials, and all that is left of the record is its repetition.

use crate::chain::UnderWay;
use crate::instants::Instants;
use crate::lookout::{self, Lookout};
use crate::penetration::{Penetration, Watch};
use crate::period::{Part, Period};
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
    /// The period of which the rest of the record is the repetition, while it is looked at.
    period: Option<Period>,
    /// The motion itself, where it is asked for.
    traced: Option<Traced>,
    /// How deep joints are pressed in.
    joints: Watch,
    /// Where it looks at a run that is in no lane, and the mode that its machine is in.
    lookout: Option<(Box<dyn Lookout>, Mode)>,
    /// Instants within a step.
    times: Vec<f64>,
    state: Vec<f64>,
}

/// The motion itself, at some of the instants.
struct Traced {
    trace: Trace,
    range: Range<usize>,
    seen: usize,
}

impl Traced {
    /// Takes in the motion at the next instant.
    fn push(&mut self, at: &Evaluation<f64>) {
        if self.range.contains(&self.seen) {
            self.trace.push(at);
        }
        self.seen += 1;
    }
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

    /// The polynomials of all sensors through what `seen` gives for each at each node. False where one of them leaves out
    /// too much, unless it `must` do.
    fn fit(&mut self, sensors: usize, seen: impl Fn(usize, usize) -> f64, must: bool) -> bool {
        self.polynomials.clear();
        for i in 0..sensors {
            let values = std::array::from_fn(|node| seen(i, node));
            let near = (self.nodes).near(&values, self.largest[i], self.tolerance);
            match near.or_else(|| must.then(|| self.nodes.through(&values))) {
                Some(polynomial) => self.polynomials.push(polynomial),
                None => return false,
            }
        }
        true
    }

    /// Takes in what the polynomials of the sensors say at these shares of what they were fitted to.
    fn evaluate(
        &mut self,
        sensors: &[Sensor],
        polynomials: &[Polynomial],
        shares: impl Iterator<Item = f64>,
    ) {
        self.shares.clear();
        self.shares.extend(shares);
        let mut values = std::mem::take(&mut self.values);
        for (i, (sensor, polynomial)) in sensors.iter().zip(polynomials).enumerate() {
            polynomial.evaluate(&self.shares, &mut values);
            self.extend(i, sensor, values.iter().copied());
        }
        self.values = values;
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
            period: None,
            traced: trace.map(|(trace, range)| Traced {
                trace,
                range,
                seen: 0,
            }),
            sensors,
            instants,
            seen: 0,
        };
        let now = run.time();
        let first = run.evaluate();
        while sampler.seen < instants.count && instants.at(sampler.seen) <= now {
            if let Some(traced) = &mut sampler.traced {
                traced.push(first);
            }
            sampler.sample(first);
        }
        sampler
    }

    /// The last instant, s.
    pub fn end(&self) -> f64 {
        self.instants.end()
    }

    /// Whether all instants lie ahead.
    pub fn is_ahead(&self) -> bool {
        self.seen == 0
    }

    fn sample(&mut self, at: &Evaluation<f64>) {
        for (i, sensor) in self.sensors.iter().enumerate() {
            let seen = sensor.measured.unwrapped(at);
            self.series.extend(i, sensor, std::iter::once(seen));
        }
        self.seen += 1;
    }

    /// The motion repeats itself from the time `start` on, whenever `length` has passed, both s: looks at one period.
    pub fn repeat(&mut self, start: f64, length: f64) {
        self.finish();
        self.period = Some(Period::new(start, length));
    }

    /// When the period that is looked at ends, s.
    pub fn end_of_period(&self) -> Option<f64> {
        self.period.as_ref().map(Period::end)
    }

    /// At the end of the period: takes in all that is left of the record, as its repetition. False where the motion itself
    /// is asked for, which goes on.
    pub fn end_period(&mut self) -> bool {
        let Some(period) = self.period.take() else {
            return false;
        };
        let Instants { count, .. } = self.instants;
        let mut passed = 0.0;
        while self.seen < count {
            for ([start, length], polynomials) in period.parts(self.sensors.len()) {
                let start = start + passed;
                let within = self.instants.within(self.seen, start + length);
                self.evaluate([start, length], within, polynomials);
            }
            passed += period.length;
        }
        self.traced.is_none()
    }

    /// Takes in the next so many instants by polynomials over a time that begins at `start` and takes `length`, s.
    fn evaluate(&mut self, [start, length]: [f64; 2], within: usize, polynomials: &[Polynomial]) {
        if within == 0 {
            return;
        }
        let instants = self.instants;
        let shares = (self.seen..self.seen + within).map(|i| (instants.at(i) - start) / length);
        (self.series).evaluate(self.sensors, polynomials, shares);
        self.seen += within;
    }

    /// Takes in the instants within a step by what `seen` gives for each sensor at each node. False, and nothing taken in,
    /// where that is not exact enough.
    fn interpolate(
        &mut self,
        step: [f64; 2],
        within: usize,
        seen: impl Fn(usize, usize) -> f64,
    ) -> bool {
        let fitted = self.series.fit(self.sensors.len(), seen, false);
        if fitted {
            let polynomials = std::mem::take(&mut self.series.polynomials);
            self.evaluate(step, within, &polynomials);
            self.series.polynomials = polynomials;
        }
        fitted
    }

    /// Takes a part of a step into the period by what `seen` gives for each sensor at each node. Where that is not exact
    /// enough, nothing is taken in but its halves are waiting.
    fn keep(
        &mut self,
        step: [f64; 2],
        part: Part,
        seen: impl Fn(usize, usize) -> f64,
        waiting: &mut Vec<Part>,
    ) {
        let halves = part.halves();
        if self.series.fit(self.sensors.len(), seen, halves.is_none()) {
            if let Some(period) = &mut self.period {
                period.extend(part.of(step), self.series.polynomials.iter().copied());
            }
        } else if let Some([first, second]) = halves {
            waiting.extend([second, first]);
        }
    }

    /// Looks at a step.
    pub fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        self.joints.update(|i| step.to[i]);
        self.observe_motion(dynamics, step);
        if self.period.is_some() {
            return self.observe_period(dynamics, step);
        }
        let within = self.instants.within(self.seen, step.start + step.length);
        if within == 0 {
            return;
        }
        step.extend(dynamics);
        self.face(dynamics);
        if NODES < within {
            let here = [step.start, step.length];
            let seen = self.see(step, &self.series.nodes.times(here));
            if self.interpolate(here, within, |i, node| seen[i][node]) {
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

    /// Looks at the motion itself at the instants within a step.
    fn observe_motion(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        let Some(traced) = &mut self.traced else {
            return;
        };
        let within = self.instants.within(traced.seen, step.start + step.length);
        if within == 0 {
            return;
        }
        step.extend(dynamics);
        for instant in traced.seen..traced.seen + within {
            let t = self.instants.at(instant);
            step.interpolate((t - step.start) / step.length, &mut self.state);
            traced.push(dynamics.evaluate(t, &self.state));
        }
    }

    /// Looks at a step of the period.
    fn observe_period(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        step.extend(dynamics);
        self.face(dynamics);
        let here = [step.start, step.length];
        let mut waiting = vec![Part::WHOLE];
        while let Some(part) = waiting.pop() {
            let seen = self.see(step, &self.series.nodes.times(part.of(here)));
            self.keep(here, part, |i, node| seen[i][node], &mut waiting);
        }
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
            self.sample(last);
        }
        if let Some(traced) = &mut self.traced {
            while traced.seen < self.instants.count {
                traced.push(last);
            }
        }
        let taken = self.series.taken.into_iter();
        Seen {
            series: taken.map(|taken| taken.end(start)).collect(),
            trace: self.traced.map(|traced| traced.trace),
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
    let (mut within, mut repeats) = ([0; W], [false; W]);
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let Some(sampler) = sampler
            && stands[lane]
        {
            sampler.joints.update(|i| step.to[i].get(lane));
            repeats[lane] = sampler.period.is_some();
            if !repeats[lane] {
                within[lane] = sampler.instants.within(sampler.seen, stop.get(lane));
            }
        }
    }
    if within == [0; W] && repeats == [false; W] {
        return;
    }
    step.extend(machines);
    let by_nodes = |lane: usize| repeats[lane] || NODES < within[lane];
    let counts = std::array::from_fn(|lane| match by_nodes(lane) {
        true => NODES,
        false => within[lane],
    });
    let times = |sampler: &Sampler, lane: usize, i: usize| match by_nodes(lane) {
        true => {
            let here = [step.start.get(lane), step.length.get(lane)];
            sampler.series.nodes.time(here, i)
        }
        false => sampler.instants.at(sampler.seen + i),
    };
    let seen = see_lanes(samplers, machines, step, counts, times);
    let mut left = [0; W];
    let mut waiting = [const { Vec::new() }; W];
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        let Some(sampler) = sampler else { continue };
        let here = [step.start.get(lane), step.length.get(lane)];
        let sensors = sampler.sensors.len();
        let of_lane = |i: usize, node: usize| seen[node * sensors + i].get(lane);
        if repeats[lane] {
            sampler.keep(here, Part::WHOLE, of_lane, &mut waiting[lane]);
        } else if !by_nodes(lane) {
            sampler.take(lane, within[lane], &seen);
        } else if !sampler.interpolate(here, within[lane], of_lane) {
            left[lane] = within[lane];
        }
    }
    if left != [0; W] {
        let times = |sampler: &Sampler, _: usize, i: usize| sampler.instants.at(sampler.seen + i);
        let seen = see_lanes(samplers, machines, step, left, times);
        for (lane, sampler) in samplers.iter_mut().enumerate() {
            if let Some(sampler) = sampler {
                sampler.take(lane, left[lane], &seen);
            }
        }
    }
    while waiting.iter().any(|parts| !parts.is_empty()) {
        observe_parts(samplers, machines, step, &mut waiting);
    }
}

/// Looks at one of the waiting parts of the step in each lane.
fn observe_parts<L: Lanes<W>, const W: usize>(
    samplers: &mut [Option<&mut Sampler>; W],
    machines: &mut SideBySide<L>,
    step: &Step<L>,
    waiting: &mut [Vec<Part>; W],
) {
    let parts = waiting.each_mut().map(Vec::pop);
    let here = |lane: usize| [step.start.get(lane), step.length.get(lane)];
    let times = |sampler: &Sampler, lane: usize, i: usize| {
        let part = parts[lane].unwrap_or(Part::WHOLE);
        sampler.series.nodes.time(part.of(here(lane)), i)
    };
    let counts = parts.map(|part| part.map_or(0, |_| NODES));
    let seen = see_lanes(samplers, machines, step, counts, times);
    for (lane, sampler) in samplers.iter_mut().enumerate() {
        if let (Some(sampler), Some(part)) = (sampler, parts[lane]) {
            let sensors = sampler.sensors.len();
            let of_lane = |i: usize, node: usize| seen[node * sensors + i].get(lane);
            sampler.keep(here(lane), part, of_lane, &mut waiting[lane]);
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
