//! The gas of a crank that turns back: pressures follow the piston's way, forward and back, and ideal
//! valves never give work away.

use crate::common;

use common::random::cases;
use common::{REVOLUTION, Run, single_stage, with_clearance};
use mechanism::drive::{Drive, Fluctuation, GivenSpeed, MotorLine};
use mechanism::gas::{CrankEnd, Cylinder};
use mechanism::{Evaluation, Machine};
use proptest::prelude::*;
use std::f64::consts::PI;

const TOLERANCE: f64 = 1e-10;
/// Looks of the reference within one of the run.
const FINER: u32 = 40;

/// Distance from piston to cover and pressure at head and crank end; the latter is 0 where there is none.
fn chambers(machine: &Machine, at: &Evaluation<f64>) -> [[f64; 2]; 2] {
    let (throw, part) = (&machine.throws[0], &at.throws[0]);
    let (cylinder, position) = (&throw.cylinder, part.motion.crosshead);
    let (reach, near) = (
        throw.rod.length + throw.crank_radius,
        throw.rod.length - throw.crank_radius,
    );
    let crank = cylinder.crank_end.as_ref();
    [
        [
            cylinder.head_clearance + reach - position,
            part.gas.head_end.pressure,
        ],
        [
            crank.map_or(1.0, |end| end.clearance + position - near),
            part.gas.crank_end.pressure,
        ],
    ]
}

/// What the gas of a chamber can do until it is at the suction pressure, over the area of its piston, J/m².
fn available(cylinder: &Cylinder, [x, p]: [f64; 2]) -> f64 {
    let (m, ps) = (cylinder.exponent, cylinder.suction);
    let full = x * (p / ps).powf(1.0 / m);
    p * x / (m - 1.0) * (1.0 - (x / full).powf(m - 1.0)) - ps * (full - x)
}

/// A crank whose angle is φ + Σ (d/k) sin(kφ + ψ), φ = ω t: with these amplitudes it turns back and forth.
fn swinging(machine: &mut Machine, harmonics: &[(f64, f64)]) {
    machine.drive = Drive::Given(GivenSpeed {
        speed: common::SPEED / 5.0,
        fluctuation: harmonics
            .iter()
            .map(|&(amplitude, phase)| Fluctuation { amplitude, phase })
            .collect(),
    });
}

/// How far the ideal piston has come from top dead centre, m.
fn retreat(machine: &Machine, time: f64) -> f64 {
    let (throw, Drive::Given(given)) = (&machine.throws[0], &machine.drive) else {
        unreachable!()
    };
    let turned = given.speed * time;
    let harmonics = (1..).map(f64::from).zip(&given.fluctuation);
    let angle = turned
        + harmonics
            .map(|(k, h)| h.amplitude / k * (k * turned + h.phase).sin())
            .sum::<f64>();
    let (radius, length) = (throw.crank_radius, throw.rod.length);
    let rod = (length * length - (radius * angle.sin()).powi(2)).sqrt();
    radius + length - radius * angle.cos() - rod
}

/// Ideal joints in a cylinder of any size whose lines may be as far apart as never to be reached.
fn cylinders() -> impl Strategy<Value = Machine> {
    (
        1.05..1.6_f64,
        0.8e5..3e5_f64,
        1.3..60.0_f64,
        0.004..0.05_f64,
        prop::option::of(0.004..0.05_f64),
    )
        .prop_map(|(exponent, suction, ratio, clearance, crank_end)| {
            let mut machine = single_stage();
            let cylinder = &mut machine.throws[0].cylinder;
            (cylinder.exponent, cylinder.expansion_exponent) = (exponent, exponent);
            (cylinder.suction, cylinder.discharge) = (suction, suction * ratio);
            cylinder.head_clearance = clearance;
            cylinder.crank_end = crank_end.map(|clearance| CrankEnd {
                rod_radius: 0.02,
                clearance,
            });
            machine
        })
}

fn harmonics() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((0.0..6.0_f64, 0.0..std::f64::consts::TAU), 1..4)
}

/// Follows `machine` and shows each of many equally spaced instants.
fn follow(machine: &Machine, mut look: impl FnMut(&mut Run)) {
    const LOOKS: u32 = 3000;
    let mut run = Run::start(machine.clone(), TOLERANCE, true);
    for i in 1..=LOOKS {
        run.advance(f64::from(i) / f64::from(LOOKS) * 10.0 * REVOLUTION);
        look(&mut run);
    }
}

/// Work of the gas and the back pressure on the piston so far, J.
fn gas_work(run: &Run) -> f64 {
    let ledger = run.dynamics.layout().ledger.unwrap();
    run.integrator.state()[ledger]
}

/// Energy that gas and back pressure still hold for the piston, J.
fn held(machine: &Machine, at: &Evaluation<f64>) -> f64 {
    let cylinder = &machine.throws[0].cylinder;
    let face = PI * cylinder.piston_radius * cylinder.piston_radius;
    let [head, crank] = chambers(machine, at);
    let of = |chamber: [f64; 2]| available(cylinder, chamber) - cylinder.suction * chamber[0];
    let position = at.throws[0].motion.crosshead;
    match &cylinder.crank_end {
        None => face * (of(head) - cylinder.back * position),
        Some(end) => {
            let rod = PI * end.rod_radius * end.rod_radius;
            face * of(head) + (face - rod) * of(crank) - rod * cylinder.back * position
        }
    }
}

proptest! {
    #![proptest_config(cases(40))]

    /// With ideal valves a chamber's pressure is where its piston's way leads it: along the polytrope,
    /// and never beyond the lines.
    #[test]
    fn pressures_follow_the_way_of_the_piston(machine in cylinders(), harmonics in harmonics()) {
        let mut machine = machine;
        swinging(&mut machine, &harmonics);
        let cylinder = machine.throws[0].cylinder.clone();
        let mut run = Run::start(machine.clone(), TOLERANCE, false);
        let mut expected = chambers(&machine, run.now());
        let start = expected;
        let mut before = 0.0;
        follow(&machine, |run| {
            let (now, time) = (chambers(&machine, run.now()), run.integrator.time());
            for i in 1..=FINER {
                let time = before + f64::from(i) / f64::from(FINER) * (time - before);
                let back = retreat(&machine, time) - retreat(&machine, 0.0);
                for (end, away) in [back, -back].into_iter().enumerate() {
                    let ([x, p], place) = (expected[end], start[end][0] + away);
                    let along = p * (x / place).powf(cylinder.exponent);
                    expected[end] = [place, along.clamp(cylinder.suction, cylinder.discharge)];
                }
            }
            before = time;
            for ([x, p], expected) in now.into_iter().zip(expected) {
                if p != 0.0 {
                    assert!((x - expected[0]).abs() < 1e-9, "{x} {expected:?}");
                    assert!((p / expected[1] - 1.0).abs() < 1e-4, "{p} {expected:?}");
                }
            }
        });
    }

    /// However the crank turns: the gas gives the piston no more than it held.
    #[test]
    fn ideal_valves_give_nothing_away(machine in cylinders(), harmonics in harmonics()) {
        let mut machine = machine;
        swinging(&mut machine, &harmonics);
        let mut run = Run::start(machine.clone(), TOLERANCE, true);
        let before = held(&machine, run.now());
        let (mut turned, mut last) = (1.0, 0.0);
        follow(&machine, |run| {
            let work = gas_work(run);
            turned += f64::abs(work - last);
            last = work;
            let gained = work + held(&machine, run.now()) - before;
            assert!(gained < 1e-7 * turned, "{gained} J of {turned} J");
        });
    }
}

/// A crank that nothing drives against the gas: it swings to and fro about where it started, and all that it
/// ever has is what it started with.
#[test]
fn a_crank_that_turns_back_gains_no_energy() {
    for (machine, inertia) in [
        (single_stage(), 0.2),
        (with_clearance(1e-4, 1e-4, 2e4), 2.0),
    ] {
        let mut machine = machine;
        machine.crankshaft.inertia = inertia;
        machine.drive = Drive::Free(MotorLine {
            reference_speed: common::SPEED,
            mean_torque: 5.0,
            slope: 0.0,
        });
        let mut run = Run::start(machine.clone(), TOLERANCE, true);
        run.now();
        let all = |run: &mut Run| {
            let at = run.now().clone();
            let driven = run.integrator.state()[run.dynamics.layout().ledger.unwrap() + 1];
            run.dynamics.energy().total() + held(&machine, &at) - driven
        };
        let (mut least, mut backwards) = (all(&mut run), false);
        for i in 1..=600 {
            run.advance(f64::from(i) * 0.05 * REVOLUTION);
            backwards |= run.now().speed < 0.0;
            let now = all(&mut run);
            assert!(now < least + 0.02, "{now} J after {least} J");
            least = least.min(now);
        }
        assert!(backwards, "it never turned back");
    }
}

/// A crank that comes round leaves no trace of the gas's past, and is the machine that it was.
#[test]
fn in_a_crank_that_comes_round_dead_centres_set_the_gas() {
    let mut run = Run::start(with_clearance(2e-4, 2e-4, 2e4), TOLERANCE, false);
    for i in 1..100 {
        run.advance(f64::from(i) * 0.0371 * REVOLUTION);
        let mode = run.dynamics.mode();
        assert_eq!(mode.throws[0].head_end.trapped, 1.0);
        assert_eq!(mode.turning, 1.0);
    }
}
