//! Regular signals that must not be called chaos.

use std::f64::consts::TAU;

/// A signal without sensitivity to its start, about 20 samples a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regular {
    /// A tone with two harmonics; the period is no whole number of samples.
    Periodic,
    /// Two tones whose periods are in the ratio of the golden section.
    TwoTone,
    /// A decaying ring of 5 samples a period, struck anew every 47.3 samples.
    KnockTrain,
}

impl Regular {
    /// Every regular signal.
    pub const ALL: [Self; 3] = [Self::Periodic, Self::TwoTone, Self::KnockTrain];

    /// `length` samples; another `seed`, another phase.
    pub fn samples(self, length: usize, seed: u64) -> Vec<f64> {
        let shift = 0.618 * seed as f64;
        (0..length)
            .map(|i| self.at(i as f64 + 20.0 * shift.fract()))
            .collect()
    }

    fn at(self, t: f64) -> f64 {
        let tone = |period: f64| (TAU * t / period).sin();
        match self {
            Self::Periodic => tone(20.3) + 0.5 * tone(20.3 / 2.0) + 0.2 * tone(20.3 / 3.0),
            Self::TwoTone => tone(20.3) + 0.8 * tone(20.3 * 0.618_033_988_749_895),
            Self::KnockTrain => {
                let since = t % 47.3;
                (-since / 8.0).exp() * (TAU * since / 5.0).sin()
            }
        }
    }
}
