//! How a run leaves its start behind: revolution after revolution, until it repeats itself.

use crate::error::Error;
use crate::repetition::Repetition;
use crate::run::Run;
use crate::settings::Transient;
use integrate::Real;

/// A start that is being left.
pub(crate) struct Leaving {
    change: f64,
    at_most: u32,
    /// The revolution that is under way.
    pub revolution: u32,
    pub repetition: Repetition,
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
            repetition: Repetition::begin(run),
        }
    }

    /// Where the revolution under way ends, s; or that there is none, but for the last, which leads
    /// into the record.
    pub fn next<S: Real>(&self, run: &Run<S>) -> Result<f64, Left> {
        match self.revolution < self.at_most {
            true => Ok(run.end_of(self.revolution)),
            false => Err(self.at_most()),
        }
    }

    /// After as many revolutions as it may take.
    pub fn at_most(&self) -> Left {
        Left {
            transient: self.at_most,
            period: None,
        }
    }

    /// At the end of a revolution: whether the start is left behind now.
    pub fn arrive<S: Real>(&mut self, run: &mut Run<S>) -> Option<Left> {
        let revolution = self.revolution;
        self.revolution += 1;
        self.repetition.arrive(run);
        let left = |period| {
            Some(Left {
                transient: revolution + 1,
                period,
            })
        };
        // Not before the start has had a revolution to pass.
        if revolution > 1
            && let Some(period) = self.repetition.period(self.change)
        {
            return left(Some(period));
        }
        if run.hurries() && self.change > 0.0 && self.repetition.is_restless() {
            return left(None);
        }
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
