//! Effects on rod and crosshead.

use super::{
    DEAD, LENGTH, PD, PISTON, RADIUS, at_angles, distance, ideal, near, order, revolution, speed,
};
use crate::common::{REVOLUTION, Run, SPEED, single_stage, with_clearance};
use mechanism::effects::{EmpiricalForce, Law, Misalignment, RingFriction, RodFlexibility};
use mechanism::{Dynamics, Evaluation};
use std::f64::consts::{PI, TAU};

#[test]
fn ring_friction_is_a_square_wave_of_odd_orders() {
    let force = 120.0;
    let machine = ideal(Law::RingFriction(RingFriction {
        coulomb_force: force,
        per_pressure: 0.0,
        slip_speed: 1e-3,
        viscous: 0.0,
    }));
    let samples = at_angles(machine, &revolution(2000), |at| at.throws[0].gas.effects);
    for k in 1..=9 {
        let found = order(&samples, f64::from(k));
        // The piston goes away from the head, along −x, in the first half.
        let expected = if k % 2 == 1 {
            4.0 * force / (PI * f64::from(k))
        } else {
            0.0
        };
        assert!(
            (found[1] - expected).abs() < 0.01 * force,
            "order {k}: {found:?}"
        );
        assert!(found[0].abs() < 0.01 * force, "order {k}: {found:?}");
    }
}

#[test]
fn misalignment_has_once_to_three_times_the_speed_and_nothing_else() {
    for load_exponent in [0.0, 0.5, 1.0] {
        let machine = ideal(Law::Misalignment(Misalignment {
            first: 200.0,
            first_phase: 0.5,
            second: 70.0,
            second_phase: -1.0,
            third: 40.0,
            third_phase: 2.0,
            load_exponent,
        }));
        let load = (PD / 1e6).powf(load_exponent);
        let samples = at_angles(machine, &revolution(64), |at| at.throws[0].gas.effects);
        for k in 1..=6 {
            let (force, phase) = match k {
                1 => (200.0, 0.5_f64),
                2 => (70.0, -1.0),
                3 => (40.0, 2.0),
                _ => (0.0, 0.0),
            };
            let expected = [load * force * phase.cos(), -load * force * phase.sin()];
            let found = order(&samples, f64::from(k));
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
            assert!(off < 1e-9, "order {k}: {found:?}");
        }
    }
}

/// An empirical force without any term.
fn no_force() -> EmpiricalForce {
    EmpiricalForce {
        constant: 0.0,
        cosines: [0.0; 4],
        sines: [0.0; 4],
        displacement: [0.0; 2],
        velocity: [0.0; 3],
        friction: [0.0; 3],
        slip_speed: 0.05,
        acceleration: 0.0,
        gas_force: 0.0,
        offsets: [0.0; 2],
    }
}

#[test]
fn terms_of_an_empirical_force_are_what_they_say() {
    const BAR: f64 = 1e5;
    let degrees = revolution(48);
    let check = |force: EmpiricalForce, expected: &dyn Fn(f64, &Evaluation<f64>) -> f64| {
        let machine = ideal(Law::EmpiricalForce(force));
        let found = at_angles(machine, &degrees, |at| {
            (at.throws[0].gas.effects, at.clone())
        });
        for (degrees, (found, at)) in degrees.iter().zip(found) {
            let expected = expected(degrees.to_radians(), &at);
            let off = (found - expected).abs();
            assert!(
                off < 1e-8 * expected.abs() + 1e-9,
                "{degrees}: {found} {expected}"
            );
        }
    };
    let plain = no_force();
    let (cosines, sines) = ([10.0, -20.0, 30.0, 40.0], [5.0, 6.0, -7.0, 8.0]);
    let harmonics = EmpiricalForce {
        constant: 3.0,
        cosines,
        sines,
        ..plain.clone()
    };
    check(harmonics, &|angle, _| {
        let orders = (1..=4).map(f64::from).zip(cosines.iter().zip(&sines));
        orders.fold(3.0, |sum, (k, (a, b))| {
            sum + a * (k * angle).cos() + b * (k * angle).sin()
        })
    });
    let spring = EmpiricalForce {
        displacement: [50.0, 20.0],
        ..plain.clone()
    };
    check(spring, &|angle, _| {
        let x = (RADIUS + DEAD - distance(angle)) / RADIUS;
        50.0 * x + 20.0 * x * x * x
    });
    // The velocity along x, toward the head, in m/s.
    let v = |angle: f64| -speed(angle) * RADIUS * SPEED;
    let damper = EmpiricalForce {
        velocity: [-30.0, -4.0, 0.5],
        ..plain.clone()
    };
    check(damper, &|angle, _| {
        let v = v(angle);
        -30.0 * v - 4.0 * v * v.abs() + 0.5 * v * v * v
    });
    let inertia = EmpiricalForce {
        acceleration: 9.80665,
        ..plain.clone()
    };
    check(inertia, &|_, at| at.throws[0].accelerations.crosshead);
    let area = PI * PISTON * PISTON;
    let gas = EmpiricalForce {
        gas_force: area * BAR,
        ..plain.clone()
    };
    check(gas, &|_, at| at.throws[0].gas.force);
    let guide = EmpiricalForce {
        friction: [0.0, 0.0, -0.05 * area * BAR],
        ..plain.clone()
    };
    check(guide, &|angle, at| {
        let (sine, v) = (RADIUS / LENGTH * angle.sin(), v(angle));
        let side = at.throws[0].gas.force * sine / (1.0 - sine * sine).sqrt();
        -0.05 * side.abs() * v / v.hypot(0.05)
    });
    let joints = EmpiricalForce {
        offsets: [100.0, 50.0],
        ..plain
    };
    check(joints.clone(), &|_, _| 0.0);
    // With both ends clear the journals' offsets count.
    let mut machine = with_clearance(2e-4, 1e-4, 2e4);
    machine.effects = vec![Law::EmpiricalForce(joints).everywhere()];
    let at = at_angles(machine, &[100.0], Evaluation::clone).remove(0);
    let throw = &at.throws[0];
    let [big, small] = [&throw.joints.big_end, &throw.joints.small_end].map(|j| j.offset.x);
    near(
        throw.gas.effects,
        100.0 * big / 2e-4 + 50.0 * small / 1e-4,
        1e-12,
    );
}

#[test]
fn oil_adds_a_friction_that_grows_with_the_speed() {
    let degrees = [70.0, 250.0];
    let force = |viscous: f64| {
        let machine = ideal(Law::RingFriction(RingFriction {
            coulomb_force: 120.0,
            per_pressure: 0.0,
            slip_speed: 1e-3,
            viscous,
        }));
        at_angles(machine, &degrees, |at| at.throws[0].gas.effects)
    };
    let both = force(0.0).into_iter().zip(force(15.0)).zip(degrees);
    for ((dry, oiled), degrees) in both {
        // Toward the head, against a motion away from it.
        let away = RADIUS * SPEED * speed(degrees.to_radians());
        near(oiled - dry, 15.0 * away, 1e-6);
    }
}

#[test]
fn ring_friction_is_a_special_empirical_force() {
    let rings = Law::RingFriction(RingFriction {
        coulomb_force: 120.0,
        per_pressure: 2e-4,
        slip_speed: 0.02,
        viscous: 0.0,
    });
    let force = Law::EmpiricalForce(EmpiricalForce {
        friction: [-120.0, -20.0, 0.0],
        slip_speed: 0.02,
        ..no_force()
    });
    let lost = |law: Law| {
        let mut run = Run::start(ideal(law), 1e-11, true);
        let ledger = run.dynamics.layout().ledger.unwrap();
        run.advance(REVOLUTION);
        run.integrator.state()[ledger..ledger + 4].to_vec()
    };
    let [rings, force] = [rings, force].map(lost);
    // Gas, drive, friction, damping. 120 N over 0.48 m, and something more with the pressure.
    for (a, b) in rings.iter().zip(&force) {
        assert!((a - b).abs() < 1e-7 * a.abs() + 1e-9, "{a} {b}");
    }
    assert!((58.0..90.0).contains(&force[2]), "{}", force[2]);
}

#[test]
fn an_elastic_rod_swings_with_the_crosshead_at_its_natural_frequency() {
    let compliance = 4e-9;
    let mut machine = ideal(Law::RodFlexibility(RodFlexibility {
        compliance,
        damping_ratio: 0.0,
        hardening: 0.0,
    }));
    // So slow and with so little gas that nothing but the spring counts.
    machine.throws[0].cylinder.piston_radius = 1e-5;
    if let mechanism::drive::Drive::Given(given) = &mut machine.drive {
        given.speed = 1e-3;
    }
    let mut dynamics = Dynamics::new(machine, false);
    let rod = dynamics.layout().throws[0].rod.unwrap();
    let mut rate = |stretch: f64| {
        let mut y = dynamics.initial_state();
        let mut dy = y.clone();
        y[rod] = stretch;
        integrate::System::derivative(&mut dynamics, 0.0, &y, &mut dy);
        dy[rod + 1]
    };
    let square = -(rate(1e-7) - rate(-1e-7)) / 2e-7;
    // I + M a² + m L², with the values of the single-stage machine.
    let inertia = 0.6 + 12.0 * 0.22 * 0.22 + 18.0 * LENGTH * LENGTH;
    near(square, LENGTH * LENGTH / compliance / inertia, 1e-6);
    // 18 kg and a bit on 250 MN/m: some 550 Hz.
    assert!((500.0..600.0).contains(&(square.sqrt() / TAU)));
}

#[test]
fn a_rod_that_hardens_has_the_force_and_energy_of_its_law() {
    let (compliance, hardening) = (4e-9, 1.5);
    let at = |hardening: f64, stretch: f64| {
        let mut machine = ideal(Law::RodFlexibility(RodFlexibility {
            compliance,
            damping_ratio: 0.0,
            hardening,
        }));
        machine.throws[0].cylinder.piston_radius = 1e-5;
        if let mechanism::drive::Drive::Given(given) = &mut machine.drive {
            given.speed = 1e-3;
        }
        let mut dynamics = Dynamics::new(machine, false);
        let rod = dynamics.layout().throws[0].rod.unwrap();
        let mut y = dynamics.initial_state();
        let mut dy = y.clone();
        y[rod] = stretch;
        integrate::System::derivative(&mut dynamics, 0.0, &y, &mut dy);
        [dy[rod + 1], dynamics.energy().elastic]
    };
    for stretch in [5e-5, -2e-4] {
        let free = at(0.0, 0.0)[0];
        let [[linear, soft], [harder, stored]] = [at(0.0, stretch), at(hardening, stretch)];
        let square = (stretch / 1e-4_f64).powi(2);
        near(
            (harder - free) / (linear - free),
            1.0 + hardening * square,
            1e-4,
        );
        near(soft, 0.5 * (stretch * LENGTH).powi(2) / compliance, 1e-9);
        near(stored / soft, 1.0 + 0.5 * hardening * square, 1e-9);
    }
}

#[test]
fn a_stiff_rod_is_a_rigid_one() {
    let elastic = ideal(Law::RodFlexibility(RodFlexibility {
        compliance: 1e-11,
        damping_ratio: 1.0,
        hardening: 0.0,
    }));
    let crosshead = |at: &Evaluation<f64>| at.throws[0].accelerations.crosshead;
    let angles = [400.0, 500.0, 600.0];
    let rigid = at_angles(single_stage(), &angles, crosshead);
    for (found, rigid) in at_angles(elastic, &angles, crosshead)
        .into_iter()
        .zip(rigid)
    {
        near(found, rigid, 1e-3);
    }
}
