//! Exponents, orbits and regimes from the equations against the independent reference, periodic and
//! light sets.

use crate::common;

use common::{REVOLUTION, Run, reference, reference_machine};
use integrate::System;
use mechanism::{Dynamics, Machine};
use simulate::{ExponentSettings, Extent, Regime, exponents, motion};

fn check(case: &str) {
    let reference = reference();
    let machine = reference_machine(&reference[case]["parameters"]);
    let chaotic = case.starts_with("light") && case != "light_both_01mm";
    let settings = ExponentSettings {
        // Chaotic averages converge slowly.
        revolutions: if chaotic { 600 } else { 100 },
        ..ExponentSettings::default()
    };
    let motion = motion(&machine, &settings, Extent::Largest)
        .unwrap()
        .unwrap();
    let exponent = &motion.exponents[0];
    let (ours, error) = (
        exponent.per_revolution(),
        exponent.standard_error * exponent.revolution,
    );
    let number = |key: &str| reference[case]["lyapunov"][key].as_f64().unwrap();
    let (theirs, their_error) = (number("per_rev"), number("per_rev_se"));
    eprintln!("{case:18} {ours:8.4} ± {error:.4}   reference {theirs:8.4} ± {their_error:.4}");
    // The reference's regular cases agree with the largest Floquet multiplier to 1e-3.
    let allowed = (2.0 * error.hypot(their_error)).max(1e-3 * theirs.abs());
    assert!((ours - theirs).abs() < allowed, "{case}: {ours} {theirs}");

    if chaotic {
        assert_eq!(motion.regime, Regime::Chaotic, "{case}");
        return;
    }
    assert_eq!(motion.regime, Regime::Periodic { revolutions: 1 }, "{case}");
    let orbit = motion.orbit.unwrap();
    let floquet = orbit.exponent() * exponent.revolution;
    let modulus = orbit.largest_modulus();
    eprintln!(
        "{:18} {floquet:8.4} by its largest multiplier, {modulus:.6}",
        ""
    );
    // Where the two largest are conjugate, one tangent turns without end, and its average swings
    // about the limit by a share that falls with the revolutions alone; the area that two tangents
    // span does not swing.
    let growth = if orbit.multipliers[0].im == 0.0 {
        ours
    } else {
        let two = exponents(&machine, &settings, 2).unwrap();
        0.5 * (two[0].per_revolution() + two[1].per_revolution())
    };
    assert!(
        (growth - floquet).abs() < 1e-3,
        "{case}: {growth} {floquet}"
    );
    assert!(modulus < 1.0, "{case}");
}

macro_rules! cases {
    ($($name:ident)*) => { $( #[test] fn $name() { check(stringify!($name)); } )* };
}

cases! {
    big_01mm big_02mm big_03mm small_01mm small_02mm small_03mm both_01mm both_02mm both_03mm
    light_small_03mm light_both_01mm light_both_02mm light_both_03mm light_big_03mm
    free_both_02mm two_stage two_stage_free
}

/// Sum of ∂fᵢ/∂yᵢ, by central differences.
fn divergence(dynamics: &mut Dynamics<f64>, t: f64, y: &[f64]) -> f64 {
    let scales = dynamics.scales().to_vec();
    let mut rate = |y: &[f64], i: usize| {
        let mut rates = vec![0.0; y.len()];
        dynamics.derivative(t, y, &mut rates);
        rates[i]
    };
    (0..y.len())
        .map(|i| {
            let width = 1e-6 * scales[i];
            let [more, less] = [width, -width].map(|h| {
                let mut y = y.to_vec();
                y[i] += h;
                rate(&y, i)
            });
            (more - less) / (2.0 * width)
        })
        .sum()
}

/// The mean divergence over revolutions 20 to 30, 1/s.
fn mean_divergence(machine: Machine) -> f64 {
    let mut run = Run::start(machine, 1e-10, false);
    run.advance(20.0 * REVOLUTION);
    let mut sum = 0.0;
    let end = 30.0 * REVOLUTION;
    run.integrator
        .advance(&mut run.dynamics, end, |dynamics, step| {
            let mut y = step.from.clone();
            // Gauss and Legendre's nodes of order 6.
            let away = 0.5 * 0.6_f64.sqrt();
            for (share, weight) in [(0.5 - away, 5.0), (0.5, 8.0), (0.5 + away, 5.0)] {
                step.interpolate(share, &mut y);
                let t = step.start + share * step.length;
                sum += divergence(dynamics, t, &y) * step.length * weight / 18.0;
            }
        })
        .unwrap();
    sum / (10.0 * REVOLUTION)
}

#[test]
fn the_spectrum_sums_to_the_mean_divergence() {
    // No switch of these machines changes a volume: where the force jumps, the switch depends on
    // offsets alone, and the jump is in the rates.
    for case in ["both_02mm", "free_both_02mm"] {
        let machine = reference_machine(&reference()[case]["parameters"]);
        let settings = ExponentSettings {
            transient: 20,
            revolutions: 10,
            ..ExponentSettings::default()
        };
        let spectrum = exponents(&machine, &settings, usize::MAX).unwrap();
        let values: Vec<f64> = spectrum.iter().map(|e| e.per_second).collect();
        let (sum, expected) = (values.iter().sum::<f64>(), mean_divergence(machine));
        eprintln!("{case}: {values:.2?}, sum {sum:.4}, divergence {expected:.4}");
        assert!((sum / expected - 1.0).abs() < 1e-4, "{sum} {expected}");
    }
}
