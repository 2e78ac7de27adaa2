//! How a run leaves its start behind: revolution after revolution, until it repeats itself.

use crate::error::Error;
use crate::run::Run;
use crate::settings::Transient;
use integrate::Real;

/// Within so many revolutions the distance of a settling motion from itself falls at least by this factor.
const PATIENCE: usize = 4;
const NEARER: f64 = 0.5;
/// Periods, in revolutions, that count as settled.
const PERIODS: [u32; 3] = [1, 2, LONGEST_PERIOD];
/// Longest period of a settled motion, revolutions.
pub const LONGEST_PERIOD: u32 = 4;

/// A start that is being left.
pub(crate) struct Leaving {
    change: f64,
    at_most: u32,
    /// The revolution that is under way.
    revolution: u32,
    strobes: Vec<Vec<f64>>,
    distances: Vec<f64>,
}

/// Where the start is left behind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Left {
    /// Revolutions that the transient takes.
    pub transient: u32,
    /// After how many the motion repeats itself, if it had settled.
    pub period: Option<u32>,
}

impl Leaving {
    /// From where the run stands.
    pub fn new<S: Real>(run: &mut Run<S>, transient: Transient) -> Self {
        let (change, at_most) = match transient {
            Transient::Revolutions(count) => (0.0, count),
            Transient::Settled { change, at_most } => (change, at_most),
        };
        Self {
            change,
            at_most,
            revolution: 1,
            strobes: vec![run.strobe()],
            distances: Vec::new(),
        }
    }

    /// Where the revolution under way ends, s; or that there is none, but for the last, which leads
    /// into the record.
    pub fn next<S: Real>(&self, run: &Run<S>) -> Result<f64, Left> {
        match self.revolution < self.at_most {
            true => Ok(run.end_of(self.revolution)),
            false => Err(Left {
                transient: self.at_most,
                period: None,
            }),
        }
    }

    /// At the end of a revolution: whether the start is left behind now.
    pub fn arrive<S: Real>(&mut self, run: &mut Run<S>) -> Option<Left> {
        let (revolution, change) = (self.revolution, self.change);
        self.revolution += 1;
        let now = run.strobe();
        let distance = |period: &u32| {
            let earlier = self.strobes.len().checked_sub(*period as usize);
            earlier.map_or(f64::INFINITY, |i| run.distance(&now, &self.strobes[i]))
        };
        let left = |period| {
            Some(Left {
                transient: revolution + 1,
                period,
            })
        };
        // Not before the start has had a revolution to pass.
        if revolution > 1
            && let Some(period) = PERIODS.into_iter().find(|p| distance(p) < change)
        {
            return left(Some(period));
        }
        let nearest = PERIODS.iter().map(distance).fold(f64::INFINITY, f64::min);
        self.distances.push(nearest);
        if run.hurries() && change > 0.0 && is_restless(&self.distances) {
            return left(None);
        }
        self.strobes.push(now);
        let keep = self.strobes.len().saturating_sub(LONGEST_PERIOD as usize);
        self.strobes.drain(..keep);
        None
    }
}

impl<S: Real> Run<S> {
    /// Leaves the start behind, but for the last revolution, which leads into the record. Returns
    /// how many revolutions the transient takes, and after how many the motion repeats itself, if it has
    /// settled.
    pub(crate) fn leave_transient(
        &mut self,
        transient: Transient,
    ) -> Result<(u32, Option<u32>), Error> {
        let mut leaving = Leaving::new(self, transient);
        loop {
            let left = match leaving.next(self) {
                Err(left) => Some(left),
                Ok(end) => {
                    self.advance(end)?;
                    leaving.arrive(self)
                }
            };
            if let Some(Left { transient, period }) = left {
                return Ok((transient, period));
            }
        }
    }
}

/// Whether a motion of these distances from itself comes no nearer.
fn is_restless(distances: &[f64]) -> bool {
    let least = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
    let Some(first) = distances.len().checked_sub(PATIENCE) else {
        return false;
    };
    let (before, now) = distances.split_at(first);
    first >= PATIENCE && least(now) > NEARER * least(&before[first - PATIENCE..])
}
