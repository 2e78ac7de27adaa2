//! Whether a motion repeats itself, by where it stands at the ends of its revolutions.

use crate::run::Run;
use integrate::Real;

/// Within so many revolutions the distance of a settling motion from itself falls at least by this factor.
const PATIENCE: usize = 4;
const NEARER: f64 = 0.5;
/// Periods, in revolutions, that are looked for.
const PERIODS: [u32; 3] = [1, 2, LONGEST_PERIOD];
/// What a repetition may stray by, over the tolerance of the integration.
const STRAY: f64 = 0.1;
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
    /// Of the strobe at the end of each revolution from the one a period before, for each of the periods.
    distances: Vec<[f64; PERIODS.len()]>,
    /// The same without a linear frame: it follows the machine, and its free vibration is known.
    of_machine: Vec<[f64; PERIODS.len()]>,
}

impl Repetition {
    /// From where a run begins.
    pub fn begin<S: Real>(run: &mut Run<S>) -> Self {
        Self {
            strobes: vec![Strobe::new(run)],
            distances: Vec::new(),
            of_machine: Vec::new(),
        }
    }

    /// Takes in the end of a revolution.
    pub fn arrive<S: Real>(&mut self, run: &mut Run<S>) {
        let now = Strobe::new(run);
        let distances = PERIODS.map(|period| {
            let earlier = self.earlier(period, self.strobes.len());
            earlier.map_or([f64::INFINITY; 2], |earlier| {
                run.distances(&now.state, &earlier.state)
            })
        });
        self.distances.push(distances.map(|[of_all, _]| of_all));
        self.of_machine.push(distances.map(|[_, machine]| machine));
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
        let mut periods = PERIODS.into_iter().zip(self.distances.last()?);
        let near = periods.find(|(_, distance)| **distance < change);
        near.map(|(period, _)| period)
    }

    /// After how many revolutions all that the machine's motion depends on comes back, so nearly that in so many `revolutions` more it
    /// strays by a small part of the `tolerance` of the integration. None where there are no more than in a period.
    pub fn exact_period(&self, tolerance: f64, revolutions: f64) -> Option<u32> {
        let now = self.strobes.len() - 1;
        let distances = self.of_machine.last()?;
        let comes_back = |i: &usize| {
            let periods = revolutions / f64::from(PERIODS[*i]);
            let of_next = STRAY * tolerance / self.periods_to_come(*i).min(periods);
            let earlier = self.earlier(PERIODS[*i], now);
            periods > 1.0
                && distances[*i] < of_next
                && earlier.is_some_and(|earlier| self.strobes[now].remembers_as(earlier, of_next))
        };
        (0..PERIODS.len()).find(comes_back).map(|i| PERIODS[i])
    }

    /// How many times the last distance all those to come add up to, for a period: each is by a factor λ < 1 nearer than
    /// the one before, λ + λ² + … = λ / (1 - λ). Of the last two factors the greater counts, as distances may swing; and at
    /// least the last distance itself, as behind a fast part of the motion that settles there may be a slow one.
    fn periods_to_come(&self, period: usize) -> f64 {
        let at = |before: usize| {
            let index = self.of_machine.len().checked_sub(1 + before)?;
            Some(self.of_machine[index][period])
        };
        let factor = |before: usize| {
            let earlier = at(before + PERIODS[period] as usize)?;
            let is_known = earlier.is_finite();
            is_known.then_some(at(before)? / earlier)
        };
        match factor(0).zip(factor(1)) {
            Some((last, before)) if last.max(before) < 1.0 => {
                let factor = last.max(before);
                (factor / (1.0 - factor)).max(1.0)
            }
            _ => f64::INFINITY,
        }
    }

    /// Whether it comes no nearer to itself.
    pub fn is_restless(&self) -> bool {
        comes_no_nearer(&self.distances)
    }

    /// Whether the machine's motion does, whatever the frame does that follows it.
    pub fn machine_is_restless(&self) -> bool {
        comes_no_nearer(&self.of_machine)
    }
}

fn comes_no_nearer(distances: &[[f64; PERIODS.len()]]) -> bool {
    let least = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
    let Some(first) = distances.len().checked_sub(PATIENCE) else {
        return false;
    };
    let nearest = distances.as_flattened();
    let (before, now) = nearest.split_at(first * PERIODS.len());
    let before = &before[first.saturating_sub(PATIENCE) * PERIODS.len()..];
    first >= PATIENCE && least(now) > NEARER * least(before)
}
