//! What sensors see of a run: its motion at equally spaced instants.
//!
//! A recorded sample takes four to eight instants. Where many of them lie within a step, the motion is evaluated at a few
//! others, and a polynomial through these values gives what the sensors see. Those within a step of one run are evaluated
//! side by side, also where several runs are in lanes, as some of these record while others do not. Of a motion that repeats
//! itself one period is kept as such polynomials, and all that is left of the record is its repetition, with what is left of
//! the frame's free vibration.

use crate::chain::UnderWay;
use crate::free_vibration::{FramePeriod, Instantly};
use crate::instants::Instants;
use crate::lookout::{self, Lookout};
use crate::penetration::{Penetration, Watch};
use crate::period::{Part, Period};
use crate::polynomial::{NODES, Nodes, Polynomial};
use crate::run::Run;
use crate::sensor::Sensor;
use crate::trace::Trace;
use integrate::Step;
use mechanism::frame::FrameMotion;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Evaluation};
use std::ops::Range;

/// Series under way.
pub(crate) struct Sampler<'a> {
    sensors: &'a [Sensor],
    instants: Instants,
    seen: usize,
    series: Series,
    /// The period of which the rest of the record is the repetition, while it is looked at.
    period: Option<Period>,
    /// The works over it, J, where these are integrals of powers.
    works: Option<[f64; 4]>,
    /// The motion itself, where it is asked for.
    traced: Option<Traced>,
    /// How deep joints are pressed in.
    joints: Watch,
    /// From where it looks at the machine, and the mode that this is in.
    lookout: Box<dyn Lookout>,
    mode: Mode,
    /// Scratch: what each sensor sees at the nodes, and instants within a step.
    at_nodes: Vec<Vec<f64>>,
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
    /// Scratch: shares of a step, values there, and what the frame's free vibration is there.
    shares: Vec<f64>,
    values: Vec<f64>,
    frame: Vec<FrameMotion>,
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
            frame: Vec::new(),
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

    /// The polynomials through what each sensor has `seen` at the nodes. False where one of them leaves out too much, unless
    /// it `must` do.
    fn fit(&mut self, seen: &[Vec<f64>], must: bool) -> bool {
        self.polynomials.clear();
        for (seen, largest) in seen.iter().zip(&self.largest) {
            let Some(values) = seen.first_chunk() else {
                return false;
            };
            let near = self.nodes.near(values, *largest, self.tolerance);
            match near.or_else(|| must.then(|| self.nodes.through(values))) {
                Some(polynomial) => self.polynomials.push(polynomial),
                None => return false,
            }
        }
        true
    }

    /// Takes in what the polynomials of the sensors say at these shares of what they were fitted to, and what the frame's free
    /// vibration adds.
    fn evaluate(
        &mut self,
        sensors: &[Sensor],
        polynomials: &[Polynomial],
        shares: impl Iterator<Item = f64>,
        frame: Option<&mut Instantly>,
    ) {
        self.shares.clear();
        self.shares.extend(shares);
        self.frame.clear();
        let mut seen: &[FrameMotion] = &[];
        if let Some(frame) = frame {
            self.frame.extend(self.shares.iter().map(|_| frame.next()));
            seen = frame.seen();
        }
        let mut values = std::mem::take(&mut self.values);
        for (i, (sensor, polynomial)) in sensors.iter().zip(polynomials).enumerate() {
            polynomial.evaluate(&self.shares, &mut values);
            if let Some([a, b, c, d]) = seen.get(i) {
                for (value, [x, y, u, v]) in values.iter_mut().zip(&self.frame) {
                    *value += (a * x + b * y) + (c * u + d * v);
                }
            }
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
        let dynamics = run.dynamics();
        let (machine, mode) = (dynamics.machine(), dynamics.mode());
        let ledger = dynamics.layout().ledger.is_some();
        let mut sampler = Self {
            joints: Watch::new(run.dynamics()),
            lookout: lookout::at(machine, ledger),
            mode: mode.clone(),
            at_nodes: vec![Vec::new(); sensors.len()],
            times: Vec::new(),
            state: vec![0.0; dimension],
            series: Series::new(taken, run.tolerance()),
            period: None,
            works: None,
            traced: trace.map(|(trace, range)| Traced {
                trace,
                range,
                seen: 0,
            }),
            sensors,
            instants,
            seen: 0,
        };
        sampler.lookout.set_mode(&sampler.mode);
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

    /// The motion repeats itself from where the run stands, whenever `length` (s) has passed: looks at one period.
    pub fn repeat(&mut self, run: &mut Run<f64>, length: f64) {
        self.finish();
        let frame = FramePeriod::begin(run, self.sensors);
        self.period = Some(Period::new(run.time(), length, frame));
        self.works = (!run.dynamics().has_two_mode_joint()).then_some([0.0; 4]);
    }

    /// The works over the period that was looked at, J, as the ledger of the energy has them.
    pub fn works(&self) -> Option<[f64; 4]> {
        self.works
    }

    /// When the period that is looked at ends, s.
    pub fn end_of_period(&self) -> Option<f64> {
        self.period.as_ref().map(Period::end)
    }

    /// At the end of the period: takes in all that is left of the record, as its repetition. False where the motion itself
    /// is asked for, which goes on.
    pub fn end_period(&mut self, run: &Run<f64>) -> bool {
        let Some(mut period) = self.period.take() else {
            return false;
        };
        let Instants { rate, count, .. } = self.instants;
        let frame = period.frame.take();
        let mut frame = frame.and_then(|frame| frame.end(run, period.length));
        let mut passed = 0.0;
        while self.seen < count {
            let since = self.instants.at(self.seen) - (period.start + passed);
            let departure = frame.as_ref();
            let mut departure = departure.map(|frame| frame.instantly(since, 1.0 / rate));
            for ([start, length], polynomials) in period.parts(self.sensors.len()) {
                let start = start + passed;
                let within = self.instants.within(self.seen, start + length);
                self.evaluate([start, length], within, polynomials, departure.as_mut());
            }
            passed += period.length;
            if let Some(frame) = &mut frame {
                frame.pass();
            }
        }
        self.traced.is_none()
    }

    /// Takes in the next so many instants by polynomials over a time that begins at `start` and takes `length`, s.
    fn evaluate(
        &mut self,
        [start, length]: [f64; 2],
        within: usize,
        polynomials: &[Polynomial],
        frame: Option<&mut Instantly>,
    ) {
        if within == 0 {
            return;
        }
        let instants = self.instants;
        let shares = (self.seen..self.seen + within).map(|i| (instants.at(i) - start) / length);
        (self.series).evaluate(self.sensors, polynomials, shares, frame);
        self.seen += within;
    }

    /// Looks at a step of a run that is in no lane.
    pub fn observe(&mut self, dynamics: &mut Dynamics<f64>, step: &mut Step<f64>) {
        self.observe_motion(dynamics, step);
        if self.pass(step.start + step.length, |i| step.to[i]) {
            step.extend(dynamics);
            self.face(dynamics.mode());
            self.sample_step(step);
        }
    }

    /// Takes in where a step leads: until `stop`, s, to a state of which `y` gives the components. Whether the step has to be
    /// looked at.
    pub fn pass(&mut self, stop: f64, y: impl Fn(usize) -> f64) -> bool {
        self.joints.update(y);
        let Instants { count, .. } = self.instants;
        self.period.is_some() || self.seen < count && self.instants.at(self.seen) <= stop
    }

    /// Looks at a step, whose continuous extension is there, in the mode that is faced.
    pub fn sample_step(&mut self, step: &Step<f64>) {
        let here = [step.start, step.length];
        if self.period.is_some() {
            return self.sample_parts(step);
        }
        let within = self.instants.within(self.seen, step.start + step.length);
        if NODES < within && self.fit(step, here, false) {
            let polynomials = std::mem::take(&mut self.series.polynomials);
            self.evaluate(here, within, &polynomials, None);
            self.series.polynomials = polynomials;
            return;
        }
        let mut times = std::mem::take(&mut self.times);
        times.clear();
        times.extend((self.seen..self.seen + within).map(|i| self.instants.at(i)));
        let (sensors, series) = (self.sensors, &mut self.series);
        let mut show = |i: usize, seen: &[f64]| series.extend(i, &sensors[i], seen.iter().copied());
        self.lookout.observe(step, &times, sensors, &mut show);
        self.times = times;
        self.seen += within;
    }

    /// Looks at a step of the period: where a polynomial leaves out too much, at its halves.
    fn sample_parts(&mut self, step: &Step<f64>) {
        let mut waiting = vec![Part::WHOLE];
        while let Some(part) = waiting.pop() {
            let span = part.span([step.start, step.length]);
            let halves = part.halves();
            if self.fit(step, span, halves.is_none()) {
                self.add_works(step, span);
                if let Some(period) = &mut self.period {
                    period.extend(span, self.series.polynomials.iter().copied());
                }
            } else if let Some([first, second]) = halves {
                waiting.extend([second, first]);
            }
        }
    }

    /// Adds the works over a span of a step: its beginning and length, s.
    fn add_works(&mut self, step: &Step<f64>, span: [f64; 2]) {
        let Some(works) = &mut self.works else {
            return;
        };
        let nodes = &self.series.nodes;
        let mut powers = [const { Vec::new() }; 4];
        let mut show = |i: usize, now: &[f64]| powers[i].extend_from_slice(now);
        self.lookout.powers(step, &nodes.times(span), &mut show);
        for (work, powers) in works.iter_mut().zip(&powers) {
            if let Some(powers) = powers.first_chunk() {
                *work += nodes.integral(powers, span[1]);
            }
        }
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

    /// Looks at the machine in this mode from now on.
    pub fn face(&mut self, mode: &Mode) {
        if self.mode != *mode {
            self.finish();
            self.mode.clone_from(mode);
            self.lookout.set_mode(mode);
        }
    }

    /// The polynomials of all sensors over a span of a step: its beginning and length, s. False where one of them leaves out
    /// too much, unless it `must` do. No instant waits after it.
    fn fit(&mut self, step: &Step<f64>, span: [f64; 2], must: bool) -> bool {
        self.finish();
        let seen = &mut self.at_nodes;
        seen.iter_mut().for_each(Vec::clear);
        let times = self.series.nodes.times(span);
        let mut show = |i: usize, now: &[f64]| seen[i].extend_from_slice(now);
        self.lookout.observe(step, &times, self.sensors, &mut show);
        self.lookout.finish(self.sensors, &mut show);
        self.series.fit(&self.at_nodes, must)
    }

    /// Looks at the instants that wait.
    fn finish(&mut self) {
        let (sensors, series) = (self.sensors, &mut self.series);
        let mut show = |i: usize, seen: &[f64]| series.extend(i, &sensors[i], seen.iter().copied());
        self.lookout.finish(sensors, &mut show);
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
