//! The piston slap of Flores, Leine and Glocker 2010 (literature.md, D2): a free slider-crank whose
//! slider has clearance in its guide, up to its first contact.

use crate::common;

use common::{Run, single_stage};
use mechanism::drive::{Drive, MotorLine};
use mechanism::joints::contact::{ContactLaw, Hertz};
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::guide::{Guide, GuideClearance};
use mechanism::{Crankshaft, Crosshead, Machine, Rod};
use std::f64::consts::TAU;

const CLEARANCE: f64 = 0.001;

fn machine() -> Machine {
    let mut machine = single_stage();
    machine.crankshaft = Crankshaft {
        mass: 0.038,
        // 7.4e-5 kg m² about the centre of mass, halfway along the crank.
        inertia: 7.4e-5 + 0.038 * 0.0765 * 0.0765,
        eccentricity: 0.0765,
    };
    // No motor: the crank starts at 150 rad/s and is left alone.
    machine.drive = Drive::Free(MotorLine {
        reference_speed: 150.0,
        mean_torque: 0.0,
        slope: 0.0,
    });
    let throw = &mut machine.throws[0];
    throw.crank_radius = 0.153;
    throw.rod = Rod {
        length: 0.306,
        mass: 0.038,
        centre_of_mass: 0.153,
        inertia: 5.9e-4,
    };
    throw.crosshead = Crosshead {
        mass: 0.076,
        inertia: 2.7e-6,
    };
    throw.cylinder.suction = 1e5;
    throw.cylinder.discharge = 1e5;
    throw.cylinder.back = 1e5;
    throw.guide = Guide::Clear(GuideClearance {
        clearance: CLEARANCE,
        half_length: 0.05,
        half_height: 0.025,
        contact: ContactLaw::Hertz(Hertz {
            stiffness: 1e9,
            exponent: 1.5,
        }),
        friction: FrictionLaw::none(),
    });
    machine
}

/// Relative difference, printed, and asserted to be within half a unit of the last digit given
/// or 1e-6, whichever is more.
fn check(name: &str, found: f64, expected: f64, last_digit: f64) {
    let off = (found - expected).abs();
    eprintln!("{name:28} {found:.9} ({expected}) off by {off:.1e}");
    let allowed = (0.51 * last_digit).max(1e-6 * expected.abs());
    assert!(off <= allowed, "{name}: {found} {expected}");
}

#[test]
fn crank_and_rod_at_one_and_two_milliseconds() {
    let mut run = Run::start(machine(), 1e-12, false);
    for (ms, turns, crank, rod) in [
        (1.0, 0.023_251_1, 139.116, -68.276),
        (2.0, 0.043_894_0, 120.464, -56.473),
    ] {
        run.advance(ms * 1e-3);
        let at = run.now();
        check("turns", at.angle / TAU, turns, 1e-7);
        check("crank, rad/s", at.speed, crank, 1e-3);
        check("rod, rad/s", at.throws[0].motion.rod_rate, rod, 1e-3);
    }
}

#[test]
fn first_contact() {
    let mut run = Run::start(machine(), 1e-12, false);
    let mut touch = None;
    run.integrator
        .advance(&mut run.dynamics, 0.0028, |dynamics, step| {
            // The step that ends in the first touch is the last one with all corners apart.
            if dynamics.mode().throws[0]
                .guide
                .iter()
                .all(|c| c.touching == 0.0)
            {
                touch = Some((step.start + step.length, step.to.clone()));
            }
        })
        .unwrap();
    let (t, y) = touch.unwrap();
    let at = run.dynamics.evaluate(t, &y);
    let corner = at.throws[0].joints.guide.corners;
    let nearest = corner
        .iter()
        .max_by(|a, b| a.penetration.total_cmp(&b.penetration))
        .unwrap();
    check("time, ms", t * 1e3, 2.692_503, 1e-6);
    check("turns", at.angle / TAU, 0.056_548_46, 1e-8);
    check("crank, rad/s", at.speed, 109.557_68, 1e-5);
    check("rod, rad/s", at.throws[0].motion.rod_rate, -49.330_79, 1e-5);
    check(
        "gap speed, m/s",
        -nearest.penetration_rate,
        -0.841_612,
        1e-6,
    );
    assert!(nearest.penetration.abs() < 1e-9 * CLEARANCE);
    // Without friction and with the pin amidships the slider stays level.
    assert!(at.throws[0].joints.guide.position.y.abs() < 1e-15);
}
