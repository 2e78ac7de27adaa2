//! A signal that is late by any time, whole samples or not.

use std::collections::VecDeque;

/// Samples that a value between them is taken from.
const POINTS: usize = 4;

/// A delay by Lagrange's interpolation of third order (Laakso, Välimäki, Karjalainen and Laine 1996): good to
/// 0.1 % of the amplitude up to a tenth of the sample rate. Before the first sample the signal is taken to
/// have stood at its value.
#[derive(Clone, Debug)]
pub struct Delay {
    /// The latest samples, as many as the delay reaches back to, the newest last.
    past: VecDeque<f64>,
    reach: usize,
    /// Weights of the oldest four of them, from the newest on.
    weights: [f64; POINTS],
}

impl Delay {
    /// By so many samples, from 0 on.
    pub fn new(samples: f64) -> Self {
        // The value lies between the middle two of the four, unless the delay is too short for that.
        let first = (samples.floor() - 1.0).max(0.0);
        let rest = samples - first;
        let weight = |k: usize| {
            let others = (0..POINTS).filter(|j| *j != k);
            let factor = |j: usize| (rest - j as f64) / (k as f64 - j as f64);
            others.map(factor).product()
        };
        Self {
            past: VecDeque::new(),
            reach: first as usize + POINTS,
            weights: std::array::from_fn(weight),
        }
    }

    /// Takes the next sample, and gives the late one.
    #[inline]
    pub fn run(&mut self, x: f64) -> f64 {
        if self.reach == POINTS && self.weights[0] == 1.0 {
            return x;
        }
        if self.past.is_empty() {
            self.past.extend(std::iter::repeat_n(x, self.reach));
        }
        self.past.pop_front();
        self.past.push_back(x);
        let oldest = self.past.iter().take(POINTS).rev();
        oldest.zip(&self.weights).map(|(x, w)| x * w).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_is_late_by_the_delay() {
        for samples in [0.0, 0.3, 1.0, 2.5, 16.0, 16.75] {
            let mut delay = Delay::new(samples);
            let wave = |t: f64| (0.3 * t).sin();
            let late: Vec<f64> = (0..200).map(|i| delay.run(wave(f64::from(i)))).collect();
            for (i, x) in late.iter().enumerate().skip(30) {
                let expected = wave(i as f64 - samples);
                assert!((x - expected).abs() < 1e-3, "{samples}: {x} {expected}");
            }
        }
        assert_eq!(Delay::new(0.0).run(7.0), 7.0);
    }
}
