//! Whether a motion repeats itself, by where it stands at the ends of its revolutions.

use crate::run::Run;
use integrate::Real;

/// Within so many revolutions the distance of a settling motion from itself falls at least by this factor.
const PATIENCE: usize = 4;
const NEARER: f64 = 0.5;
/// Periods, in revolutions, that are looked for.
const PERIODS: [u32; 3] = [1, 2, LONGEST_PERIOD];
/// Longest period of a settled motion, revolutions.
pub const LONGEST_PERIOD: u32 = 4;

/// Where a motion stands at the end of a revolution.
struct Strobe {
    state: Vec<f64>,
    /// What the forces depend on beside the state.
    memory: Vec<f64>,
}

impl Strobe {
    fn new<S: Real>(run: &mut Run<S>) -> Self {
        Self {
            state: run.strobe(),
            memory: run.memory().into_iter().map(|m| m.value()).collect(),
        }
    }

    /// Whether all of its memory is that of another, but for this share.
    fn remembers_as(&self, other: &Self, change: f64) -> bool {
        let mut pairs = self.memory.iter().zip(&other.memory);
        self.memory.len() == other.memory.len()
            && pairs.all(|(a, b)| (a - b).abs() <= change * a.abs().max(b.abs()))
    }
}

/// The last revolutions of a motion, and how near each came to an earlier one.
pub(crate) struct Repetition {
    /// As many as the longest period needs, the last one at the end.
    strobes: Vec<Strobe>,
    /// Of the last strobe from the one a period before, for each of the periods.
    distances: [f64; PERIODS.len()],
    /// The least of these after each revolution.
    nearest: Vec<f64>,
}

impl Repetition {
    /// From where a run begins.
    pub fn begin<S: Real>(run: &mut Run<S>) -> Self {
        Self {
            strobes: vec![Strobe::new(run)],
            distances: [f64::INFINITY; PERIODS.len()],
            nearest: Vec::new(),
        }
    }

    /// Takes in the end of a revolution.
    pub fn arrive<S: Real>(&mut self, run: &mut Run<S>) {
        let now = Strobe::new(run);
        self.distances = PERIODS.map(|period| {
            let earlier = self.earlier(period, self.strobes.len());
            earlier.map_or(f64::INFINITY, |earlier| {
                run.distance(&now.state, &earlier.state)
            })
        });
        let nearest = self.distances.iter().copied().fold(f64::INFINITY, f64::min);
        self.nearest.push(nearest);
        self.strobes.push(now);
        let excess = self
            .strobes
            .len()
            .saturating_sub(LONGEST_PERIOD as usize + 1);
        self.strobes.drain(..excess);
    }

    /// The strobe so many revolutions before that of number `index`.
    fn earlier(&self, period: u32, index: usize) -> Option<&Strobe> {
        let earlier = index.checked_sub(period as usize);
        earlier.and_then(|i| self.strobes.get(i))
    }

    /// After how many revolutions the last state comes back, but for a change of less than this: of an offset over its
    /// clearance, of a rate over its scale.
    pub fn period(&self, change: f64) -> Option<u32> {
        let mut periods = PERIODS.into_iter().zip(self.distances);
        let near = periods.find(|(_, distance)| *distance < change);
        near.map(|(period, _)| period)
    }

    /// After how many revolutions all that the motion depends on comes back, so nearly that it strays by less than
    /// `change` in so many `revolutions` more: each period of a settling motion strays by less than the one before. None
    /// where there are no more than in a period.
    pub fn exact_period(&self, change: f64, revolutions: f64) -> Option<u32> {
        let now = self.strobes.len() - 1;
        let of_all = |period: u32| change * f64::from(period) / revolutions;
        let comes_back = |period: &u32| {
            let earlier = self.earlier(*period, now);
            earlier.is_some_and(|earlier| self.strobes[now].remembers_as(earlier, of_all(*period)))
        };
        let near = PERIODS.into_iter().zip(self.distances);
        near.filter(|(period, distance)| {
            f64::from(*period) < revolutions && *distance < of_all(*period)
        })
        .map(|(period, _)| period)
        .find(comes_back)
    }

    /// Whether it comes no nearer to itself.
    pub fn is_restless(&self) -> bool {
        let least = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
        let Some(first) = self.nearest.len().checked_sub(PATIENCE) else {
            return false;
        };
        let (before, now) = self.nearest.split_at(first);
        first >= PATIENCE && least(now) > NEARER * least(&before[first - PATIENCE..])
    }
}
