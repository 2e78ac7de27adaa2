//! Tangents across single switches against differences of trajectories, one kind of switch at a
//! time.

use crate::common;

use common::{REVOLUTION, SPEED, with_clearance};
use integrate::{Integrator, System};
use mechanism::drive::{Drive, MotorLine};
use mechanism::joints::contact::{ContactLaw, KelvinVoigt, Restitution};
use mechanism::joints::friction::{Ambrosio, FrictionLaw};
use mechanism::joints::revolute::{JointModel, Revolute};
use mechanism::mode::{ContactMode, Mode};
use mechanism::{Dynamics, Machine, lift};
use scalar::{Dual, Scalar};
use std::collections::BTreeMap;

type Number = Dual<f64, 1>;
type Run = (Dynamics<Number>, Integrator<Number>);

/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-13;
/// Length of a look: short enough to hold one switch, s.
const LOOK: f64 = 2.5e-4;
/// Disturbance, in scales.
const WIDTH: f64 = 2e-5;
/// Looks at each kind of switch of each machine.
const ENOUGH: usize = 3;

/// The switches that tell two modes apart.
fn switches(a: &Mode<Number>, b: &Mode<Number>) -> Vec<&'static str> {
    let mut found = Vec::new();
    let mut compare = |name, a: Number, b: Number| {
        if a.value != b.value {
            found.push(name);
        }
    };
    let mut contact = |a: &ContactMode<Number>, b: &ContactMode<Number>| {
        let touch = ["parting", "touch"][usize::from(b.touching.value > 0.0)];
        compare(touch, a.touching, b.touching);
        if a.touching == b.touching {
            compare("release of a contact that would pull", a.pressed, b.pressed);
        }
        compare("kink of the contact law", a.deep, b.deep);
        compare("inner kink of friction", a.slipping[0], b.slipping[0]);
        compare("outer kink of friction", a.slipping[1], b.slipping[1]);
    };
    contact(&a.main, &b.main);
    for (a, b) in a.throws.iter().zip(&b.throws) {
        contact(&a.big_end, &b.big_end);
        contact(&a.small_end, &b.small_end);
    }
    // Where the crank turns back the gas follows.
    if a.turning.value != b.turning.value {
        compare("turning back", a.turning, b.turning);
        return found;
    }
    for (a, b) in a.throws.iter().zip(&b.throws) {
        // At a dead centre the valves follow.
        if a.outward == b.outward {
            compare("suction valve", a.head_end.suction, b.head_end.suction);
            compare(
                "discharge valve",
                a.head_end.discharge,
                b.head_end.discharge,
            );
        } else {
            compare("dead centre", a.outward, b.outward);
        }
    }
    found
}

/// Disturbs component `number` of the state by `parts` of its scale. What follows a rigid surface is
/// disturbed along it: turned about the bearing's centre, or sped up; its other two components are
/// not free.
fn disturb(dynamics: &Dynamics<Number>, y: &mut [Number], number: usize, parts: Number) {
    let throw = &dynamics.machine().throws[0];
    let following = dynamics.mode().throws[0].small_end.touching.value > 0.0
        && matches!(&throw.small_end, Revolute::Clear(c) if c.model == JointModel::TwoMode);
    let small = dynamics.layout().throws[0].small_end;
    match small.map(|first| (first, number.wrapping_sub(first))) {
        Some((first, component @ 0..4)) if following => {
            let (sine, cosine) = parts.sin_cos();
            let [ex, ey, vx, vy] = [0, 1, 2, 3].map(|i| y[first + i]);
            let turned = [
                cosine * ex - sine * ey,
                sine * ex + cosine * ey,
                cosine * vx - sine * vy,
                sine * vx + cosine * vy,
            ];
            match component {
                0 => y[first..first + 4].copy_from_slice(&turned),
                1 => y[first + 2..first + 4]
                    .iter_mut()
                    .for_each(|v| *v *= parts + 1.0),
                _ => {}
            }
        }
        _ => y[number] += parts * dynamics.scales()[number],
    }
}

/// The state at the end of a look that begins disturbed (by a value or a tangent); `None` where it
/// meets another number of switches.
fn state_after_look((dynamics, from): &Run, number: usize, parts: Number) -> Option<Vec<Number>> {
    let mut dynamics = dynamics.clone();
    let mut y = from.state().to_vec();
    disturb(&dynamics, &mut y, number, parts);
    let t = from.time();
    let mut run = Integrator::new(&mut dynamics, t, &y, TOLERANCE, 0.05 * REVOLUTION);
    run.advance(&mut dynamics, t + LOOK, |_, _| ()).unwrap();
    (run.work().switches == 1).then(|| run.state().to_vec())
}

/// How far the tangents over the look are from differences, over the longest of them; `None` where
/// a disturbed run does not meet the one switch alone.
fn error(run: &Run) -> Option<f64> {
    let scales = run.0.scales();
    let plain = |x: f64| Number {
        value: x,
        tangent: [0.0],
    };
    let (mut off, mut longest) = (0.0_f64, 0.0_f64);
    for number in 0..scales.len() {
        let tangent = state_after_look(run, number, Number::variable(0.0, 0))?;
        let difference = |h: f64| -> Option<Vec<f64>> {
            let (more, less) = (
                state_after_look(run, number, plain(h))?,
                state_after_look(run, number, plain(-h))?,
            );
            let pairs = more.iter().zip(&less);
            Some(
                pairs
                    .map(|(a, b)| (a.value - b.value) / (2.0 * h))
                    .collect(),
            )
        };
        // Extrapolated to no width (Richardson 1911).
        let (wide, narrow) = (difference(WIDTH)?, difference(0.5 * WIDTH)?);
        let pairs = wide.iter().zip(&narrow).zip(&tangent).zip(scales);
        for (((wide, narrow), tangent), scale) in pairs {
            let expected = (4.0 * narrow - wide) / 3.0;
            off = off.max(((tangent.tangent[0] - expected) / scale.value).abs());
            longest = longest.max((expected / scale.value).abs());
        }
    }
    Some(off / longest)
}

/// The largest error at each kind of switch over two revolutions of `machine`.
fn errors(machine: &Machine) -> BTreeMap<&'static str, Vec<f64>> {
    let mut dynamics = Dynamics::new(lift::constants(machine), false);
    let y = dynamics.initial_state();
    let mut run = Integrator::new(&mut dynamics, 0.0, &y, TOLERANCE, 0.05 * REVOLUTION);
    let mut errors = BTreeMap::<_, Vec<f64>>::new();
    while run.time() < 2.0 * REVOLUTION {
        let before = (dynamics.clone(), run.clone());
        run.advance(&mut dynamics, before.1.time() + LOOK, |_, _| ())
            .unwrap();
        if run.work().switches != before.1.work().switches + 1 {
            continue;
        }
        if let [switch] = switches(before.0.mode(), dynamics.mode())[..] {
            let seen = errors.entry(switch).or_default();
            if seen.len() < ENOUGH
                && let Some(error) = error(&before)
            {
                seen.push(error);
            }
        }
    }
    errors
}

fn check(name: &str, machine: &Machine, expected: &[&str]) {
    let errors = errors(machine);
    for (switch, seen) in &errors {
        eprintln!("{name:14} {switch:40} {seen:?}");
        assert!(seen.iter().all(|e| *e < 1e-6), "{name}, {switch}: {seen:?}");
    }
    for switch in expected {
        let seen = errors.get(switch).map_or(0, Vec::len);
        assert!(seen > 0, "{name}: {switch} was not seen alone");
    }
}

/// Both ends at 0.2 mm, with another small end.
fn machine(change: impl Fn(&mut mechanism::joints::revolute::Clearance)) -> Machine {
    let mut machine = with_clearance(2e-4, 2e-4, 2e4);
    if let Revolute::Clear(clear) = &mut machine.throws[0].small_end {
        change(clear);
    }
    machine
}

const GAS: [&str; 3] = ["dead centre", "suction valve", "discharge valve"];

#[test]
fn a_compliant_contact() {
    let switches = [
        "touch",
        "release of a contact that would pull",
        "kink of the contact law",
    ];
    check("impact", &machine(|_| ()), &[&switches[..], &GAS].concat());
}

#[test]
fn a_contact_whose_force_jumps() {
    let machine = machine(|clear| {
        clear.contact = ContactLaw::KelvinVoigt(KelvinVoigt {
            stiffness: 2e8,
            damping: 2e4,
        });
    });
    check("kelvin-voigt", &machine, &["touch"]);
}

#[test]
fn friction_with_kinks() {
    let machine = machine(|clear| {
        clear.friction = FrictionLaw::Ambrosio(Ambrosio {
            coefficient: 0.05,
            slow: 0.01,
            fast: 0.02,
        });
    });
    let switches = ["inner kink of friction", "outer kink of friction"];
    check("ambrosio", &machine, &switches);
}

#[test]
fn a_contact_that_remembers_its_approach() {
    let machine = machine(|clear| {
        clear.contact = ContactLaw::Flores(Restitution {
            stiffness: 2e10,
            exponent: 1.5,
            restitution: 0.6,
            slowest_approach: 1e-3,
        });
    });
    check("flores", &machine, &["touch", "parting"]);
}

#[test]
fn a_rigid_impact() {
    let machine = machine(|clear| clear.model = JointModel::TwoMode);
    check("two-mode", &machine, &["touch", "parting"]);
}

#[test]
fn a_free_crank() {
    let mut machine = machine(|_| ());
    machine.crankshaft.inertia = 1.0;
    machine.drive = Drive::Free(MotorLine {
        reference_speed: SPEED,
        mean_torque: 60.0,
        slope: 40.0,
    });
    check("free crank", &machine, &GAS);
}

#[test]
fn a_crank_that_turns_back() {
    let mut machine = machine(|_| ());
    machine.crankshaft.inertia = 0.2;
    machine.drive = Drive::Free(MotorLine {
        reference_speed: SPEED,
        // It brakes, so that the crank turns back within two revolutions.
        mean_torque: -100.0,
        slope: 0.0,
    });
    check("turning back", &machine, &["turning back"]);
}
