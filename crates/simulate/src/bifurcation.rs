//! Bifurcation diagrams: a parameter is changed step by step, the state is carried along, and the
//! section is recorded at every value, upward and downward.
//!
//! Where two motions are stable at one value, the one that is seen is the one that the motion came
//! from; both directions together show the hysteresis.
//!
//! # Chunks
//!
//! A continuation is sequential by nature. To use several cores a direction is cut into chunks of
//! a given number of values, which are walked side by side. The first chunk starts from the
//! system's own start. Every other begins [`LEAD`] values early: it starts afresh there, settles for
//! [`SETTLE`] times the transient, and is continued to its first value before anything is kept. The
//! cuts depend on the settings alone, so the result does not depend on the threads.
//!
//! It follows every motion that is reached from the start, and every one that a walk of `LEAD` values
//! leads onto. It can miss a branch that is reached only from further away: a hysteresis wider than a
//! chunk may be lost at the end of the chunk, which shows as a jump at a cut. Where that matters, a
//! chunk as long as the diagram walks each direction in one piece.
//!
//! A value at which the system fails is reported as such; the next one starts afresh.

use crate::error::Error;
use crate::return_map::ReturnMap;
use crate::section::Revolution;
use mechanism::Machine;
use std::ops::Range;

/// Values that a chunk is continued through before its own.
pub const LEAD: usize = 4;
/// A fresh start settles for so many times the transient.
pub const SETTLE: u32 = 4;

/// A system whose parameter can be changed while it runs. Values of the parameter are known by
/// their number.
pub trait Continuation {
    /// The system under way.
    type State;
    /// What is recorded once a revolution.
    type Point;
    /// Why it failed.
    type Error;

    /// Starts at value `value`.
    ///
    /// # Errors
    /// Where there is no such system.
    fn start(&self, value: usize) -> Result<Self::State, Self::Error>;

    /// The motion goes on at value `value`.
    ///
    /// # Errors
    /// Where there is no such system.
    fn carry(&self, state: Self::State, value: usize) -> Result<Self::State, Self::Error>;

    /// Goes on for one revolution; `watched` is true where its point counts, or the next one's.
    ///
    /// # Errors
    /// Where it fails.
    fn revolve(&self, state: &mut Self::State, watched: bool) -> Result<Self::Point, Self::Error>;
}

/// Which way the values are gone through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the first to the last.
    Up,
    /// From the last to the first.
    Down,
}

impl Direction {
    /// `up` or `down`.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Up => "up",
            Direction::Down => "down",
        }
    }
}

/// Revolutions at each value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WalkSettings {
    /// Thrown away; with none the first point at a value is of a revolution that began before it.
    pub transient: u32,
    /// Recorded.
    pub revolutions: u32,
}

/// Values that are walked one after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunk {
    direction: Direction,
    /// Number of values of the whole diagram.
    count: usize,
    /// Positions of the chunk's own values on the walk through all of them.
    own: Range<usize>,
}

impl Chunk {
    /// The cuts of a walk through `count` values in chunks of `length` values, at least one.
    pub fn cut(direction: Direction, count: usize, length: usize) -> Vec<Self> {
        let length = length.max(1);
        let starts = (0..count).step_by(length);
        starts
            .map(|start| Self {
                direction,
                count,
                own: start..count.min(start.saturating_add(length)),
            })
            .collect()
    }

    /// Which way it goes.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// How many values it has.
    pub fn len(&self) -> usize {
        self.own.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// The first position that is walked through.
    fn begin(&self) -> usize {
        self.own.start.saturating_sub(LEAD)
    }

    fn value(&self, position: usize) -> usize {
        match self.direction {
            Direction::Up => position,
            Direction::Down => self.count - 1 - position,
        }
    }

    /// Revolutions that it takes.
    pub fn revolutions(&self, settings: &WalkSettings) -> u64 {
        let lead = (self.own.start - self.begin()) as u64;
        let own = self.len() as u64;
        let transients = lead + own + u64::from(SETTLE) - 1;
        transients * u64::from(settings.transient) + own * u64::from(settings.revolutions)
    }
}

/// The walk through a chunk: an iterator over its own values, each with its number and what was
/// recorded there.
pub struct Walk<'a, C: Continuation> {
    system: &'a C,
    settings: WalkSettings,
    chunk: Chunk,
    position: usize,
    state: Option<C::State>,
}

impl<'a, C: Continuation> Walk<'a, C> {
    /// The walk of `system` through `chunk`.
    pub fn new(system: &'a C, chunk: Chunk, settings: WalkSettings) -> Self {
        Self {
            system,
            settings,
            position: chunk.begin(),
            chunk,
            state: None,
        }
    }

    /// Settles at value `value` and records there. The state is lost where that fails.
    fn visit(&mut self, value: usize, recorded: u32) -> Result<Vec<C::Point>, C::Error> {
        let (mut state, transient) = match self.state.take() {
            Some(state) => (self.system.carry(state, value)?, self.settings.transient),
            None => {
                let transient = self.settings.transient.saturating_mul(SETTLE);
                (self.system.start(value)?, transient)
            }
        };
        for left in (0..transient).rev() {
            self.system.revolve(&mut state, left == 0 && recorded > 0)?;
        }
        let points = (0..recorded).map(|_| self.system.revolve(&mut state, true));
        let points = points.collect::<Result<_, _>>()?;
        self.state = Some(state);
        Ok(points)
    }
}

impl<C: Continuation> Iterator for Walk<'_, C> {
    type Item = (usize, Result<Vec<C::Point>, C::Error>);

    fn next(&mut self) -> Option<Self::Item> {
        while self.position < self.chunk.own.end {
            let value = self.chunk.value(self.position);
            let own = self.chunk.own.contains(&self.position);
            self.position += 1;
            let recorded = if own { self.settings.revolutions } else { 0 };
            let visited = self.visit(value, recorded);
            // What fails before the chunk's own values is reported by the chunk that they belong to.
            if own {
                return Some((value, visited));
            }
        }
        None
    }
}

/// Machines that differ in the value of a parameter, with their section at a crank angle.
pub struct Machines<F> {
    /// The machine at a value.
    pub machine: F,
    /// Crank angle of the section, rad.
    pub angle: f64,
    /// Relative local error of the integration.
    pub tolerance: f64,
}

/// A machine on its way.
pub struct Running(ReturnMap);

impl<F, E> Continuation for Machines<F>
where
    F: Fn(usize) -> Result<Machine, E>,
    E: From<Error>,
{
    type State = Running;
    type Point = Revolution;
    type Error = E;

    fn start(&self, value: usize) -> Result<Running, E> {
        let machine = (self.machine)(value)?;
        Ok(Running(ReturnMap::start(
            &machine,
            self.angle,
            self.tolerance,
        )))
    }

    fn carry(&self, state: Running, value: usize) -> Result<Running, E> {
        let machine = (self.machine)(value)?;
        Ok(Running(state.0.carried(&machine)))
    }

    fn revolve(&self, state: &mut Running, watched: bool) -> Result<Revolution, E> {
        Ok(state.0.revolve(watched)?)
    }
}
