//! One period of a motion that repeats itself, as sensors see it.

use crate::free_vibration::FramePeriod;
use crate::polynomial::Polynomial;

/// Smallest part of a step that is looked at by itself: whatever a polynomial leaves out of that is small.
const SMALLEST: f64 = 0.125;

/// A period: polynomials over the parts of its steps.
pub(crate) struct Period {
    /// When it begins, s.
    pub start: f64,
    /// How long it takes, s.
    pub length: f64,
    /// The frame's motion, where that is seen and need not repeat itself.
    pub frame: Option<FramePeriod>,
    /// When each part begins, s, and how long it is, s.
    parts: Vec<[f64; 2]>,
    /// Of each part what each sensor sees.
    polynomials: Vec<Polynomial>,
}

/// A part of a step, from one share of it to another.
#[derive(Clone, Copy)]
pub(crate) struct Part([f64; 2]);

impl Part {
    /// The whole step.
    pub const WHOLE: Self = Self([0.0, 1.0]);

    /// Where it lies in a step that begins at `start` and takes `length`, s: its own beginning and length.
    pub fn span(self, [start, length]: [f64; 2]) -> [f64; 2] {
        let [from, to] = self.0;
        [start + length * from, length * (to - from)]
    }

    /// Its halves, where these are not too small.
    pub fn halves(self) -> Option<[Self; 2]> {
        let [from, to] = self.0;
        let middle = 0.5 * (from + to);
        (middle - from >= SMALLEST).then_some([Self([from, middle]), Self([middle, to])])
    }
}

impl Period {
    /// Before its beginning at the time `start`; it takes `length`, both s.
    pub fn new(start: f64, length: f64, frame: Option<FramePeriod>) -> Self {
        Self {
            start,
            length,
            frame,
            parts: Vec::new(),
            polynomials: Vec::new(),
        }
    }

    /// When it ends, s.
    pub fn end(&self) -> f64 {
        self.start + self.length
    }

    /// Takes in its next part by the polynomials of all sensors.
    pub fn extend(&mut self, part: [f64; 2], polynomials: impl IntoIterator<Item = Polynomial>) {
        self.parts.push(part);
        self.polynomials.extend(polynomials);
    }

    /// Its parts, each with the polynomials of all `sensors`.
    pub fn parts(&self, sensors: usize) -> impl Iterator<Item = ([f64; 2], &[Polynomial])> {
        let polynomials = self.polynomials.chunks_exact(sensors.max(1));
        self.parts.iter().copied().zip(polynomials)
    }
}
