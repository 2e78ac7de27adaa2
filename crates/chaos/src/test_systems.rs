//! Signals whose nature is known: chaotic systems with their largest Lyapunov exponent, regular
//! signals and noises. Estimators are measured against them.
//!
//! The exponents come from the tangent method (Benettin, Galgani, Giorgilli and Strelcyn 1980).
//! The equations are evaluated with dual numbers, and the growth of the tangent is averaged.

mod flows;
mod machines;
mod noises;
mod regular;
mod tangent;

pub use machines::{Machine, Memory};
pub use noises::{Noise, with_noise};
pub use regular::Regular;

use flows::{Duffing, Flow, Lorenz, MackeyGlass, Roessler};
use rand::{RngExt, SeedableRng};
use scalar::random::Stream;
use scalar::{Dual, Scalar};
use tangent::{TRANSIENT, Tangent, mean_growths, renormalise};

/// A chaotic system, observed through its first coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// `x -> 4 x (1 - x)` (May 1976).
    Logistic,
    /// `x -> 1 - 1.4 x^2 + y, y -> 0.3 x` (Hénon 1976).
    Henon,
    /// Lorenz 1963, with 10, 28, 8/3.
    Lorenz,
    /// Rössler 1976, with 0.2, 0.2, 5.7.
    Roessler,
    /// `x' = 0.2 x(t-17) / (1 + x(t-17)^10) - 0.1 x` (Mackey and Glass 1977).
    MackeyGlass,
    /// `x'' + 0.3 x' - x + x^3 = 0.5 cos 1.2 t` (Duffing; Ueda 1979).
    Duffing,
}

impl System {
    /// Every system.
    pub const ALL: [Self; 6] = [
        Self::Logistic,
        Self::Henon,
        Self::Lorenz,
        Self::Roessler,
        Self::MackeyGlass,
        Self::Duffing,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Logistic => "logistic",
            Self::Henon => "Henon",
            Self::Lorenz => "Lorenz",
            Self::Roessler => "Roessler",
            Self::MackeyGlass => "Mackey-Glass",
            Self::Duffing => "Duffing",
        }
    }

    /// Time between samples: 1 for a map; about a twentieth of the mean period of a flow (s).
    pub fn sample_interval(self) -> f64 {
        match self {
            Self::Logistic | Self::Henon => 1.0,
            Self::Lorenz => 0.04,
            Self::Roessler => 0.3,
            Self::MackeyGlass => 2.5,
            Self::Duffing => std::f64::consts::TAU / 1.2 / 20.0,
        }
    }

    /// Largest Lyapunov exponent in nats per step (maps) or per second (flows), computed once
    /// with [`System::tangent_exponent`] over 4 million samples (Duffing: 20 million, 0.10523 with
    /// a standard error of 0.00020).
    pub fn exponent(self) -> f64 {
        match self {
            Self::Logistic => std::f64::consts::LN_2,
            Self::Henon => 0.4193,
            Self::Lorenz => 0.906,
            Self::Roessler => 0.0714,
            Self::MackeyGlass => 0.00513,
            Self::Duffing => 0.1052,
        }
    }

    /// `length` samples after the transient has died away; another `seed`, another stretch.
    pub fn samples(self, length: usize, seed: u64) -> Vec<f64> {
        let start = Stream::seed_from_u64(seed).random_range(0.1..0.9);
        match self {
            Self::Logistic => map_samples(logistic, [start], length),
            Self::Henon => map_samples(henon, [0.1 * start, 0.0], length),
            Self::Lorenz => self.flow_samples(&Lorenz, [1.0 + start, 1.0, 20.0], length),
            Self::Roessler => self.flow_samples(&Roessler, [1.0 + start, 1.0, 0.0], length),
            Self::Duffing => self.flow_samples(&Duffing, [start, 0.0], length),
            Self::MackeyGlass => MackeyGlass::new(0.6 + start).samples(length),
        }
    }

    /// The exponent by the tangent method over `length` samples, in the unit of
    /// [`System::exponent`].
    pub fn tangent_exponent(self, length: usize) -> f64 {
        self.tangent_exponents(length, 1)[0]
    }

    /// The same for so many successive stretches of `length` samples, whose scatter is the error.
    pub fn tangent_exponents(self, length: usize, stretches: usize) -> Vec<f64> {
        let lengths = (length, stretches);
        let mut growths = match self {
            Self::Logistic => map_growth(logistic, [Dual::variable(0.3, 0)], lengths),
            Self::Henon => map_growth(
                henon,
                [Dual::variable(0.1, 0), Dual::constant(0.0)],
                lengths,
            ),
            Self::Lorenz => self.flow_growth(&Lorenz, [1.3, 1.0, 20.0], lengths),
            Self::Roessler => self.flow_growth(&Roessler, [1.3, 1.0, 0.0], lengths),
            Self::Duffing => self.flow_growth(&Duffing, [0.3, 0.0], lengths),
            Self::MackeyGlass => MackeyGlass::new(Dual::variable(0.9, 0)).growth(lengths),
        };
        growths
            .iter_mut()
            .for_each(|g| *g /= self.sample_interval());
        growths
    }

    fn flow_samples<const N: usize>(
        self,
        flow: &impl Flow<N>,
        mut y: [f64; N],
        length: usize,
    ) -> Vec<f64> {
        let interval = self.sample_interval();
        let mut t = 0.0;
        let mut sample = || {
            y = flows::advance(flow, t, y, interval);
            t += interval;
            y[0]
        };
        (0..TRANSIENT).for_each(|_| {
            sample();
        });
        (0..length).map(|_| sample()).collect()
    }

    fn flow_growth<const N: usize>(
        self,
        flow: &impl Flow<N>,
        start: [f64; N],
        lengths: (usize, usize),
    ) -> Vec<f64> {
        let interval = self.sample_interval();
        let mut y: [Tangent; N] = start.map(|x| Dual {
            value: x,
            tangent: [1.0],
        });
        let mut t = 0.0;
        mean_growths(lengths, || {
            y = flows::advance(flow, t, y, interval);
            t += interval;
            renormalise(&mut y)
        })
    }
}

fn logistic<S: Scalar>([x]: [S; 1]) -> [S; 1] {
    [x * (S::one() - x) * 4.0]
}

fn henon<S: Scalar>([x, y]: [S; 2]) -> [S; 2] {
    [y + S::one() - x * x * 1.4, x * 0.3]
}

fn map_samples<const N: usize>(
    map: impl Fn([f64; N]) -> [f64; N],
    mut y: [f64; N],
    length: usize,
) -> Vec<f64> {
    (0..TRANSIENT).for_each(|_| y = map(y));
    (0..length)
        .map(|_| {
            y = map(y);
            y[0]
        })
        .collect()
}

fn map_growth<const N: usize>(
    map: impl Fn([Tangent; N]) -> [Tangent; N],
    mut y: [Tangent; N],
    lengths: (usize, usize),
) -> Vec<f64> {
    mean_growths(lengths, || {
        y = map(y);
        renormalise(&mut y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stated_exponents_are_those_of_the_tangent_method() {
        for system in System::ALL {
            let found = system.tangent_exponent(100_000);
            let error = found / system.exponent() - 1.0;
            assert!(error.abs() < 0.05, "{}: {found}", system.name());
        }
    }

    #[test]
    fn seeds_give_other_stretches_of_the_same_system() {
        for system in System::ALL {
            let (a, b) = (system.samples(500, 1), system.samples(500, 2));
            assert_eq!(a, system.samples(500, 1));
            assert_ne!(a, b);
            assert!(
                a.iter().chain(&b).all(|x| x.abs() < 50.0),
                "{}",
                system.name()
            );
        }
    }
}
