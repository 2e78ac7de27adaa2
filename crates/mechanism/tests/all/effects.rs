//! Each effect of the catalogue against what its law says in closed form, or by quadrature.

use crate::common;

use common::{REVOLUTION, Run, SPEED, single_stage, with_clearance};
use mechanism::effects::{
    BearingOvality, Effect, EmpiricalForce, End, GasPulsation, HeatTransfer, Joint, Law,
    Misalignment, Oval, Place, RingFriction, RingLeakage, RodFlexibility, RotatingUnbalance,
    Shaken, SqueezeFilm, SuctionUnloading, ValveFlutter, ValveLeakage, ValveLoss,
};
use mechanism::frame::Frame;
use mechanism::gas::CrankEnd;
use mechanism::{Dynamics, Evaluation, Machine};
use std::f64::consts::{PI, TAU};

const PS: f64 = 0.105e6;
const PD: f64 = 0.393e6;
const M: f64 = 1.4;
const DEAD: f64 = 0.024;
const STROKE: f64 = 0.24;
const RADIUS: f64 = 0.12;
const LENGTH: f64 = 0.6;
const PISTON: f64 = 0.05;

/// The ideal single-stage machine with an effect.
fn ideal(law: Law) -> Machine {
    Machine {
        effects: vec![law.everywhere()],
        ..single_stage()
    }
}

/// What `look` finds at crank angles (degrees) that follow each other from the start on.
fn at_angles<T>(
    machine: Machine,
    degrees: &[f64],
    mut look: impl FnMut(&Evaluation<f64>) -> T,
) -> Vec<T> {
    let mut run = Run::start(machine, 1e-11, true);
    let each = degrees.iter().map(|degrees| {
        run.advance(degrees / 360.0 * REVOLUTION);
        look(run.now())
    });
    each.collect()
}

fn pressure(at: &Evaluation<f64>) -> f64 {
    at.throws[0].gas.head_end.pressure
}

/// Distance of the ideal piston from the head, m.
fn distance(angle: f64) -> f64 {
    let rod = (LENGTH * LENGTH - (RADIUS * angle.sin()).powi(2)).sqrt();
    DEAD + RADIUS + LENGTH - RADIUS * angle.cos() - rod
}

/// Speed of the ideal piston away from the head, over the crank pin's.
fn speed(angle: f64) -> f64 {
    let ratio = RADIUS / LENGTH;
    let rod = (1.0 - (ratio * angle.sin()).powi(2)).sqrt();
    angle.sin() + ratio * angle.sin() * angle.cos() / rod
}

fn near(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{found} against {expected}, {off:.1e}");
}

/// Cosine and sine part of order `k` of samples over one revolution.
fn order(samples: &[f64], k: f64) -> [f64; 2] {
    let n = samples.len() as f64;
    let mut parts = [0.0; 2];
    for (i, x) in samples.iter().enumerate() {
        let (sine, cosine) = (TAU * k * i as f64 / n).sin_cos();
        parts[0] += 2.0 / n * x * cosine;
        parts[1] += 2.0 / n * x * sine;
    }
    parts
}

fn size(parts: [f64; 2]) -> f64 {
    parts[0].hypot(parts[1])
}

/// Angles of the second revolution, degrees.
fn revolution(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| 360.0 + 360.0 * i as f64 / count as f64)
        .collect()
}

#[test]
fn valve_loss_lifts_the_plateaus_by_the_square_of_the_speed_and_costs_its_work() {
    let (suction, discharge) = (0.18, 0.15);
    let machine = ideal(Law::ValveLoss(ValveLoss {
        suction,
        discharge,
        suction_linear: 0.0,
        discharge_linear: 0.0,
    }));
    let found = at_angles(machine.clone(), &[100.0, 310.0], pressure);
    let u = [100.0, 310.0].map(|degrees: f64| speed(degrees.to_radians()));
    near(found[0], PS * (1.0 - suction * u[0] * u[0]), 1e-12);
    near(found[1], PD * (1.0 + discharge * u[1] * u[1]), 1e-12);

    // The work of a revolution, from the law as a limit on the polytropes.
    let area = PI * PISTON * PISTON;
    let work = |loss: [f64; 2]| {
        let count = 200_000;
        let step = TAU / f64::from(count);
        let mut work = 0.0;
        for i in 0..count {
            let angle = (f64::from(i) + 0.5) * step;
            let u = speed(angle);
            let line = [PS * (1.0 - loss[0] * u * u), PD * (1.0 + loss[1] * u * u)];
            let closed = if angle < PI {
                PD * (DEAD / distance(angle)).powf(M)
            } else {
                PS * ((STROKE + DEAD) / distance(angle)).powf(M)
            };
            let p = if angle < PI {
                closed.max(line[0])
            } else {
                closed.min(line[1])
            };
            work += p * area * u * RADIUS * step;
        }
        work
    };
    let gas_work = |machine: Machine| {
        let mut run = Run::start(machine, 1e-11, true);
        let ledger = run.dynamics.layout().ledger.unwrap();
        run.advance(2.0 * REVOLUTION);
        run.integrator.state()[ledger] / 2.0
    };
    near(gas_work(machine), work([suction, discharge]), 1e-7);
    near(gas_work(single_stage()), work([0.0; 2]), 1e-7);
}

#[test]
fn an_unloaded_cylinder_compresses_what_is_left_and_expands_what_it_reached() {
    let held = 70_f64.to_radians();
    let law = |held, loss| Law::SuctionUnloading(SuctionUnloading { held, loss });
    let found = at_angles(ideal(law(held, 0.0)), &[240.0, 260.0, 275.0], pressure);
    let from = distance(PI + held);
    near(found[0], PS, 1e-12);
    for (found, degrees) in found[1..].iter().zip([260.0_f64, 275.0]) {
        let closed = PS * (from / distance(degrees.to_radians())).powf(M);
        near(*found, closed, 1e-12);
    }
    // A held valve throttles the gas on its way in and on its way back, and then closes later.
    let loss = 0.1;
    let found = at_angles(ideal(law(held, loss)), &[90.0, 240.0, 275.0], pressure);
    for (found, degrees) in found[..2].iter().zip([90.0_f64, 240.0]) {
        let u = speed(degrees.to_radians());
        near(*found, PS * (1.0 - loss * u * u.abs()), 1e-12);
    }
    let closed = PS * (from / distance(275_f64.to_radians())).powf(M);
    near(found[2], closed, 1e-12);
    // Held so long that the compression ends below the discharge pressure.
    let held = 140_f64.to_radians();
    let found = at_angles(ideal(law(held, 0.0)), &[350.0, 365.0], pressure);
    let reached = PS * (distance(PI + held) / DEAD).powf(M);
    assert!(reached < PD);
    let compressed = PS * (distance(PI + held) / distance(350_f64.to_radians())).powf(M);
    near(found[0], compressed, 1e-12);
    let expanded = reached * (DEAD / distance(5_f64.to_radians())).powf(M);
    near(found[1], expanded, 1e-9);
}

#[test]
fn one_end_of_a_cylinder_can_be_unloaded_alone() {
    let mut machine = single_stage();
    machine.throws[0].cylinder.crank_end = Some(CrankEnd {
        rod_radius: 0.02,
        clearance: 0.03,
    });
    let held = 60_f64.to_radians();
    machine.effects = vec![Effect {
        law: Law::SuctionUnloading(SuctionUnloading { held, loss: 0.0 }),
        place: Place {
            end: Some(End::Crank),
            ..Place::default()
        },
    }];
    let found = at_angles(machine, &[240.0, 410.0, 430.0], |at| {
        let gas = &at.throws[0].gas;
        [gas.head_end.pressure, gas.crank_end.pressure]
    });
    near(
        found[0][0],
        PS * ((STROKE + DEAD) / distance(240_f64.to_radians())).powf(M),
        1e-12,
    );
    near(found[1][1], PS, 1e-12);
    // The crank end's cover is as far as the head is near.
    let to_cover = |degrees: f64| 0.03 + STROKE + DEAD - distance(degrees.to_radians());
    near(
        found[2][1],
        PS * (to_cover(60.0) / to_cover(70.0)).powf(M),
        1e-12,
    );
}

/// The logarithm of the pressure in a compression up to `end` (rad), by the classical Runge-Kutta method over
/// the crank angle; where it would fall below the suction line, the valve is open.
fn compressed(end: f64, drift: impl Fn(f64, f64) -> f64) -> f64 {
    let slope = |angle: f64, log: f64| {
        let volume = speed(angle) * RADIUS / distance(angle);
        -M * volume + drift(distance(angle), log.exp()) / SPEED
    };
    let (mut log, count) = (PS.ln(), 4000);
    let h = (end - PI) / f64::from(count);
    for i in 0..count {
        let angle = PI + f64::from(i) * h;
        let a = slope(angle, log);
        let b = slope(angle + h / 2.0, log + h / 2.0 * a);
        let c = slope(angle + h / 2.0, log + h / 2.0 * b);
        let d = slope(angle + h, log + h * c);
        log = (log + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)).max(PS.ln());
    }
    log
}

#[test]
fn leaking_rings_let_the_pressure_fall_by_stodola_s_ellipse() {
    let (area, gas_speed) = (8e-6, 290.0);
    let mut machine = ideal(Law::RingLeakage(RingLeakage { area, gas_speed }));
    let end = 270_f64.to_radians();
    // Against vacuum the flow is proportional to the pressure alone.
    let face = PI * PISTON * PISTON;
    let vacuum = compressed(end, |x, _| -M * area * gas_speed / (face * x));
    near(
        at_angles(machine.clone(), &[270.0], pressure)[0],
        vacuum.exp(),
        2e-5,
    );
    let tight = PS * ((STROKE + DEAD) / distance(end)).powf(M);
    assert!(vacuum.exp() < 0.97 * tight);
    // Against pressure, away from the dead centre where it flows the other way.
    machine.throws[0].cylinder.back = 0.2e6;
    let against = compressed(end, |x, p| {
        let d = p * p - 0.2e6 * 0.2e6;
        let floor = (0.02 * PS).powi(2);
        -M * area * gas_speed * d / (d * d + floor * floor).powf(0.25) / (p * face * x)
    });
    near(
        at_angles(machine, &[270.0], pressure)[0],
        against.exp(),
        1e-7,
    );
    assert!(against > vacuum);
}

#[test]
fn a_valve_that_leaks_lets_gas_to_its_line_by_stodola_s_ellipse() {
    let end = 270_f64.to_radians();
    let face = PI * PISTON * PISTON;
    let flow = |area: f64, p: f64, line: f64| {
        let d = p * p - line * line;
        let floor = (0.02 * PS).powi(2);
        area * 290.0 * d / (d * d + floor * floor).powf(0.25)
    };
    let tight = PS * ((STROKE + DEAD) / distance(end)).powf(M);
    for ([suction, discharge], falls) in [([8e-6, 0.0], true), ([0.0, 8e-6], false)] {
        let law = ValveLeakage {
            suction,
            discharge,
            gas_speed: 290.0,
        };
        let found = at_angles(ideal(Law::ValveLeakage(law)), &[270.0], pressure)[0];
        let expected = compressed(end, |x, p| {
            -M * (flow(suction, p, PS) + flow(discharge, p, PD)) / (p * face * x)
        });
        near(found, expected.exp(), 2e-5);
        assert_eq!(found < 0.99 * tight, falls);
        assert_eq!(found > 1.01 * tight, !falls);
    }
}

/// Where leaking gas is faster than the piston the valve stands open: after the dead centre, and long after it
/// where much leaks.
#[test]
fn the_valve_stays_open_until_the_piston_is_faster_than_the_leak() {
    for (area, degrees) in [(8e-6, 3.0), (4e-5, 15.0)] {
        let machine = ideal(Law::RingLeakage(RingLeakage {
            area,
            gas_speed: 290.0,
        }));
        let leak = M * area * 290.0 / (PI * PISTON * PISTON * SPEED);
        let rate = |degrees: f64| {
            let angle = f64::to_radians(180.0 + degrees);
            (-M * speed(angle) * RADIUS - leak) / distance(angle)
        };
        assert!(rate(degrees) < 0.0 && rate(degrees * 2.0) > 0.0);
        let angles: Vec<f64> = [0.2, 0.5, 1.0].map(|part| 180.0 + part * degrees).into();
        for found in at_angles(machine.clone(), &angles, pressure) {
            near(found, PS, 1e-12);
        }
        let end = f64::to_radians(240.0);
        let expected = compressed(end, |x, _| -M * area * 290.0 / (PI * PISTON * PISTON * x));
        near(
            at_angles(machine, &[240.0], pressure)[0],
            expected.exp(),
            5e-5,
        );
    }
}

#[test]
fn heat_follows_newton_and_much_of_it_keeps_the_gas_as_warm_as_the_walls() {
    let (stanton, wall) = (0.02, 1.2);
    let law = |stanton| {
        Law::HeatTransfer(HeatTransfer {
            stanton,
            wall_temperature: wall,
        })
    };
    let end = 270_f64.to_radians();
    let mean = 2.0 * RADIUS * SPEED / PI;
    let expected = compressed(end, |x, p| {
        let warmth = p * x / (PS * (STROKE + DEAD));
        M * stanton * mean * (2.0 / x + 2.0 / PISTON) * (wall / warmth - 1.0)
    });
    near(
        at_angles(ideal(law(stanton)), &[270.0], pressure)[0],
        expected.exp(),
        1e-7,
    );
    let isothermal = PS * wall * (STROKE + DEAD) / distance(end);
    near(
        at_angles(ideal(law(40.0)), &[270.0], pressure)[0],
        isothermal,
        2e-3,
    );
}

/// At the end of a stroke a clearance lets the piston go beyond its ideal dead centre, or fall short of it.
#[test]
fn a_trace_of_heat_changes_nothing_where_a_clearance_moves_the_dead_centre() {
    let trace = Law::HeatTransfer(HeatTransfer {
        stanton: 1e-12,
        wall_temperature: 1.2,
    });
    let plain = with_clearance(0.3e-3, 0.3e-3, 2e4);
    let warmed = Machine {
        effects: vec![trace.everywhere()],
        ..plain.clone()
    };
    let angles = [190.0, 270.0, 350.0, 365.0, 390.0, 560.0, 750.0];
    let [plain, warmed] = [plain, warmed].map(|machine| at_angles(machine, &angles, pressure));
    for (plain, warmed) in plain.into_iter().zip(warmed) {
        near(warmed, plain, 1e-8);
    }
}

#[test]
fn pulsation_swings_with_its_order_and_the_strokes_start_from_it() {
    let pulsation = GasPulsation {
        order: 3.0,
        suction: 0.04,
        suction_phase: 0.3,
        discharge: 0.06,
        discharge_phase: 1.0,
    };
    let machine = ideal(Law::GasPulsation(pulsation));
    let found = at_angles(machine, &[120.0, 250.0, 320.0], pressure);
    let angle = |degrees: f64| degrees.to_radians();
    let suction = |degrees: f64| PS * (1.0 + 0.04 * (3.0 * angle(degrees) + 0.3).cos());
    near(found[0], suction(120.0), 1e-12);
    let closed = suction(180.0) * ((STROKE + DEAD) / distance(angle(250.0))).powf(M);
    near(found[1], closed, 1e-12);
    near(
        found[2],
        PD * (1.0 + 0.06 * (3.0 * angle(320.0) + 1.0).cos()),
        1e-12,
    );
}

#[test]
fn valves_that_flutter_open_late_and_ring() {
    let (frequency, damping, suction, discharge) = (TAU * 300.0, 0.05, 0.04, 0.06);
    let mut machine = ideal(Law::ValveFlutter(ValveFlutter {
        natural_frequency: frequency,
        damping_ratio: damping,
        suction,
        discharge,
    }));
    machine.throws[0].cylinder.crank_end = Some(CrankEnd {
        rod_radius: 0.02,
        clearance: DEAD,
    });
    // The distance from the crank-end cover, and where in a stroke a distance is passed.
    let to_cover = |angle: f64| 2.0 * DEAD + STROKE - distance(angle);
    let passed = |distance: &dyn Fn(f64) -> f64, wanted: f64, stroke: f64| {
        let (mut low, mut high) = (stroke, stroke + PI);
        let growing = distance(high) > distance(low);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match (distance(middle) < wanted) == growing {
                true => low = middle,
                false => high = middle,
            }
        }
        low
    };
    let ratio = (PD / PS).powf(1.0 / M);
    let expanded = DEAD * ratio / (1.0 - suction).powf(1.0 / M);
    let compressed = (STROKE + DEAD) / ratio / (1.0 + discharge).powf(1.0 / M);
    let swing = |degrees: f64, opened: f64| {
        let t = (degrees.to_radians() - opened) / SPEED;
        let slower = (1.0 - damping * damping).sqrt();
        let (sine, cosine) = (slower * frequency * t).sin_cos();
        (-damping * frequency * t).exp() * (cosine + damping / slower * sine)
    };
    let ends = |at: &Evaluation<f64>| {
        let gas = &at.throws[0].gas;
        [gas.head_end.pressure, gas.crank_end.pressure]
    };
    let [head, crank]: [&dyn Fn(f64) -> f64; 2] = [&distance, &to_cover];
    let late = passed(head, compressed, PI).to_degrees() - 0.5;
    let degrees = [100.0, 150.0, 240.0, late, 340.0];
    let found = at_angles(machine, &degrees, ends);
    near(
        found[0][0],
        PS * (1.0 - suction * swing(100.0, passed(head, expanded, 0.0))),
        1e-9,
    );
    near(
        found[4][0],
        PD * (1.0 + discharge * swing(340.0, passed(head, compressed, PI))),
        1e-9,
    );
    near(
        found[1][1],
        PD * (1.0 + discharge * swing(150.0, passed(crank, compressed, 0.0))),
        1e-9,
    );
    near(
        found[2][1],
        PS * (1.0 - suction * swing(240.0, passed(crank, expanded, PI))),
        1e-9,
    );
    // Until the plate lets go the gas goes on along its polytrope, from what the swing left at the dead centre.
    let left = PS * (1.0 - suction * swing(180.0, passed(head, expanded, 0.0)));
    let polytrope = left * ((STROKE + DEAD) / distance(late.to_radians())).powf(M);
    near(found[3][0], polytrope, 1e-9);
    assert!(polytrope > 1.03 * PD, "{polytrope}");
}

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
fn a_spring_loaded_plate_adds_a_loss_that_grows_with_the_speed() {
    let losses = |suction_linear: f64, discharge_linear: f64| {
        let machine = ideal(Law::ValveLoss(ValveLoss {
            suction: 0.1,
            discharge: 0.1,
            suction_linear,
            discharge_linear,
        }));
        at_angles(machine, &[100.0, 310.0], pressure)
    };
    let (square, both) = (losses(0.0, 0.0), losses(0.05, 0.04));
    let u = [100.0, 310.0].map(|degrees: f64| speed(degrees.to_radians()));
    near(square[0] - both[0], PS * 0.05 * u[0], 1e-6);
    near(square[1] - both[1], PD * 0.04 * u[1], 1e-6);
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
fn an_unbalance_shakes_the_sensor_once_a_revolution_with_the_square_of_the_speed() {
    let unbalance = |body| {
        Law::RotatingUnbalance(RotatingUnbalance {
            eccentricity: 5e-4,
            phase: 0.8,
            body,
        })
    };
    let felt = |machine: Machine| {
        at_angles(machine, &revolution(64), |at| {
            at.throws[0].accelerations.crosshead + at.throws[0].carried.x
        })
    };
    let quiet = felt(single_stage());
    let shaken = felt(ideal(unbalance(Shaken::Frame)));
    let more: Vec<f64> = shaken.iter().zip(&quiet).map(|(a, b)| a - b).collect();
    let found = order(&more, 1.0);
    let expected = 5e-4 * SPEED * SPEED;
    near(found[0], expected * 0.8_f64.cos(), 1e-9);
    near(found[1], -expected * 0.8_f64.sin(), 1e-9);
    assert!((2..9).all(|k| size(order(&more, f64::from(k))) < 1e-9));
    // With the crosshead loose in the rod, it keeps its own way and the sensor reads that.
    let force = at_angles(ideal(unbalance(Shaken::Crosshead)), &revolution(64), |at| {
        at.throws[0].gas.effects
    });
    near(size(order(&force, 1.0)), expected * 18.0, 1e-9);
}

#[test]
fn a_shaken_frame_feels_like_gravity_to_what_flies_free() {
    // With both ends apart nothing but weight and gas acts on the bodies: seen from the ground the
    // crosshead does not notice the frame.
    let free = |effects: Vec<Effect>| {
        let mut machine = with_clearance(2e-4, 2e-4, 2e4);
        machine.effects = effects;
        let mut dynamics = Dynamics::new(machine, false);
        let y = dynamics.initial_state();
        let at = dynamics.evaluate(0.01, &y);
        at.throws[0].accelerations.crosshead + at.throws[0].carried.x
    };
    let unbalance = Law::RotatingUnbalance(RotatingUnbalance {
        eccentricity: 1e-3,
        phase: 0.3,
        body: Shaken::Frame,
    });
    near(free(vec![unbalance.everywhere()]), free(Vec::new()), 1e-12);
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

#[test]
fn a_film_pushes_back_as_ocvirk_s() {
    let (viscosity, length, clearance) = (0.03, 3e-3, 2e-4);
    let force = |effects: Vec<Effect>, rate: f64| {
        let mut machine = with_clearance(0.0, clearance, 2e4);
        machine.effects = effects;
        let mut dynamics = Dynamics::new(machine, false);
        let i = dynamics.layout().throws[0].small_end.unwrap();
        let mut y = dynamics.initial_state();
        y[i] = 0.5 * clearance;
        y[i + 2] = rate;
        dynamics.evaluate(0.0, &y).throws[0].joints.small_end.force
    };
    let film = |joint| Effect {
        law: Law::SqueezeFilm(SqueezeFilm {
            viscosity,
            length,
            roughness: 1e-6,
            separation: 1.0,
            long: 0.0,
        }),
        place: Place {
            joint: Some(joint),
            ..Place::default()
        },
    };
    let still = PI * viscosity * 0.035 * length.powi(3) / clearance.powi(3);
    for rate in [0.1, -0.1] {
        let found = force(vec![film(Joint::SmallEnd)], rate);
        near(found.x, -still * 1.5 / 0.75_f64.powf(2.5) * rate, 1e-9);
        assert!(found.y.abs() < 1e-12);
    }
    assert_eq!(force(vec![film(Joint::BigEnd)], 0.1).norm(), 0.0);
    // The film of a long bearing.
    let mut long = film(Joint::SmallEnd);
    if let Law::SqueezeFilm(film) = &mut long.law {
        film.long = 1.0;
    }
    near(
        force(vec![long], 0.1).x,
        -still / 0.75_f64.powf(1.5) * 0.1,
        1e-9,
    );
    // Where the metal touches the film is as thick as the roughness, however deep the journal goes.
    let resists = |effects: Vec<Effect>, depth: f64| {
        let mut machine = with_clearance(0.0, clearance, 2e4);
        machine.effects = effects;
        let mut dynamics = Dynamics::new(machine, false);
        let i = dynamics.layout().throws[0].small_end.unwrap();
        let mut y = dynamics.initial_state();
        (y[i], y[i + 2]) = (depth * clearance, 0.1);
        dynamics.evaluate(0.0, &y).throws[0]
            .joints
            .small_end
            .force
            .x
    };
    let mut rough = film(Joint::SmallEnd);
    if let Law::SqueezeFilm(film) = &mut rough.law {
        film.roughness = 0.1;
    }
    for depth in [1.05_f64, 1.3] {
        let found = resists(vec![rough.clone()], depth) - resists(Vec::new(), depth);
        let square = depth * depth;
        let deeper = square - 1.0 + 0.1;
        let thin: f64 = 0.1 + 0.5 * (f64::hypot(deeper, 0.02) - deeper);
        near(
            found,
            -still * (1.0 + 2.0 * square) / thin.powf(2.5) * 0.1,
            1e-7,
        );
        assert!((thin - 0.1).abs() < 1e-3);
    }
    // A film that cannot pull resists the approach alone; one that half can pulls half as much. It tears over 1 mm/s.
    for separation in [0.0, 0.5] {
        let mut weak = film(Joint::SmallEnd);
        if let Law::SqueezeFilm(film) = &mut weak.law {
            film.separation = separation;
        }
        for rate in [0.1, 1e-3, -1e-3, -0.1] {
            let whole = force(vec![film(Joint::SmallEnd)], rate).x;
            let found = force(vec![weak.clone()], rate).x / whole;
            let away = 0.5 * (1.0 - rate / f64::hypot(rate, 1e-3));
            let share = 1.0 - away * (1.0 - separation);
            assert!((found - share).abs() < 1e-9, "{rate}: {found}");
        }
    }
}

#[test]
fn an_oval_bearing_is_wider_along_its_long_axis() {
    let (clearance, amplitude, direction) = (2e-4, 5e-5, 0.4);
    let (lobes, lobes_direction) = (1e-5, 1.1);
    let mut machine = with_clearance(0.0, clearance, 2e4);
    machine.effects = vec![Effect {
        law: Law::BearingOvality(BearingOvality {
            amplitude,
            direction,
            oval: Oval::Bearing,
            lobes,
            lobes_direction,
        }),
        place: Place {
            joint: Some(Joint::SmallEnd),
            ..Place::default()
        },
    }];
    let mut dynamics = Dynamics::new(machine, false);
    let i = dynamics.layout().throws[0].small_end.unwrap();
    let mut penetration = |angle: f64| {
        let mut y = dynamics.initial_state();
        y[i] = clearance * angle.cos();
        y[i + 1] = clearance * angle.sin();
        // At top dead centre the rod lies along x, but for the offset.
        let part = dynamics.evaluate(0.0, &y).throws[0];
        (
            part.joints.small_end.penetration,
            part.motion.rod_sin_cos.0.asin(),
        )
    };
    for (angle, wider) in [(0.0, 1.0), (PI / 2.0, -1.0), (PI, 1.0), (PI / 4.0, 0.0)] {
        let (found, rod) = penetration(direction + angle);
        let turned = amplitude * (2.0 * (angle - rod)).cos();
        let third = lobes * (3.0 * (direction + angle - rod - lobes_direction)).cos();
        assert!((found + turned + third).abs() < 1e-15, "{angle}: {found:e}");
        assert!((found + third + wider * amplitude).abs() < 1e-3 * amplitude);
    }
}

#[test]
fn a_frame_on_springs_follows_the_forces_by_its_frequency_response() {
    let (mass, frequency, ratio) = (450.0, 40.0, 0.05);
    let natural = TAU * frequency;
    let mut machine = single_stage();
    machine.frame = Some(Frame {
        mass,
        stiffness_x: mass * natural * natural,
        stiffness_y: mass * natural * natural,
        damping_x: 2.0 * ratio * mass * natural,
        damping_y: 2.0 * ratio * mass * natural,
        carries: true,
    });
    let settled: Vec<f64> = revolution(128).iter().map(|d| d + 20.0 * 360.0).collect();
    let mut run = Run::start(machine, 1e-11, true);
    let (mut force, mut felt) = (Vec::new(), Vec::new());
    for degrees in settled {
        run.advance(degrees / 360.0 * REVOLUTION);
        let at = run.now();
        force.push(at.frame_force.x);
        felt.push(at.throws[0].carried.x);
    }
    for k in [1.0, 2.0, 4.0] {
        let r = k * SPEED / natural;
        let gain = r * r / ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)).sqrt() / mass;
        near(size(order(&felt, k)), gain * size(order(&force, k)), 1e-5);
    }
}
