//! A record under way, as a sequence of courses; the caller integrates to the end of each.

use crate::asked::Asked;
use crate::chain::{Sampling, check_settling};
use crate::error::Error;
use crate::leaving::{Leaving, Left};
use crate::record::Record;
use crate::recorder::Recorder;
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
    /// The series alone. The energy is checked over one revolution after the record, so that the record
    /// itself need not carry the works along.
    CheckedSeries,
    /// The motion as well. The energy is checked over the record.
    Trace,
    /// The series alone, unchecked, of which a settled motion is integrated over one period. What takes too long is given
    /// up.
    Period,
}

/// A record under way.
pub(crate) struct Task<'a> {
    asked: Asked<'a>,
    /// s after the transient.
    delay: f64,
    kept: Kept,
    pub run: Run<f64>,
    phase: Phase<'a>,
    course: Course,
}

enum Phase<'a> {
    Leaving(Leaving),
    Recording(Box<Recording<'a>>),
}

struct Recording<'a> {
    left: Left,
    /// When it begins, s.
    start: f64,
    sampler: Sampler<'a>,
    /// Where the sampler keeps inner samples: what they are of the record.
    span: Option<Span>,
    before: Option<Ledger>,
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
        let next = leaving.next(&run);
        let mut task = Self {
            course: run.course(0.0),
            phase: Phase::Leaving(leaving),
            asked,
            delay,
            kept,
            run,
        };
        task.head_for(next)?;
        Ok(task)
    }

    /// Sets out for the end of a revolution, or for the end of the record.
    fn head_for(&mut self, next: Result<f64, Left>) -> Result<(), Error> {
        let end = match next {
            Ok(end) => end,
            Err(left) => {
                let recording = self.recording(left)?;
                let end = recording.sampler.end();
                self.phase = Phase::Recording(Box::new(recording));
                end
            }
        };
        self.course = self.run.course(end);
        Ok(())
    }

    /// When it will end if the start takes as long as it may, s.
    fn planned_end(&self) -> f64 {
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
        count * self.run.revolution() + self.delay
    }

    fn recording(&mut self, left: Left) -> Result<Recording<'a>, Error> {
        let Asked {
            machine,
            sensors,
            settings,
            ..
        } = self.asked;
        if self.kept == Kept::Period {
            return self.period(left);
        }
        let length = f64::from(settings.revolutions) * self.run.revolution();
        let sampling = Sampling::new(sensors, settings, length)?;
        let lead = sampling.lead();
        // Structures swing themselves in for whole revolutions.
        let more = (sampling.settling() / self.run.revolution()).ceil();
        let mut left = left;
        left.transient += more as u32;
        let planned = f64::from(left.transient) * self.run.revolution() + self.delay;
        // A free crank that is slow may have taken longer for its transient.
        let start = match self.run.is_free() {
            true => planned.max(self.run.time() + lead as f64 / sampling.inner_rate),
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
            start,
            before: traced.then(|| self.run.ledger()),
            from: self.run.crank_and_time(),
            sampler: Sampler::begin(
                &mut self.run,
                sensors,
                recorded.collect::<Result<_, Error>>()?,
                sampling.instants(start),
                trace,
            ),
            span: None,
        })
    }

    /// The recording of a period, or of the revolutions after a transient without one.
    fn period(&mut self, left: Left) -> Result<Recording<'a>, Error> {
        let Asked {
            sensors, settings, ..
        } = self.asked;
        let span = match left.period {
            Some(period) => Span::of_period(&self.run, period, sensors, settings)?,
            None => Span::after(&self.run, left.transient, sensors, settings)?,
        };
        let inner = sensors.iter().map(|_| Taken::Inner(Vec::new())).collect();
        Ok(Recording {
            left,
            start: span.start,
            before: None,
            from: self.run.crank_and_time(),
            sampler: Sampler::begin(&mut self.run, sensors, inner, span.instants, None),
            span: Some(span),
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
                let next = left.map_or_else(|| leaving.next(&self.run), Err);
                self.phase = Phase::Leaving(leaving);
                self.head_for(next)?;
                Ok(Err(self))
            }
            Phase::Recording(recording) => {
                let Recording {
                    left,
                    start,
                    sampler,
                    span,
                    before,
                    from,
                } = *recording;
                let run = &mut self.run;
                // A fit may try a machine whose crank does not keep its speed.
                let mean_speed = match self.kept {
                    Kept::Period => TAU / run.revolution(),
                    _ => run.mean_speed(from)?,
                };
                let residual = match before {
                    Some(before) => Some(run.balance(&before)?),
                    None if self.kept == Kept::CheckedSeries => {
                        Some(run.audit(self.asked.settings.tolerance)?)
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
                        } = self.asked;
                        Recorder { sampling, start }.record(machine, sensors, &whole)?
                    }
                };
                Ok(Ok(Record {
                    sample_rate: self.asked.settings.sample_rate,
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
        let whole = self.planned_end();
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
