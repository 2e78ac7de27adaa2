//! Exponents, orbits and regimes of flows that are known well.

use integrate::{Real, System};
use nalgebra::Complex;
use simulate::{Cycle, ExponentSettings, Extent, Flow, Motion, Regime, exponents, motion};
use std::f64::consts::TAU;

/// A flow given by its derivative.
#[derive(Clone)]
struct Known<L> {
    law: L,
    start: &'static [f64],
    cycle: Cycle,
}

trait Law: Clone {
    fn rates<S: Real>(&self, t: S, y: &[S], dy: &mut [S]);
}

/// The same over a scalar.
#[derive(Clone)]
struct Over<L, S> {
    law: L,
    scales: Vec<S>,
}

impl<L: Law, S: Real> System<S> for Over<L, S> {
    fn dimension(&self) -> usize {
        self.scales.len()
    }
    fn derivative(&mut self, t: S, y: &[S], dy: &mut [S]) {
        self.law.rates(t, y, dy);
    }
    fn scales(&self) -> &[S] {
        &self.scales
    }
}

impl<L: Law> Flow for Known<L> {
    type System<S: Real> = Over<L, S>;
    fn start<S: Real>(&self) -> (Over<L, S>, Vec<S>) {
        let scales = vec![S::one(); self.start.len()];
        let state = self.start.iter().map(|x| S::constant(*x)).collect();
        let law = self.law.clone();
        (Over { law, scales }, state)
    }
    fn cycle(&self) -> Cycle {
        self.cycle
    }
}

/// Lorenz 1963: σ = 10, ρ = 28, β = 8/3.
#[derive(Clone)]
struct Lorenz;

impl Law for Lorenz {
    fn rates<S: Real>(&self, _t: S, y: &[S], dy: &mut [S]) {
        dy[0] = (y[1] - y[0]) * 10.0;
        dy[1] = y[0] * (-y[2] + 28.0) - y[1];
        dy[2] = y[0] * y[1] - y[2] * 8.0 / 3.0;
    }
}

/// x'' + 0.3 x' − x + x³ = F cos 1.2 t.
#[derive(Clone)]
struct Duffing {
    force: f64,
}

impl Law for Duffing {
    fn rates<S: Real>(&self, t: S, y: &[S], dy: &mut [S]) {
        let (_, cosine) = (t * 1.2).sin_cos();
        dy[0] = y[1];
        dy[1] = cosine * self.force - y[1] * 0.3 + y[0] - y[0] * y[0] * y[0];
    }
}

/// x'' − 0.2 (1 − x²) x' + x = F cos ω t.
#[derive(Clone)]
struct VanDerPol {
    force: f64,
    rate: f64,
}

impl Law for VanDerPol {
    fn rates<S: Real>(&self, t: S, y: &[S], dy: &mut [S]) {
        let (_, cosine) = (t * self.rate).sin_cos();
        dy[0] = y[1];
        dy[1] = cosine * self.force + (-y[0] * y[0] + 1.0) * y[1] * 0.2 - y[0];
    }
}

/// A free angle, θ' = 1 + 0.6 cos θ, that pulls at a weight: x' = cos θ − a x; and, apart from
/// both, an oscillator of angular speed 0.7 that keeps itself going (Stuart and Landau).
#[derive(Clone)]
struct Rotor {
    damping: f64,
}

impl Law for Rotor {
    fn rates<S: Real>(&self, t: S, y: &[S], dy: &mut [S]) {
        // The first component is the angle's deviation from 0.9 t.
        let (_, cosine) = (t * 0.9 + y[0]).sin_cos();
        dy[0] = cosine * 0.6 + 0.1;
        dy[1] = cosine - y[1] * self.damping;
        if let [_, _, u, v] = *y {
            let excess = -(u * u + v * v) + 1.0;
            dy[2] = excess * u - v * 0.7;
            dy[3] = excess * v + u * 0.7;
        }
    }
}

fn driven(rate: f64) -> Cycle {
    Cycle { rate, free: None }
}

const ROTOR: Cycle = Cycle {
    rate: 0.9,
    free: Some(0),
};

fn duffing(force: f64) -> Known<Duffing> {
    Known {
        law: Duffing { force },
        start: &[1.0, 0.0],
        cycle: driven(1.2),
    }
}

fn van_der_pol(force: f64, rate: f64) -> Known<VanDerPol> {
    Known {
        law: VanDerPol { force, rate },
        start: &[1.0, 0.0],
        cycle: driven(rate),
    }
}

fn settings(transient: u32, revolutions: u32) -> ExponentSettings {
    ExponentSettings {
        transient,
        revolutions,
        tolerance: 1e-9,
    }
}

fn judge<L: Law>(flow: &Known<L>, transient: u32, revolutions: u32) -> Motion {
    let settings = settings(transient, revolutions);
    let motion = motion(flow, &settings, Extent::Largest).unwrap().unwrap();
    let largest = &motion.exponents[0];
    eprintln!(
        "{:?}: {:.5} ± {:.5} per revolution, multipliers {:?}",
        motion.regime,
        largest.per_revolution(),
        largest.standard_error * largest.revolution,
        motion.orbit.as_ref().map(|orbit| &orbit.multipliers),
    );
    motion
}

#[test]
fn the_spectrum_of_lorenz() {
    let flow = Known {
        law: Lorenz,
        start: &[1.0, 1.0, 20.0],
        cycle: driven(TAU),
    };
    // 0.9056 to four digits: Viswanath 1998; the sum is the divergence −(10 + 1 + 8/3).
    let found = exponents(&flow, &settings(50, 10_000), 3).unwrap();
    let [first, second, third] = [0, 1, 2].map(|i| found[i].per_second);
    eprintln!("{first} ± {} {second} {third}", found[0].standard_error);
    assert!((first / 0.9056 - 1.0).abs() < 2e-3, "{first}");
    assert!(second.abs() < 1e-3, "{second}");
    assert!((third / -14.5723 - 1.0).abs() < 2e-3, "{third}");
    assert!((first + second + third + 41.0 / 3.0).abs() < 1e-6);
}

#[test]
fn duffing_through_its_regimes() {
    // Regimes over the force: Jordan and Smith 2007, figure 13.
    for (force, expected) in [(0.20, 1), (0.28, 2), (0.29, 4), (0.37, 5), (0.65, 2)] {
        let motion = judge(&duffing(force), 300, 100);
        let revolutions = expected;
        assert_eq!(motion.regime, Regime::Periodic { revolutions }, "{force}");
        let orbit = motion.orbit.unwrap();
        // Liouville: the product of the multipliers is exp(−0.3 T).
        let product: Complex<f64> = orbit.multipliers.iter().product();
        assert!((product.re / (-0.3 * orbit.period).exp() - 1.0).abs() < 1e-6);
        let exponent = &motion.exponents[0];
        let off = (exponent.per_second - orbit.exponent()).abs();
        // A tangent that turns about the orbit swings with the number of turns that it has made.
        let allowed = 1e-3 * orbit.exponent().abs() + 3.0 * exponent.standard_error;
        assert!(off < allowed, "{force}: {} {orbit:?}", exponent.per_second);
    }
    let chaotic = judge(&duffing(0.50), 100, 2000);
    assert_eq!(chaotic.regime, Regime::Chaotic);
    assert_eq!(chaotic.orbit, None);
    let exponent = &chaotic.exponents[0];
    let off = (exponent.per_second - 0.1041).abs();
    assert!(off < 3.0 * exponent.standard_error, "{off}");
}

#[test]
fn van_der_pol_in_and_out_of_step() {
    // The force locks the oscillation near resonance, not away from it.
    let locked = judge(&van_der_pol(0.3, 1.02), 300, 100);
    assert_eq!(locked.regime, Regime::Periodic { revolutions: 1 });
    let drifting = judge(&van_der_pol(0.3, 1.7), 300, 300);
    assert_eq!(drifting.regime, Regime::QuasiPeriodic);
}

#[test]
fn an_orbit_whose_period_is_its_own() {
    let flow = Known {
        law: Rotor { damping: 0.3 },
        start: &[0.0, 0.0],
        cycle: ROTOR,
    };
    let motion = judge(&flow, 20, 100);
    assert_eq!(motion.regime, Regime::Periodic { revolutions: 1 });
    let orbit = motion.orbit.unwrap();
    // θ' = 1 + b cos θ turns once in 2π / √(1 − b²).
    let period = TAU / (1.0_f64 - 0.36).sqrt();
    assert!((orbit.period / period - 1.0).abs() < 1e-8, "{orbit:?}");
    let [multiplier] = orbit.multipliers[..] else {
        panic!("{orbit:?}");
    };
    assert!(
        (multiplier.re / (-0.3 * period).exp() - 1.0).abs() < 1e-6,
        "{orbit:?}"
    );
    assert_eq!(orbit.exponent(), 0.0);
}

#[test]
fn two_free_rhythms_are_quasi_periodic() {
    let flow = Known {
        law: Rotor { damping: 0.3 },
        start: &[0.0, 0.0, 0.5, 0.0],
        cycle: ROTOR,
    };
    assert_eq!(judge(&flow, 50, 200).regime, Regime::QuasiPeriodic);
}
