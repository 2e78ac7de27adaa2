//! Step control, located switches, observers.

use crate::dop853::Step;
use crate::events::Finder;
use crate::glance::Glances;
use crate::system::{Real, System};
use scalar::{Scalar, inlined};

/// Why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// No step is short enough for the tolerance.
    #[error("the tolerance cannot be met at t = {time} s: the step shrank to {step:.3e} s")]
    StepTooSmall {
        /// Time reached, s.
        time: f64,
        /// Length of the last step tried, s.
        step: f64,
    },
    /// The tolerance asks for more steps than any run can afford.
    #[error(
        "the tolerance cannot be met at t = {time} s: {steps} steps led no further than {span:.3e} s"
    )]
    TooManySteps {
        /// Time reached, s.
        time: f64,
        /// Steps taken.
        steps: u64,
        /// Time that they covered, s.
        span: f64,
    },
    /// The switches follow each other without time passing.
    #[error("guard {guard} switches without end at t = {time} s")]
    Chatter {
        /// Time reached, s.
        time: f64,
        /// Number of the guard.
        guard: usize,
    },
    /// An observer ended it ([`Step::stop`]).
    #[error("stopped at t = {time} s")]
    Stopped {
        /// Time reached, s.
        time: f64,
    },
}

/// Counts of what an integration did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps taken.
    pub accepted: u64,
    /// Steps tried and given up for their error.
    pub rejected: u64,
    /// Switches located.
    pub switches: u64,
}

impl Work {
    /// Steps tried, whether they were taken or not.
    pub fn tried(&self) -> u64 {
        self.accepted + self.rejected
    }
}

/// Where an integrator is heading.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// Where it began, s.
    from: f64,
    /// What had been done there.
    before: Work,
    end: f64,
}

impl Course {
    /// Where it ends, s.
    pub fn end(&self) -> f64 {
        self.end
    }
}

/// A step to be tried.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Its length, s.
    pub length: f64,
    /// Whether it is shorter than the error asks for.
    limited: bool,
}

/// A system's state as it is carried forward in time.
#[derive(Clone, Debug)]
pub struct Integrator<S: Scalar> {
    pub(crate) step: Step<S>,
    finder: Finder<S>,
    pub(crate) glances: Glances<S>,
    /// Length to try next, s.
    length: f64,
    /// What the last error means for the length after next: error^(3/64), 1 where none is known.
    steadiness: f64,
    pub(crate) tolerance: f64,
    longest: f64,
    budget: f64,
    work: Work,
    /// The guard that switched last, when, and how often in a row at that time.
    last_switch: (usize, f64, u32),
    /// The switch that the next step leads to, if one is in sight.
    aim: Option<Aim>,
}

/// A switch that was located ahead.
#[derive(Clone, Copy, Debug)]
struct Aim {
    guard: usize,
    /// How far away it is, s.
    length: f64,
    /// Length and steadiness of the step in which it was found, which go on after it.
    next: (f64, f64),
}

/// What lies in a step that may have a switch in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sight {
    /// Nothing: the step stands.
    Clear,
    /// A switch, which a step to be tried next leads to: this one does not stand.
    Ahead,
    /// A switch of this guard at its very beginning.
    Here(usize),
}

/// Switches at one instant after which a guard is left alone for one step, and after which the
/// integration gives up.
const CALM: u32 = 3;
const CHATTER: u32 = 50;
/// Share of the length that the error allows which is tried.
const SAFETY: f64 = 0.9;
/// The steadiness after an error of 1e-4; a smaller one counts as this.
const LEAST_STEADINESS: f64 = 0.65;
/// Steps, accepted or not, that one longest step's time may take on average, beside as many to
/// begin with. A run at 1e-12 needs some hundred.
const BUDGET: f64 = 50_000.0;

impl<S: Real> Integrator<S> {
    /// Starts at `(t, y)`. Steps keep the local error below `tolerance` times the larger of a
    /// component and its scale, and are never longer than `longest`, s.
    pub fn new(system: &mut impl System<S>, t: f64, y: &[S], tolerance: f64, longest: f64) -> Self {
        let mut step = Step::new(y.len());
        step.start = S::constant(t);
        step.from.copy_from_slice(y);
        let mut glances = Glances::new(system.guard_count());
        glances.begin(system, &mut step);
        let mut integrator = Self {
            finder: Finder::new(y.len(), system.guard_count(), tolerance),
            glances,
            length: longest,
            steadiness: 1.0,
            step,
            tolerance,
            longest,
            budget: BUDGET,
            work: Work::default(),
            last_switch: (usize::MAX, t, 0),
            aim: None,
        };
        integrator.length = integrator.first_length(system);
        integrator
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.step.start.value()
    }

    /// Relative local error of its steps.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The state reached.
    pub fn state(&self) -> &[S] {
        &self.step.from
    }

    /// What it took to come here.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Sets the length of the next step to try, s.
    pub fn set_length(&mut self, length: f64) {
        self.length = length;
    }

    /// Sets how many steps a longest step's time may take on average; more is an error. Without this
    /// they are so many that no run which makes sense has them.
    pub fn set_budget(&mut self, steps: f64) {
        self.budget = steps;
    }

    /// Replaces the state (a tangent renormalised, a restart); time and mode stay.
    pub fn set_state(&mut self, system: &mut impl System<S>, y: &[S]) {
        self.step.from.copy_from_slice(y);
        self.glances.begin(system, &mut self.step);
    }

    /// Goes on to `end`.
    ///
    /// # Errors
    /// Where the tolerance cannot be met, or a switch has no end.
    pub fn reach(&mut self, system: &mut impl System<S>, end: f64) -> Result<(), Error> {
        self.go(system, end, None::<fn(&mut _, &mut Step<S>)>)
    }

    /// Goes on to `end`. After each step, still in the mode of that step, `observe` is shown the
    /// system and the step with its continuous extension.
    ///
    /// # Errors
    /// Where the tolerance cannot be met, or a switch has no end.
    pub fn advance<T: System<S>>(
        &mut self,
        system: &mut T,
        end: f64,
        mut observe: impl FnMut(&mut T, &Step<S>),
    ) -> Result<(), Error> {
        self.watch(system, end, |system, step| {
            step.extend(system);
            observe(system, step);
        })
    }

    /// The same for an observer that looks into few steps: it extends those itself.
    ///
    /// # Errors
    /// Where the tolerance cannot be met, or a switch has no end.
    pub fn watch<T: System<S>>(
        &mut self,
        system: &mut T,
        end: f64,
        observe: impl FnMut(&mut T, &mut Step<S>),
    ) -> Result<(), Error> {
        self.go(system, end, Some(observe))
    }

    fn go<T: System<S>>(
        &mut self,
        system: &mut T,
        end: f64,
        mut observe: Option<impl FnMut(&mut T, &mut Step<S>)>,
    ) -> Result<(), Error> {
        let course = self.course(end);
        while let Some(trial) = self.propose(&course)? {
            if !self.attempt(system, trial)? {
                continue;
            }
            let quiet = self.glances.quiet().unwrap_or(false);
            if self.looks_into(quiet) || S::DERIVATIVES && self.aim.is_some() {
                self.step.extend(system);
            }
            self.conclude(system, &course, quiet, &mut observe)?;
        }
        Ok(())
    }

    /// Whether a step that was taken has to be looked into, as it is not `quiet`.
    pub(crate) fn looks_into(&self, quiet: bool) -> bool {
        !quiet && self.aim.is_none()
    }

    /// The way from here to `end`.
    pub fn course(&self, end: f64) -> Course {
        Course {
            from: self.time(),
            before: self.work,
            end,
        }
    }

    /// The step to try next; none at the end of the course.
    ///
    /// # Errors
    /// Where the tolerance cannot be met.
    pub fn propose(&self, course: &Course) -> Result<Option<Trial>, Error> {
        let (time, end) = (self.time(), course.end);
        if time >= end {
            return Ok(None);
        }
        let span = time - course.from;
        let steps = self.work.tried() - course.before.tried();
        if steps as f64 > self.budget * (1.0 + span / self.longest) {
            return Err(Error::TooManySteps { time, steps, span });
        }
        if let Some(Aim { length, .. }) = self.aim {
            return Ok(Some(Trial {
                length,
                limited: true,
            }));
        }
        let remaining = end - time;
        let mut length = self.length.min(self.longest);
        // Never leave a last step that is too short to change the time.
        if remaining <= length * (1.0 + 1e-9) {
            length = remaining;
        } else if remaining < 2.0 * length {
            length = 0.5 * remaining;
        }
        let limited = length < self.length;
        self.possible(Trial { length, limited }).map(Some)
    }

    /// The trial, unless it is too short to change the time.
    fn possible(&self, trial: Trial) -> Result<Trial, Error> {
        let (time, step) = (self.time(), trial.length);
        if step <= 16.0 * f64::EPSILON * time.abs().max(1e-3) && !trial.limited {
            return Err(Error::StepTooSmall { time, step });
        }
        Ok(trial)
    }

    /// Makes an accepted step stand, and shows it, unless a switch is found in it. Where it is looked
    /// into, its continuous extension must be there.
    fn conclude<T: System<S>>(
        &mut self,
        system: &mut T,
        course: &Course,
        quiet: bool,
        observe: &mut Option<impl FnMut(&mut T, &mut Step<S>)>,
    ) -> Result<(), Error> {
        if self.looks_into(quiet) {
            match self.sight(system)? {
                Sight::Clear => {}
                Sight::Ahead => return Ok(()),
                Sight::Here(guard) => {
                    self.switch(system, guard);
                    return Ok(());
                }
            }
        }
        let later = match self.aim {
            Some(aim) => self.finder.delay(system, &self.step, aim.guard),
            None => S::zero(),
        };
        if let Some(observe) = observe {
            observe(system, &mut self.step);
            if self.step.take_last() {
                let time = self.time();
                return Err(Error::Stopped { time });
            }
        }
        self.step.shift();
        if later.varies() {
            self.step.delay(later);
        }
        self.glances.shift();
        if let Some(guard) = self.arrive(course) {
            self.switch(system, guard);
        }
        Ok(())
    }

    /// Changes the mode as the guard demands.
    pub(crate) fn switch(&mut self, system: &mut impl System<S>, guard: usize) {
        let t = self.step.start;
        let mut y = std::mem::take(&mut self.step.from);
        system.switch(guard, t, &mut y);
        self.step.from = y;
        self.glances.begin(system, &mut self.step);
        self.work.switches += 1;
    }

    /// Lets a step's time pass that was taken elsewhere; the guard that switches at its end, if one does.
    pub(crate) fn pass(&mut self, length: S, course: &Course) -> Option<usize> {
        self.step.start += length;
        self.arrive(course)
    }

    /// Counts a step that has brought the time to where it is; the guard that switches there, if one does.
    fn arrive(&mut self, course: &Course) -> Option<usize> {
        let aim = self.aim.take();
        if let Some(aim) = aim {
            (self.length, self.steadiness) = aim.next;
            self.last_switch = (aim.guard, self.time(), 1);
        }
        self.work.accepted += 1;
        let end = course.end;
        if (end - self.time()).abs() <= 4.0 * f64::EPSILON * end.abs() {
            self.step.start = S::constant(end);
        }
        aim.map(|aim| aim.guard)
    }

    /// Tries a step; false where its error is too large. Sets the length to try next.
    fn attempt(&mut self, system: &mut impl System<S>, trial: Trial) -> Result<bool, Error> {
        // After a switch whose time varies, the step brings the time back to a plain number.
        let back = S::constant(self.time()) - self.step.start;
        let look = inlined(
            #[inline(always)]
            |stage, system: &mut _| self.glances.stage(stage, system),
        );
        self.step.take(system, back + trial.length, look);
        let scales = system.scales();
        let squares = self.step.squared_errors(
            #[inline(always)]
            |j| {
                let size = self.step.from[j]
                    .value()
                    .abs()
                    .max(self.step.to[j].value().abs())
                    .max(scales[j].value());
                S::constant(self.tolerance * size)
            },
        );
        Ok(self.judge(trial, squares.map(S::value), counted(scales)))
    }

    /// Whether a step of these squared errors of order 5 and 3, summed over so many components, keeps
    /// the tolerance. Sets the length to try next, as the errors of this step and of the one before call
    /// for (Gustafsson 1991). A step's error swings, and one that happens to be small promises nothing.
    pub(crate) fn judge(&mut self, trial: Trial, squares: [f64; 2], counted: usize) -> bool {
        let error = weighted_error(trial.length, squares, counted);
        // Powers by square roots, which round the same on every machine.
        let eighth = error.sqrt().sqrt().sqrt();
        let Trial { length, limited } = trial;
        if error <= 1.0 {
            let sixteenth = eighth.sqrt();
            let thirty_second = sixteenth.sqrt();
            let factor = SAFETY * self.steadiness / (sixteenth * thirty_second);
            let next = length * factor.clamp(1.0 / 3.0, 6.0);
            if limited {
                // A step that was cut short says little about how long the next may be.
                self.length = next.max(self.length);
            } else {
                self.length = next;
                self.steadiness = (thirty_second * thirty_second.sqrt()).max(LEAST_STEADINESS);
            }
            return true;
        }
        let shorter = match error.is_finite() {
            true => (SAFETY / eighth).clamp(1.0 / 3.0, 1.0),
            false => 0.1,
        };
        self.length = length * shorter;
        self.steadiness = 1.0;
        self.work.rejected += 1;
        // What lies before a switch can be too short for the stages of the whole step to have seen it.
        self.aim = None;
        false
    }

    /// Looks into the step, whose continuous extension must be there, for the first switch in it.
    pub(crate) fn sight(&mut self, system: &mut impl System<S>) -> Result<Sight, Error> {
        let (last, when, count) = self.last_switch;
        let now = self.time();
        let ignored = (when == now && count >= CALM).then_some(last);
        let ends = self.glances.ends();
        let Some(crossing) = self.finder.first(system, &self.step, ends, ignored) else {
            return Ok(Sight::Clear);
        };
        let length = self.step.length.value() * crossing.share;
        let minute = 4.0 * f64::EPSILON * now.abs();
        if length > minute {
            self.aim = Some(Aim {
                guard: crossing.guard,
                length,
                next: (self.length, self.steadiness),
            });
            return Ok(Sight::Ahead);
        }
        let repeats = if when == now { count + 1 } else { 1 };
        if repeats > CHATTER {
            return Err(Error::Chatter {
                time: now,
                guard: crossing.guard,
            });
        }
        self.last_switch = (crossing.guard, now, repeats);
        Ok(Sight::Here(crossing.guard))
    }

    /// A first step length, from the sizes of state and derivative (Hairer, Nørsett and Wanner
    /// 1993, section II.4).
    fn first_length(&mut self, system: &mut impl System<S>) -> f64 {
        let scales: Vec<f64> = system.scales().iter().map(|s| s.value()).collect();
        let size = |values: &[S]| {
            let counted = values.iter().zip(&scales).filter(|(_, s)| s.is_finite());
            counted
                .map(|(v, s)| (v.value() / s).abs())
                .fold(0.0, f64::max)
        };
        let (state, slope) = (size(&self.step.from), size(self.step.derivative_from()));
        let guess = if state < 1e-5 || slope < 1e-5 {
            1e-6
        } else {
            0.01 * state / slope
        };
        guess.min(self.longest)
    }
}

/// How many components steer the step.
fn counted<S: Real>(scales: &[S]) -> usize {
    scales.iter().filter(|s| s.value().is_finite()).count()
}

/// The weighted error of a step, 1 at the tolerance (Hairer's combination of both estimates).
fn weighted_error(length: f64, [fifth, third]: [f64; 2], counted: usize) -> f64 {
    let denominator = fifth + 0.01 * third;
    if counted == 0 || denominator == 0.0 {
        return 0.0;
    }
    length * fifth / (denominator * counted as f64).sqrt()
}
