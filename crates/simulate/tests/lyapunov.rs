//! The exponent from the equations against the independent reference, periodic and light sets.

#[path = "../../mechanism/tests/common/mod.rs"]
mod common;

use common::{reference, reference_machine};
use simulate::{ExponentSettings, Extent, Regime, motion};

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
    eprintln!(
        "{:?} {:?}",
        motion.regime,
        motion.orbit.as_ref().map(|o| (
            o.period,
            &o.multipliers,
            o.exponent() * o.period / f64::from(o.revolutions)
        ))
    );
    eprintln!("{case:18} {ours:8.4} ± {error:.4}   reference {theirs:8.4} ± {their_error:.4}");
    // The reference's regular cases agree with the largest Floquet multiplier to 1e-3.
    let allowed = (2.0 * error.hypot(their_error)).max(1e-3 * theirs.abs());
    assert!((ours - theirs).abs() < allowed, "{case}: {ours} {theirs}");
}

macro_rules! cases {
    ($($name:ident)*) => { $( #[test] fn $name() { check(stringify!($name)); } )* };
}

cases! {
    big_01mm big_02mm big_03mm small_01mm small_02mm small_03mm both_01mm both_02mm both_03mm
    light_small_03mm light_both_01mm light_both_02mm light_both_03mm light_big_03mm
    free_both_02mm two_stage two_stage_free
}
