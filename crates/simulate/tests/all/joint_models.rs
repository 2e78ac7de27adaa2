//! Motions with joints whose contact is rigid, or remembers how it was touched.

use crate::common;

use common::with_clearance;
use mechanism::joints::contact::{ContactLaw, Restitution};
use mechanism::joints::revolute::{Clearance, JointModel, Revolute};
use simulate::{ExponentSettings, Extent, Motion, Regime, motion};

/// The motion of the machine with both ends at 0.2 mm and another small end.
fn judged(change: impl Fn(&mut Clearance)) -> Motion {
    let mut machine = with_clearance(2e-4, 2e-4, 2e4);
    if let Revolute::Clear(clear) = &mut machine.throws[0].small_end {
        change(clear);
    }
    let settings = ExponentSettings {
        transient: 30,
        revolutions: 20,
        ..ExponentSettings::default()
    };
    let motion = motion(&machine, &settings, Extent::Spectrum)
        .unwrap()
        .unwrap();
    let exponents = motion.exponents.iter().map(|e| e.per_revolution());
    let exponents: Vec<f64> = exponents.collect();
    eprintln!("{:?} {exponents:.3?} {:?}", motion.regime, motion.orbit);
    motion
}

/// Checks that the motion lies on an orbit whose multiplier gives its exponent.
fn check(motion: &Motion) {
    assert!(matches!(motion.regime, Regime::Periodic { .. }));
    let orbit = motion.orbit.as_ref().unwrap();
    let largest = &motion.exponents[0];
    let off = (largest.per_second - orbit.exponent()) * largest.revolution;
    assert!(off.abs() < 5e-3, "{off} {orbit:?}");
}

#[test]
fn a_rigid_catch_swallows_directions() {
    let motion = judged(|clear| clear.model = JointModel::TwoMode);
    check(&motion);
    let lost = |e: &simulate::Exponent| e.per_second == f64::NEG_INFINITY;
    assert!(motion.exponents.iter().any(lost));
    assert!(motion.exponents.iter().all(|e| !e.standard_error.is_nan()));
}

#[test]
fn what_a_closed_contact_remembers_for_ever_is_no_motion() {
    let motion = judged(|clear| {
        clear.contact = ContactLaw::Flores(Restitution {
            stiffness: 2e10,
            exponent: 1.5,
            restitution: 0.3,
            slowest_approach: 1e-3,
        });
    });
    check(&motion);
    assert!(motion.exponents[0].per_revolution() < -0.1);
}
