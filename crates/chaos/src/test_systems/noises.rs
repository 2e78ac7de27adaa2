//! Noises that must not be called chaos.

use super::System;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use scalar::random::Stream;

/// A linear stochastic signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Independent normal numbers.
    White,
    /// `x = 0.9 x(-1) + e`.
    Ar1,
    /// A resonance of 20 samples a period with pole radius 0.98: `x = 2 r cos w x(-1) - r^2 x(-2) + e`.
    Ar2,
    /// The Lorenz signal with its phases drawn anew.
    PhaseRandomised,
}

impl Noise {
    /// Every noise.
    pub const ALL: [Self; 4] = [Self::White, Self::Ar1, Self::Ar2, Self::PhaseRandomised];

    /// `length` samples of it.
    pub fn samples(self, length: usize, seed: u64) -> Vec<f64> {
        let radius: f64 = 0.98;
        let angle = std::f64::consts::TAU / 20.0;
        match self {
            Self::White => autoregression(0.0, 0.0, length, seed),
            Self::Ar1 => autoregression(0.9, 0.0, length, seed),
            Self::Ar2 => autoregression(2.0 * radius * angle.cos(), -radius.powi(2), length, seed),
            Self::PhaseRandomised => {
                let mut generator = Stream::seed_from_u64(seed);
                let lorenz = System::Lorenz.samples(length, seed);
                crate::surrogates::phase_randomised(&lorenz, &mut generator)
            }
        }
    }
}

fn autoregression(first: f64, second: f64, length: usize, seed: u64) -> Vec<f64> {
    let mut generator = Stream::seed_from_u64(seed);
    let (mut x, mut before) = (0.0, 0.0);
    let mut sample = || {
        let shock: f64 = generator.sample(StandardNormal);
        (x, before) = (first * x + second * before + shock, x);
        x
    };
    (0..1000).for_each(|_| {
        sample();
    });
    (0..length).map(|_| sample()).collect()
}

/// The signal with white normal noise whose standard deviation is `share` of the signal's.
pub fn with_noise(signal: &[f64], share: f64, seed: u64) -> Vec<f64> {
    let mut generator = Stream::seed_from_u64(seed ^ 0x006e_6f69_7365);
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let variance = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / signal.len() as f64;
    let size = share * variance.sqrt();
    signal
        .iter()
        .map(|x| x + size * generator.sample::<f64, _>(StandardNormal))
        .collect()
}
