//! Instants at which a run is looked at.

/// Equally spaced instants at which a run is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instants {
    /// The first, s.
    pub first: f64,
    /// How many a second.
    pub rate: f64,
    /// How many in all.
    pub count: usize,
}

impl Instants {
    pub(crate) fn at(&self, index: usize) -> f64 {
        self.first + index as f64 / self.rate
    }

    /// The last, s.
    pub(crate) fn end(&self) -> f64 {
        self.at(self.count.saturating_sub(1))
    }

    /// How many of those from number `seen` on come up to the time `stop`, s.
    pub(crate) fn within(&self, seen: usize, stop: f64) -> usize {
        let later = (seen..self.count).take_while(|i| self.at(*i) <= stop);
        later.count()
    }

    /// Those up to `time`, and those after it.
    pub(crate) fn split_at(self, time: f64) -> [Self; 2] {
        let mut count = self.count;
        while count > 0 && self.at(count - 1) > time {
            count -= 1;
        }
        let after = Self {
            first: self.at(count),
            count: self.count - count,
            ..self
        };
        [Self { count, ..self }, after]
    }
}
