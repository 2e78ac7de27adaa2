//! What is left of a frame's free vibration where the machine's motion repeats itself.
//!
//! The machine moves as if the frame stood still (`mechanism/MODEL.md`). So its motion may repeat itself long before that of the frame does,
//! z = (place, rate), which differs from the one that repeats itself after T by a free vibration e:
//!
//! ```text
//! z(t) = p(t) + e(t)        p(t + T) = p(t)        e(t + s) = Φ(s) e(t)        e(t₀) = (1 − Φ(T))⁻¹ (z(t₀) − z(t₀ + T))
//! ```
//!
//! With one period of z known, from t₀ on, z(t₀ + kT + s) = z(t₀ + s) + Φ(s) (Φ(kT) − 1) e(t₀).

use crate::run::Run;
use crate::sensor::Sensor;
use mechanism::frame::{Frame, FrameMotion, Swing};

/// A period of a frame's motion under way.
pub(crate) struct FramePeriod {
    frame: Frame<f64>,
    at_start: FrameMotion,
    /// What each sensor sees of each component.
    seen: Vec<FrameMotion>,
}

/// What the frame's motion is more, period by period, than in the first one.
pub(crate) struct Departure {
    frame: Frame<f64>,
    seen: Vec<FrameMotion>,
    period: [Swing; 2],
    /// e at the beginning of the first period, and of the one under way.
    first: FrameMotion,
    now: FrameMotion,
}

/// The departure instant by instant.
pub(crate) struct Instantly<'a> {
    seen: &'a [FrameMotion],
    step: [Swing; 2],
    now: FrameMotion,
}

impl FramePeriod {
    /// From where a run stands; none where no sensor sees a linear frame.
    pub fn begin(run: &mut Run<f64>, sensors: &[Sensor]) -> Option<Self> {
        let (frame, at_start) = run.linear_frame()?;
        let frame = frame.clone();
        let still = run.seen_with_frame([0.0; 4], sensors)?;
        let mut seen = vec![[0.0; 4]; sensors.len()];
        for component in 0..4 {
            let mut unit = [0.0; 4];
            unit[component] = 1.0;
            let moved = run.seen_with_frame(unit, sensors)?;
            for ((seen, moved), still) in seen.iter_mut().zip(moved).zip(&still) {
                seen[component] = moved - still;
            }
        }
        let is_seen = seen.as_flattened().iter().any(|share| *share != 0.0);
        is_seen.then_some(Self {
            frame,
            at_start,
            seen,
        })
    }

    /// At its end, `length` (s) later.
    pub fn end(self, run: &Run<f64>, length: f64) -> Option<Departure> {
        let (_, at_end) = run.linear_frame()?;
        let period = self.frame.swing(length);
        let mut first = [0.0; 4];
        for (axis, [[a, b], [c, d]]) in period.into_iter().enumerate() {
            let [place, rate] = [axis, axis + 2].map(|i| self.at_start[i] - at_end[i]);
            let determinant = (1.0 - a) * (1.0 - d) - b * c;
            first[axis] = ((1.0 - d) * place + b * rate) / determinant;
            first[axis + 2] = (c * place + (1.0 - a) * rate) / determinant;
        }
        Some(Departure {
            frame: self.frame,
            seen: self.seen,
            period,
            first,
            now: first,
        })
    }
}

impl Departure {
    /// Goes on to the next period.
    pub fn pass(&mut self) {
        self.now = after(&self.period, self.now);
    }

    /// From an instant so long after the beginning of the period under way, at instants so far apart, both s.
    pub fn instantly(&self, since: f64, apart: f64) -> Instantly<'_> {
        let departed = std::array::from_fn(|i| self.now[i] - self.first[i]);
        Instantly {
            seen: &self.seen,
            step: self.frame.swing(apart),
            now: after(&self.frame.swing(since), departed),
        }
    }
}

impl Instantly<'_> {
    /// What each sensor sees of it.
    pub fn seen(&self) -> &[FrameMotion] {
        self.seen
    }

    /// At the next instant.
    pub fn next(&mut self) -> FrameMotion {
        let now = self.now;
        self.now = after(&self.step, now);
        now
    }
}

/// What a time makes of a motion.
fn after([x, y]: &[Swing; 2], motion: FrameMotion) -> FrameMotion {
    let part =
        |[place, rate]: [f64; 2], axis: usize| place * motion[axis] + rate * motion[axis + 2];
    [part(x[0], 0), part(y[0], 1), part(x[1], 0), part(y[1], 1)]
}
