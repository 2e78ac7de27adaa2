//! From machine to record: transient, sampling, energy ledger.

use crate::sensor::{Axis, ChamberEnd, Measured, Sensor};
use crate::settings::{Settings, Transient};
use crate::trace::Trace;
use integrate::{Integrator, Step, System};
use mechanism::{Dynamics, Evaluation, Machine};
use signal::biquad::Filter;
use signal::decimate::Decimator;
use std::f64::consts::TAU;

/// Lowest rate at which the motion is sampled before decimation, Hz: contacts ring at a few kHz,
/// and what lies above half of this rate is weak enough to fold down unnoticed.
const INNER_RATE: f64 = 80_000.0;
/// Fewest inner samples per recorded one.
const LEAST_FACTOR: f64 = 4.0;
/// Most inner samples per recorded one: a slow recording still sees the contacts.
const MOST_FACTOR: f64 = 4096.0;
/// Longest step, as a share of a revolution: no event is further from a look than a twentieth.
const LONGEST_STEP: f64 = 0.05;
/// Periods, in revolutions, that count as settled.
const PERIODS: [usize; 3] = [1, 2, 4];

/// Why a run failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The integration stopped.
    #[error("{0}")]
    Integration(#[from] integrate::Error),
    /// A filter of the measuring chain cannot be built.
    #[error("sensor {column}: {source}")]
    Sensor {
        /// The channel.
        column: String,
        /// What is wrong with it.
        source: signal::Error,
    },
    /// A free crank stands still, or swings.
    #[error(
        "the crank does not come round any more: none of its revolutions ended before t = {time} s"
    )]
    Stalled {
        /// Time reached, s.
        time: f64,
    },
    /// The motion left the range in which the model means anything.
    #[error("the motion is no longer finite at t = {time} s")]
    NotFinite {
        /// Time reached, s.
        time: f64,
    },
}

/// What the sensors of a run see before noise, and how the run went.
#[derive(Clone, Debug)]
pub struct Record {
    /// Samples per second.
    pub sample_rate: f64,
    /// Time of the first sample since the start of the machine, s.
    pub start: f64,
    /// One series of samples per sensor, in the order of the sensors and in SI.
    pub series: Vec<Vec<f64>>,
    /// Poses, rates and forces, where they were asked for.
    pub trace: Option<Trace>,
    /// Revolutions that were thrown away.
    pub transient: u32,
    /// True where the transient was found to have settled.
    pub settled: bool,
    /// Energy that the ledger misses over the recorded revolutions, as a share of the energy turned
    /// over: the run's own measure of its accuracy.
    pub energy_residual: f64,
    /// Steps, rejected steps and located switches of the integration.
    pub work: integrate::Work,
}

/// Runs `machine` and records `sensors`; with `traced` also the motion itself.
///
/// # Errors
/// Where the integration cannot meet its tolerance, or a sensor's filter does not fit the rate.
pub fn simulate(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    traced: bool,
) -> Result<Record, Error> {
    let mut run = Run::start(machine, settings);
    let (transient, settled) = run.leave_transient(settings.transient)?;
    let start = f64::from(transient) * run.revolution;
    let factor = (INNER_RATE / settings.sample_rate)
        .clamp(LEAST_FACTOR, MOST_FACTOR)
        .ceil();
    let inner_rate = settings.sample_rate * factor;
    let length = run.revolution * f64::from(settings.revolutions);
    // A sample that falls on the end of the last revolution belongs to the next.
    let samples = (length * settings.sample_rate - 1e-9).ceil().max(1.0) as usize;
    let factor = factor as usize;
    let trace = traced.then(|| Trace::new(machine, factor));
    let mut recorder = Recorder::new(machine, sensors, inner_rate, factor, samples, trace)?;
    let before = run.ledger();
    run.sample(start, inner_rate, &mut recorder)?;
    let energy_residual = run.residual(&before);
    Ok(Record {
        sample_rate: settings.sample_rate,
        start,
        trace: recorder.trace.take(),
        series: recorder.decimated(),
        transient,
        settled,
        energy_residual,
        work: run.integrator.work(),
    })
}

/// A machine on its way.
struct Run {
    dynamics: Dynamics<f64>,
    integrator: Integrator<f64>,
    revolution: f64,
    state: Vec<f64>,
}

/// Energy and works at an instant, J.
struct Ledger {
    energy: f64,
    works: [f64; 4],
}

impl Run {
    fn start(machine: &Machine, settings: &Settings) -> Self {
        let revolution = TAU / machine.drive.reference_speed();
        let mut dynamics = Dynamics::new(machine.clone(), true);
        let state = dynamics.initial_state();
        let longest = LONGEST_STEP * revolution;
        let integrator = Integrator::new(&mut dynamics, 0.0, &state, settings.tolerance, longest);
        Self {
            dynamics,
            integrator,
            revolution,
            state,
        }
    }

    /// Leaves the start behind, but for the last revolution, which leads into the record. Tells how
    /// many revolutions the transient takes, and whether the motion had settled.
    fn leave_transient(&mut self, transient: Transient) -> Result<(u32, bool), Error> {
        let (change, at_most) = match transient {
            Transient::Revolutions(count) => (0.0, count),
            Transient::Settled { change, at_most } => (change, at_most),
        };
        let mut strobes = vec![self.integrator.state().to_vec()];
        for revolution in 1..at_most {
            self.advance(f64::from(revolution) * self.revolution)?;
            let now = self.integrator.state().to_vec();
            let repeats = |period: &usize| {
                let earlier = strobes.len().checked_sub(*period);
                earlier.is_some_and(|i| self.distance(&now, &strobes[i]) < change)
            };
            // Not before the start has had a revolution to pass.
            if revolution > 1 && PERIODS.iter().any(repeats) {
                return Ok((revolution + 1, true));
            }
            strobes.push(now);
            let keep = strobes.len().saturating_sub(PERIODS[PERIODS.len() - 1]);
            strobes.drain(..keep);
        }
        Ok((at_most, false))
    }

    /// Largest difference of two states, each component over its scale.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let scales = self.dynamics.scales();
        let parts = a.iter().zip(b).zip(scales);
        parts
            .map(|((a, b), scale)| ((a - b) / scale).abs())
            .fold(0.0, f64::max)
    }

    fn advance(&mut self, end: f64) -> Result<(), Error> {
        self.integrator
            .advance(&mut self.dynamics, end, |_, _| ())?;
        if self.integrator.state().iter().all(|y| y.is_finite()) {
            return Ok(());
        }
        Err(Error::NotFinite { time: end })
    }

    /// Shows the recorder all the instants it needs, at `rate` from a little before `start` to a
    /// little after the last recorded sample.
    fn sample(&mut self, start: f64, rate: f64, recorder: &mut Recorder<'_>) -> Result<(), Error> {
        let total = recorder.decimator.input_length(recorder.samples);
        let lead = recorder.decimator.half_length();
        let time = |i: usize| start + (i as f64 - lead as f64) / rate;
        // Where the machine had not started yet, the first value holds.
        let now = self.integrator.time();
        let first = self.dynamics.evaluate(now, self.integrator.state());
        while recorder.seen < total && time(recorder.seen) <= now {
            recorder.push(first);
        }
        let end = time(total.saturating_sub(1));
        let state = &mut self.state;
        let observe = |dynamics: &mut Dynamics<f64>, step: &Step<f64>| {
            let stop = step.start + step.length;
            while recorder.seen < total && time(recorder.seen) <= stop {
                let t = time(recorder.seen);
                step.interpolate((t - step.start) / step.length, state);
                recorder.push(dynamics.evaluate(t, state));
            }
        };
        self.integrator.advance(&mut self.dynamics, end, observe)?;
        // Rounding may leave the very last instant beyond the last step.
        let last = self.dynamics.evaluate(end, self.integrator.state());
        while recorder.seen < total {
            recorder.push(last);
        }
        if self.integrator.state().iter().all(|y| y.is_finite()) {
            return Ok(());
        }
        Err(Error::NotFinite { time: end })
    }

    fn ledger(&mut self) -> Ledger {
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
    fn residual(&mut self, before: &Ledger) -> f64 {
        let now = self.ledger();
        let [gas, drive, friction, damping] =
            std::array::from_fn(|i| now.works[i] - before.works[i]);
        let missing = now.energy - before.energy - (gas + drive - friction - damping);
        let turned = gas.abs() + drive.abs() + friction.abs() + damping.abs();
        if turned > 0.0 { missing / turned } else { 0.0 }
    }
}

/// The measuring chains: filters at the inner rate, then decimation; and the trace beside them.
struct Recorder<'a> {
    sensors: &'a [Sensor],
    filters: Vec<Vec<Filter>>,
    inner: Vec<Vec<f64>>,
    decimator: Decimator,
    factor: usize,
    samples: usize,
    trace: Option<Trace>,
    /// Instants shown so far.
    seen: usize,
}

impl<'a> Recorder<'a> {
    fn new(
        machine: &Machine,
        sensors: &'a [Sensor],
        rate: f64,
        factor: usize,
        samples: usize,
        trace: Option<Trace>,
    ) -> Result<Self, Error> {
        let names: Vec<&str> = machine.throws.iter().map(|t| t.name.as_str()).collect();
        let filters = sensors
            .iter()
            .map(|sensor| {
                filters(sensor, rate).map_err(|source| Error::Sensor {
                    column: sensor.measured.column(&names),
                    source,
                })
            })
            .collect::<Result<_, _>>()?;
        let decimator = Decimator::new(factor).map_err(|source| Error::Sensor {
            column: "all".into(),
            source,
        })?;
        Ok(Self {
            sensors,
            filters,
            inner: vec![Vec::new(); sensors.len()],
            decimator,
            factor,
            samples,
            trace,
            seen: 0,
        })
    }

    fn push(&mut self, at: &Evaluation<f64>) {
        let chains = self.filters.iter_mut().zip(&mut self.inner);
        for (sensor, (filters, inner)) in self.sensors.iter().zip(chains) {
            let value = sensor.measured.value(at) * sensor.chain.gain;
            if self.seen == 0 {
                for filter in filters.iter_mut() {
                    filter.settle(value);
                }
            }
            inner.push(filters.iter_mut().fold(value, |x, filter| filter.run(x)));
        }
        let lead = self.decimator.half_length();
        let recorded = lead..lead + self.samples * self.factor;
        if let Some(trace) = &mut self.trace
            && recorded.contains(&self.seen)
        {
            trace.push(at);
        }
        self.seen += 1;
    }

    fn decimated(self) -> Vec<Vec<f64>> {
        let lead = self.decimator.half_length();
        let sensors = self.sensors.iter();
        sensors
            .zip(self.inner)
            .map(|(sensor, inner)| match sensor.measured {
                // An angle has a jump a revolution, which no filter must touch.
                Measured::CrankAngle => inner[lead..]
                    .iter()
                    .step_by(self.factor)
                    .take(self.samples)
                    .copied()
                    .collect(),
                _ => self.decimator.apply(&inner),
            })
            .collect()
    }
}

fn filters(sensor: &Sensor, rate: f64) -> Result<Vec<Filter>, signal::Error> {
    let chain = &sensor.chain;
    let mut filters = Vec::new();
    if let Some(mounting) = chain.mounting {
        filters.push(Filter::resonance(
            mounting.frequency,
            mounting.damping_ratio,
            rate,
        )?);
    }
    if let Some(low_pass) = chain.low_pass {
        filters.push(Filter::butterworth_low_pass(
            low_pass.order,
            low_pass.cutoff,
            rate,
        )?);
    }
    Ok(filters)
}

impl Measured {
    /// The quantity at an instant, SI.
    pub fn value(&self, at: &Evaluation<f64>) -> f64 {
        match *self {
            Measured::CrossheadAcceleration { throw } => at.throws[throw].accelerations.crosshead,
            Measured::CrossheadLateralAcceleration { throw } => {
                at.throws[throw].accelerations.guide.x
            }
            Measured::FrameAcceleration { axis: Axis::X } => at.frame.x,
            Measured::FrameAcceleration { axis: Axis::Y } => at.frame.y,
            Measured::CylinderPressure { throw, end } => {
                let gas = &at.throws[throw].gas;
                match end {
                    ChamberEnd::Head => gas.head_end.pressure,
                    ChamberEnd::Crank => gas.crank_end.pressure,
                }
            }
            Measured::CrankAngle => at.angle.rem_euclid(TAU),
        }
    }
}
