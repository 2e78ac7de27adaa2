//! A record under way, as a sequence of courses; the caller integrates to the end of each.

use crate::asked::Asked;
use crate::chain::{Sampling, check_settling};
use crate::error::Error;
use crate::leaving::{Leaving, Left};
use crate::record::Record;
use crate::recorder::Recorder;
use crate::repetition::Repetition;
use crate::run::{Ledger, Run};
use crate::sampler::{Sampler, Seen, Taken};
use crate::settings::{Settings, Transient};
use crate::span::Span;
use crate::trace::Trace;
use integrate::{Course, Trial};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// What is kept of a run beside its series, and with it over what its energy is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// The series alone, unchecked: for a fit, which runs many machines and keeps none.
    Series,
    /// The series alone. The energy is checked over the period that is repeated, or over one revolution after the record, so that
    /// the record itself need not carry the works along.
    CheckedSeries,
    /// The motion as well. The energy is checked over the record.
    Trace,
    /// The series alone, unchecked, of which a settled motion is integrated over one period. What takes too long is given
    /// up.
    Period,
}

/// A record under way.
pub(crate) struct Task<'a> {
    order: Order<'a>,
    pub run: Run<f64>,
    phase: Phase<'a>,
    course: Course,
}

/// What a task is to do.
#[derive(Clone, Copy)]
struct Order<'a> {
    asked: Asked<'a>,
    /// s after the transient.
    delay: f64,
    kept: Kept,
}

enum Phase<'a> {
    Leaving(Leaving),
    Recording(Box<Recording<'a>>),
}

struct Recording<'a> {
    left: Left,
    /// How near the motion comes to repeating itself, while that is looked at.
    repetition: Option<Repetition>,
    /// The revolution that is under way.
    revolution: u32,
    /// When it begins, s.
    start: f64,
    sampler: Sampler<'a>,
    /// Where the sampler keeps inner samples: what they are of the record.
    span: Option<Span>,
    before: Option<Ledger>,
    /// Where the energy stood when the period began that is repeated.
    at_period: Option<Ledger>,
    /// Angle of the crank, rad, and time, s, where it set out.
    from: [f64; 2],
}

impl<'a> Task<'a> {
    /// Begins at the start of the machine.
    pub fn start(asked: Asked<'a>, delay: f64, kept: Kept) -> Result<Self, Error> {
        let transient = asked.settings.transient;
        (asked.settings).check(asked.machine.drive.reference_speed())?;
        let mut run = Run::begin(&asked, asked.machine.clone(), kept == Kept::Trace);
        if kept == Kept::Period {
            run.hurry();
        }
        check_settling(asked.sensors, run.revolution())?;
        let leaving = Leaving::new(&mut run, transient);
        let order = Order { asked, delay, kept };
        let (phase, end) = order.next_phase(&mut run, leaving, None)?;
        Ok(Self {
            course: run.course(end),
            order,
            phase,
            run,
        })
    }

    /// The step to try next; none at the end of the course.
    pub fn propose(&self) -> Result<Option<Trial>, integrate::Error> {
        self.run.integrator().propose(&self.course)
    }

    /// What looks at the steps of the present course, if anything does.
    pub fn parts(&mut self) -> (&mut Run<f64>, &Course, Option<&mut Sampler<'a>>) {
        let sampler = match &mut self.phase {
            Phase::Leaving(_) => None,
            Phase::Recording(recording) => Some(&mut recording.sampler),
        };
        (&mut self.run, &self.course, sampler)
    }

    /// At the end of a course: sets out for the next one, or gives the record.
    pub fn arrive(mut self) -> Result<Result<Record, Self>, Error> {
        self.run.check(self.course.end())?;
        match self.phase {
            Phase::Leaving(mut leaving) => {
                let left = leaving.arrive(&mut self.run);
                let (phase, end) = self.order.next_phase(&mut self.run, leaving, left)?;
                self.course = self.run.course(end);
                self.phase = phase;
                Ok(Err(self))
            }
            Phase::Recording(mut recording) => {
                if let Some(end) = recording.arrive(&mut self.run) {
                    self.course = self.run.course(end);
                    self.phase = Phase::Recording(recording);
                    return Ok(Err(self));
                }
                let Recording {
                    left,
                    start,
                    sampler,
                    span,
                    before,
                    at_period,
                    from,
                    ..
                } = *recording;
                let run = &mut self.run;
                // A fit may try a machine whose crank does not keep its speed.
                let mean_speed = match self.order.kept {
                    Kept::Period => TAU / run.revolution(),
                    _ => run.mean_speed(from)?,
                };
                let residual = match before {
                    Some(before) => Some(run.balance(&before)?),
                    None if self.order.kept == Kept::CheckedSeries => {
                        let period = at_period.as_ref().zip(sampler.works());
                        let of_period = period.map(|(before, works)| run.balance_of(works, before));
                        // What does not balance by these integrals is integrated along.
                        match of_period.and_then(Result::ok) {
                            Some(residual) => Some(residual),
                            None => Some(run.audit(self.order.asked.settings.tolerance)?),
                        }
                    }
                    None => None,
                };
                let Seen {
                    series,
                    trace,
                    penetrations,
                } = sampler.end_with(run, start);
                let series = match span {
                    None => series,
                    Some(span) => {
                        let whole: Vec<_> = series.into_iter().map(|x| span.whole(x)).collect();
                        let Span {
                            sampling, start, ..
                        } = span;
                        let Asked {
                            machine, sensors, ..
                        } = self.order.asked;
                        Recorder { sampling, start }.record(machine, sensors, &whole)?
                    }
                };
                Ok(Ok(Record {
                    sample_rate: self.order.asked.settings.sample_rate,
                    start,
                    trace,
                    series,
                    transient: left.transient,
                    settled: left.period.is_some(),
                    energy_residual: residual,
                    mean_speed,
                    penetrations,
                    work: run.work(),
                }))
            }
        }
    }

    /// Goes to the end by itself; after each step `watch` receives the share of the way that is done, and may
    /// end it there.
    pub fn finish(
        mut self,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Record, Error> {
        let whole = self.order.planned_end(self.run.revolution());
        loop {
            let (run, course, mut sampler) = self.parts();
            run.watch(course.end(), |dynamics, step| {
                if let Some(sampler) = &mut sampler {
                    sampler.observe(dynamics, step);
                }
                if watch((step.start / whole).min(1.0)).is_break() {
                    step.stop();
                }
            })?;
            match self.arrive()? {
                Ok(record) => return Ok(record),
                Err(task) => self = task,
            }
        }
    }
}

impl<'a> Order<'a> {
    /// Whether it is of use that a motion repeats itself. A fit has a way of its own, and a crank that is free does not come
    /// round at equal times.
    fn takes_repetitions(&self, run: &Run<f64>) -> bool {
        self.kept != Kept::Period && !run.is_free() && !self.asked.sensors.is_empty()
    }

    /// Whether all that comes repeats itself, before the start has taken the revolutions that are asked for.
    fn repeats(&self, run: &Run<f64>, repetition: &Repetition) -> bool {
        let revolution = run.revolution();
        let left = (self.planned_end(revolution) - run.time()) / revolution;
        matches!(self.asked.settings.transient, Transient::Revolutions(_))
            && self.takes_repetitions(run)
            && repetition.exact_period(run.tolerance(), left).is_some()
    }

    /// Where the run is to go: to the end of the revolution under way or, the start being left behind, for the record.
    fn next_phase(
        &self,
        run: &mut Run<f64>,
        leaving: Leaving,
        left: Option<Left>,
    ) -> Result<(Phase<'a>, f64), Error> {
        let (left, instead) = match left.map_or_else(|| leaving.next(run), Err) {
            Err(left) => (left, None),
            // What comes between is not waited for where all that comes repeats itself.
            Ok(end) if self.repeats(run, &leaving.repetition) => (leaving.at_most(), Some(end)),
            Ok(end) => return Ok((Phase::Leaving(leaving), end)),
        };
        let mut recording = self.recording(run, left)?;
        recording.revolution = leaving.revolution;
        if let Some(end) = instead
            && !recording.sampler.is_ahead()
        {
            return Ok((Phase::Leaving(leaving), end));
        }
        if self.takes_repetitions(run) {
            recording.repetition = Some(leaving.repetition);
            recording.look_for_period(run);
        }
        let end = recording.end(run);
        Ok((Phase::Recording(Box::new(recording)), end))
    }

    fn recording(&self, run: &mut Run<f64>, left: Left) -> Result<Recording<'a>, Error> {
        let Asked {
            machine,
            sensors,
            settings,
            ..
        } = self.asked;
        if self.kept == Kept::Period {
            return self.period(run, left);
        }
        let length = f64::from(settings.revolutions) * run.revolution();
        let sampling = Sampling::new(sensors, settings, length)?;
        let lead = sampling.lead();
        // Structures swing themselves in for whole revolutions.
        let more = (sampling.settling() / run.revolution()).ceil();
        let mut left = left;
        left.transient += more as u32;
        let planned = f64::from(left.transient) * run.revolution() + self.delay;
        // A free crank that is slow may have taken longer for its transient.
        let start = match run.is_free() {
            true => planned.max(run.time() + lead as f64 / sampling.inner_rate),
            false => planned,
        };
        let within = lead..lead + sampling.samples * sampling.factor;
        let traced = self.kept == Kept::Trace;
        let trace = traced.then(|| (Trace::new(machine, sampling.factor), within));
        let recorded = sensors.iter().map(|sensor| {
            let under_way = sampling.begin(sensor, machine)?;
            Ok(Taken::Recorded(Box::new(under_way)))
        });
        Ok(Recording {
            left,
            repetition: None,
            revolution: 0,
            start,
            before: traced.then(|| run.ledger()),
            at_period: None,
            from: run.crank_and_time(),
            sampler: Sampler::begin(
                run,
                sensors,
                recorded.collect::<Result<_, Error>>()?,
                sampling.instants(start),
                trace,
            ),
            span: None,
        })
    }

    /// The recording of a period, or of the revolutions after a transient without one.
    fn period(&self, run: &mut Run<f64>, left: Left) -> Result<Recording<'a>, Error> {
        let Asked {
            sensors, settings, ..
        } = self.asked;
        let span = match left.period {
            Some(period) => Span::of_period(run, period, sensors, settings)?,
            None => Span::after(run, left.transient, sensors, settings)?,
        };
        let inner = sensors.iter().map(|_| Taken::Inner(Vec::new())).collect();
        Ok(Recording {
            left,
            repetition: None,
            revolution: 0,
            start: span.start,
            before: None,
            at_period: None,
            from: run.crank_and_time(),
            sampler: Sampler::begin(run, sensors, inner, span.instants, None),
            span: Some(span),
        })
    }

    /// When it will end if the start takes as long as it may, s.
    fn planned_end(&self, revolution: f64) -> f64 {
        let Settings {
            transient,
            revolutions,
            ..
        } = *self.asked.settings;
        let (Transient::Revolutions(before)
        | Transient::Settled {
            at_most: before, ..
        }) = transient;
        let count = f64::from(before) + f64::from(revolutions);
        count * revolution + self.delay
    }
}

impl Recording<'_> {
    /// At the end of a course: where the next one ends, s; none at the end of the record.
    fn arrive(&mut self, run: &mut Run<f64>) -> Option<f64> {
        if self.sampler.end_of_period().is_some() {
            self.repetition = None;
            return (!self.sampler.end_period(run)).then(|| self.sampler.end());
        }
        if run.time() >= self.sampler.end() {
            return None;
        }
        if let Some(repetition) = &mut self.repetition {
            repetition.arrive(run);
            self.revolution += 1;
            self.look_for_period(run);
        }
        Some(self.end(run))
    }

    /// Where the motion repeats itself, only one period more is looked at. Where it comes no nearer to that, it is not
    /// asked again.
    fn look_for_period(&mut self, run: &mut Run<f64>) {
        let Some(repetition) = &self.repetition else {
            return;
        };
        let (now, revolution) = (run.time(), run.revolution());
        match repetition.exact_period(run.tolerance(), (self.sampler.end() - now) / revolution) {
            Some(period) => {
                self.at_period = Some(run.ledger());
                self.sampler.repeat(run, f64::from(period) * revolution);
            }
            None if repetition.machine_is_restless() => self.repetition = None,
            None => {}
        }
    }

    /// Where the course under way ends, s.
    fn end(&self, run: &Run<f64>) -> f64 {
        let end = self.sampler.end();
        match (self.sampler.end_of_period(), &self.repetition) {
            (Some(end_of_period), _) => end_of_period,
            (None, Some(_)) => run.end_of(self.revolution).min(end),
            (None, None) => end,
        }
    }
}
