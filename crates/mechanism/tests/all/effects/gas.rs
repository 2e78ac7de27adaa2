//! Effects of the gas and of the valves.

use super::{
    DEAD, M, PD, PISTON, PS, RADIUS, STROKE, at_angles, distance, ideal, near, pressure, speed,
};
use crate::common::{REVOLUTION, Run, SPEED, single_stage, with_clearance};
use mechanism::effects::{
    Effect, End, GasPulsation, HeatTransfer, Law, Place, RingLeakage, SuctionUnloading,
    ValveFlutter, ValveLeakage, ValveLoss,
};
use mechanism::gas::CrankEnd;
use mechanism::{Evaluation, Machine};
use std::f64::consts::{PI, TAU};

#[test]
fn valve_loss_lifts_the_plateaus_by_the_square_of_the_speed_and_costs_its_work() {
    let (suction, discharge) = (0.18, 0.15);
    let machine = ideal(Law::ValveLoss(ValveLoss {
        suction,
        discharge,
        suction_linear: 0.0,
        discharge_linear: 0.0,
        suction_overshoot: 0.0,
        discharge_overshoot: 0.0,
        overshoot_angle: 0.2,
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
    let mut machine = ideal(Law::RingLeakage(RingLeakage {
        area,
        gas_speed,
        critical_ratio: 0.0,
        laminar: 0.0,
        behind: 0.0,
    }));
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

/// An orifice whose flow chokes, and a narrow gap, which Stodola's ellipse is between: each against its own law, integrated
/// by another method. The ellipse of an orifice is within 2 % of the flow of a perfect gas through a nozzle.
#[test]
fn rings_leak_through_one_orifice_or_a_narrow_gap_by_their_own_laws() {
    let (area, gas_speed, back, critical) = (8e-6, 290.0, 0.02e6, 0.53);
    let end = 270_f64.to_radians();
    let face = PI * PISTON * PISTON;
    let leaking = |critical_ratio: f64, laminar: f64, back: f64| {
        let mut machine = ideal(Law::RingLeakage(RingLeakage {
            area,
            gas_speed,
            critical_ratio,
            laminar,
            behind: 0.0,
        }));
        machine.throws[0].cylinder.back = back;
        at_angles(machine, &[270.0], pressure)[0]
    };
    let orifice = |back: f64| {
        compressed(end, |x, p| {
            let beyond = (back / p - critical).max(0.0) / (1.0 - critical);
            let flow = p * (1.0 - beyond * beyond).sqrt();
            -M * area * gas_speed * flow / (p * face * x)
        })
    };
    // Choked all the way, and not choked.
    near(leaking(critical, 0.0, back), orifice(back).exp(), 2e-5);
    near(leaking(critical, 0.0, 0.08e6), orifice(0.08e6).exp(), 2e-4);
    let narrow = compressed(end, |x, p| {
        -M * area * gas_speed * (p * p - back * back) / PD / (p * face * x)
    });
    near(leaking(0.0, 1.0, back), narrow.exp(), 2e-5);
    // Under the piston the pressure of a crankcase, whatever the data sheet says.
    let mut machine = ideal(Law::RingLeakage(RingLeakage {
        area,
        gas_speed,
        critical_ratio: 0.0,
        laminar: 0.0,
        behind: 0.08e6,
    }));
    machine.throws[0].cylinder.back = 0.0;
    let breathing = at_angles(machine, &[270.0], pressure)[0];
    near(breathing, leaking(0.0, 0.0, 0.08e6), 1e-12);

    let nozzle = |r: f64| {
        let k = 1.4;
        let flow = |r: f64| (r.powf(2.0 / k) - r.powf((k + 1.0) / k)).sqrt();
        flow(r.max(0.5283)) / flow(0.5283)
    };
    for r in [0.2, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95] {
        let beyond = f64::max(r - 0.5283, 0.0) / (1.0 - 0.5283);
        near(nozzle(r), (1.0 - beyond * beyond).sqrt(), 0.02);
    }
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
            critical_ratio: 0.0,
            laminar: 0.0,
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
            critical_ratio: 0.0,
            laminar: 0.0,
            behind: 0.0,
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
fn a_spring_loaded_plate_adds_a_loss_that_grows_with_the_speed() {
    let losses = |suction_linear: f64, discharge_linear: f64| {
        let machine = ideal(Law::ValveLoss(ValveLoss {
            suction: 0.1,
            discharge: 0.1,
            suction_linear,
            discharge_linear,
            suction_overshoot: 0.0,
            discharge_overshoot: 0.0,
            overshoot_angle: 0.2,
        }));
        at_angles(machine, &[100.0, 310.0], pressure)
    };
    let (square, both) = (losses(0.0, 0.0), losses(0.05, 0.04));
    let u = [100.0, 310.0].map(|degrees: f64| speed(degrees.to_radians()));
    near(square[0] - both[0], PS * 0.05 * u[0], 1e-6);
    near(square[1] - both[1], PD * 0.04 * u[1], 1e-6);
}

#[test]
fn a_plate_that_lags_adds_an_overshoot_that_fades_over_the_angle_since_it_let_go() {
    let (share, angle) = (0.1, 15_f64.to_radians());
    let machine = ideal(Law::ValveLoss(ValveLoss {
        suction: 0.0,
        discharge: 0.0,
        suction_linear: 0.0,
        discharge_linear: 0.0,
        suction_overshoot: share,
        discharge_overshoot: share,
        overshoot_angle: angle,
    }));
    // Where the polytrope reaches the pressure at which each valve lets go.
    let reaches = |volume: f64, falls: bool| {
        let (mut low, mut high) = if falls { (PI, TAU) } else { (0.0, PI) };
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let beyond = (distance(middle) > volume) != falls;
            (low, high) = if beyond {
                (low, middle)
            } else {
                (middle, high)
            };
        }
        low
    };
    let intake = reaches(DEAD * (PD / PS / (1.0 - share)).powf(1.0 / M), false);
    let outlet = reaches(
        (STROKE + DEAD) / (PD / PS * (1.0 + share)).powf(1.0 / M),
        true,
    );
    let found = at_angles(machine, &[70.0, 120.0, 330.0, 350.0], pressure);
    let faded = |degrees: f64, since: f64| (-(degrees.to_radians() - since) / angle).exp();
    for (found, degrees) in found[..2].iter().zip([70.0, 120.0]) {
        near(*found, PS * (1.0 - share * faded(degrees, intake)), 1e-9);
    }
    for (found, degrees) in found[2..].iter().zip([330.0, 350.0]) {
        near(*found, PD * (1.0 + share * faded(degrees, outlet)), 1e-9);
    }
}
