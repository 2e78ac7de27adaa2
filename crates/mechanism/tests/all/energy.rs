//! The energy ledger over long runs: what gas and drive do, friction and damping take, and the
//! moving parts hold, must balance to 1e-7 of the energy turned over.

use crate::common;

use common::random::{MODELS, cases, machine, machine_with_effects};
use common::{REVOLUTION, Run, joint, single_stage, with_clearance};
use mechanism::drive::{Drive, Fluctuation, MotorLine};
use mechanism::joints::contact::{ContactLaw, Hertz, Impact, KelvinVoigt, Restitution};
use mechanism::joints::friction::{Adams, Ambrosio, FrictionLaw};
use mechanism::joints::guide::{Guide, GuideClearance};
use mechanism::joints::revolute::Revolute;
use mechanism::{Direction, Machine};
use proptest::prelude::*;

const TOLERANCE: f64 = 1e-9;

/// Runs `machine` and gives what the ledger misses, over the energy turned over.
fn imbalance(machine: Machine, revolutions: u32) -> f64 {
    let mut run = Run::start(machine, TOLERANCE, true);
    run.now();
    let start = run.dynamics.energy().total();
    let ledger = run.dynamics.layout().ledger.unwrap();
    let mut worst = 0.0_f64;
    for i in 1..=revolutions {
        // Off the dead centres, so that contacts are in any state when the books are closed.
        run.advance((f64::from(i) - 0.29) * REVOLUTION);
        run.now();
        let stored = run.dynamics.energy().total() - start;
        let works = &run.integrator.state()[ledger..ledger + 4];
        let missing = stored - works[0] - works[1] + works[2] + works[3];
        let turned_over: f64 = works.iter().map(|w| w.abs()).sum();
        worst = worst.max(missing.abs() / turned_over);
    }
    worst
}

fn check(name: &str, machine: Machine) {
    let worst = imbalance(machine, 50);
    eprintln!("{name:28} {worst:.1e}");
    assert!(worst < 1e-7, "{name}: {worst:e}");
}

fn clear_guide() -> Guide {
    let Revolute::Clear(pin) = joint(2e-4, 0.05, 2.4e10, 2e4) else {
        unreachable!()
    };
    Guide::Clear(GuideClearance {
        clearance: 2e-4,
        half_length: 0.12,
        half_height: 0.08,
        contact: pin.contact,
        friction: pin.friction,
    })
}

fn free(machine: &mut Machine) {
    machine.drive = Drive::Free(MotorLine {
        reference_speed: common::SPEED,
        mean_torque: 60.0,
        slope: 40.0,
    });
}

#[test]
fn both_ends_clear() {
    check("both ends", with_clearance(2e-4, 2e-4, 2e4));
    check("both ends, light", with_clearance(3e-4, 3e-4, 2e3));
}

#[test]
fn main_bearing_clear() {
    let mut machine = single_stage();
    machine.main = joint(2e-4, 0.06, 2.4e10, 2e4);
    machine.crankshaft.eccentricity = 0.02;
    check("main", machine);
}

#[test]
fn speed_fluctuating() {
    for main in [false, true] {
        let mut machine = with_clearance(2e-4, 2e-4, 2e4);
        if main {
            machine.main = joint(2e-4, 0.06, 2.4e10, 2e4);
            machine.crankshaft.eccentricity = 0.02;
        }
        let Drive::Given(given) = &mut machine.drive else {
            unreachable!()
        };
        given.fluctuation = vec![Fluctuation {
            amplitude: 0.02,
            phase: 0.7,
        }];
        check("fluctuating", machine);
    }
}

#[test]
fn guide_clear() {
    let mut machine = single_stage();
    machine.throws[0].guide = clear_guide();
    check("guide", machine);
}

fn all_clear() -> Machine {
    let mut machine = with_clearance(2e-4, 2e-4, 2e4);
    machine.main = joint(2e-4, 0.06, 2.4e10, 2e4);
    machine.throws[0].guide = clear_guide();
    machine
}

#[test]
fn all_four_clear() {
    check("all four", all_clear());
}

#[test]
fn all_four_clear_on_a_free_crank() {
    let mut machine = all_clear();
    machine.crankshaft.eccentricity = 0.02;
    free(&mut machine);
    check("all four, free crank", machine);
}

#[test]
fn two_opposed_throws_all_clear_on_a_free_crank() {
    let mut machine = all_clear();
    let mut second = machine.throws[0].clone();
    second.direction = Direction::Opposed;
    second.pin_angle = 2.6;
    machine.throws.push(second);
    free(&mut machine);
    check("two throws", machine);
}

#[test]
fn every_contact_law() {
    let family = Restitution {
        stiffness: 2e10,
        exponent: 1.5,
        restitution: 0.7,
        slowest_approach: 1e-3,
    };
    let laws = [
        (
            "impact, n = 1.8",
            ContactLaw::Impact(Impact {
                stiffness: 4e11,
                exponent: 1.8,
                damping: 1e4,
                depth: 2e-5,
            }),
        ),
        (
            "hertz",
            ContactLaw::Hertz(Hertz {
                stiffness: 2e10,
                exponent: 1.5,
            }),
        ),
        (
            "kelvin-voigt",
            ContactLaw::KelvinVoigt(KelvinVoigt {
                stiffness: 2e8,
                damping: 5e3,
            }),
        ),
        ("hunt-crossley", ContactLaw::HuntCrossley(family.clone())),
        (
            "lankarani-nikravesh",
            ContactLaw::LankaraniNikravesh(family.clone()),
        ),
        ("flores", ContactLaw::Flores(family)),
    ];
    for (name, law) in laws {
        let mut machine = with_clearance(2e-4, 2e-4, 2e4);
        let throw = &mut machine.throws[0];
        for end in [&mut throw.big_end, &mut throw.small_end] {
            if let Revolute::Clear(clear) = end {
                clear.contact = law.clone();
            }
        }
        check(name, machine);
    }
}

#[test]
fn every_friction_law() {
    let laws = [
        ("frictionless", FrictionLaw::none()),
        (
            "adams",
            FrictionLaw::Adams(Adams {
                static_coefficient: 0.08,
                dynamic_coefficient: 0.05,
                stiction_speed: 0.01,
                transition_speed: 0.05,
            }),
        ),
        (
            "ambrosio",
            FrictionLaw::Ambrosio(Ambrosio {
                coefficient: 0.05,
                slow: 0.005,
                fast: 0.05,
            }),
        ),
    ];
    for (name, law) in laws {
        let mut machine = with_clearance(2e-4, 2e-4, 2e4);
        let throw = &mut machine.throws[0];
        for end in [&mut throw.big_end, &mut throw.small_end] {
            if let Revolute::Clear(clear) = end {
                clear.friction = law.clone();
            }
        }
        check(name, machine);
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn any_machine(machine in machine(MODELS)) {
        let worst = imbalance(machine, 3);
        prop_assert!(worst < 1e-7, "{worst:e}");
    }
    #[test]
    fn any_machine_with_effects(machine in machine_with_effects(MODELS)) {
        let worst = imbalance(machine, 3);
        prop_assert!(worst < 1e-7, "{worst:e}");
    }
}
