//! The one right-hand side over its three kinds of numbers: dual numbers give the derivative, and
//! neither they nor lanes change a bit of the value.

use crate::common;

use common::random::{MODELS, SEEDS, cases, machine_with_effects, random_state, settle};
use common::with_clearance;
use integrate::{Integrator, Real, System};
use mechanism::drive::{Drive, MotorLine};
use mechanism::gas::GasState;
use mechanism::joints::contact::{ContactLaw, KelvinVoigt};
use mechanism::joints::revolute::{JointModel, Revolute};
use mechanism::lift::{Lift, directional, lanes};
use mechanism::mode::{ChamberMode, ContactMode, Mode, ThrowMode};
use mechanism::plane::Vec2;
use mechanism::{Dynamics, Evaluation, Machine};
use proptest::prelude::*;
use scalar::lanes::in_all_lanes;
use scalar::{Dual, InLanes, Lanes, Scalar};

/// The machine with every number scaled by one plus `size` times a number of its own in [-1, 1].
fn varied(machine: &Machine, size: f64, seed: u64) -> Machine {
    let mut state = seed;
    Machine::lift(&[machine], &mut |x| {
        // A linear congruential generator (Knuth's MMIX) is random enough to tell numbers apart.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_precision_loss, reason = "a random number")]
        let unit = (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        x[0] * (1.0 + size * unit)
    })
}

/// The mode of several dynamics, packed by `pack`.
fn pack_modes<S: Scalar>(modes: &[&Mode<f64>], pack: &impl Fn(&[f64]) -> S) -> Mode<S> {
    let gather = |get: &dyn Fn(&Mode<f64>) -> f64| {
        let values: Vec<f64> = modes.iter().map(|m| get(m)).collect();
        pack(&values)
    };
    let contact = |of: &dyn Fn(&Mode<f64>) -> ContactMode<f64>| ContactMode {
        touching: gather(&|m| of(m).touching),
        pressed: gather(&|m| of(m).pressed),
        deep: gather(&|m| of(m).deep),
        slipping: [0, 1].map(|i| gather(&|m| of(m).slipping[i])),
        approach: gather(&|m| of(m).approach),
    };
    let chamber = |of: &dyn Fn(&Mode<f64>) -> ChamberMode<f64>| ChamberMode {
        suction: gather(&|m| of(m).suction),
        discharge: gather(&|m| of(m).discharge),
        trapped: gather(&|m| of(m).trapped),
    };
    Mode {
        turning: gather(&|m| m.turning),
        main: contact(&|m| m.main),
        throws: (0..modes[0].throws.len())
            .map(|i| ThrowMode {
                big_end: contact(&|m| m.throws[i].big_end),
                small_end: contact(&|m| m.throws[i].small_end),
                guide: [0, 1, 2, 3].map(|corner| contact(&|m| m.throws[i].guide[corner])),
                outward: gather(&|m| m.throws[i].outward),
                head_end: chamber(&|m| m.throws[i].head_end),
                crank_end: chamber(&|m| m.throws[i].crank_end),
            })
            .collect(),
    }
}

/// All that an evaluation finds, in a row.
fn numbers<S: Scalar>(dynamics: &Dynamics<S>) -> Vec<S> {
    let at: &Evaluation<S> = dynamics.evaluation();
    let energy = dynamics.energy();
    let mut row = vec![
        at.angle,
        at.speed,
        at.shaft.angular,
        at.shaft.torque,
        energy.kinetic,
        energy.potential,
        energy.elastic,
    ];
    let mut vector = |v: Vec2<S>| row.extend([v.x, v.y]);
    vector(at.shaft.centre);
    vector(at.shaft.bearing_force);
    vector(at.frame_force);
    for part in &at.throws {
        let (joints, found) = (&part.joints, &part.accelerations);
        for v in [
            joints.big_end.force,
            joints.small_end.force,
            joints.guide.force,
            found.big_end,
            found.small_end,
            found.big_force,
            found.small_force,
            found.guide,
        ] {
            vector(v);
        }
        let pressure = |gas: &GasState<S>| gas.pressure;
        vector(Vec2::new(
            pressure(&part.gas.head_end),
            pressure(&part.gas.crank_end),
        ));
        vector(Vec2::new(found.crosshead, found.rod));
        vector(Vec2::new(joints.guide.moment, part.gas.force));
        vector(Vec2::new(part.gas.effects, part.carried.x));
    }
    row
}

/// A machine at a random state in the mode that belongs to it.
fn settled(machine: &Machine, t: f64, seeds: &[f64]) -> (Dynamics<f64>, Vec<f64>) {
    let mut dynamics = Dynamics::new(machine.clone(), false);
    let mut y = random_state(&dynamics, seeds);
    settle(&mut dynamics, t, &mut y);
    (dynamics, y)
}

/// A machine varied in each lane, against the same ones alone.
#[derive(Clone, Copy)]
struct Agree<'a> {
    machine: &'a Machine,
    t: f64,
    seeds: &'a [f64],
}

impl InLanes for Agree<'_> {
    type Output = ();
    fn run<L: Lanes<W>, const W: usize>(self) {
        let Self { machine, t, seeds } = self;
        let machines: [Machine; W] =
            std::array::from_fn(|lane| varied(machine, 1e-2, lane as u64 + 1));
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let times: [f64; W] = std::array::from_fn(|lane| t + 0.01 * lane as f64);
        let mut alone: Vec<(Dynamics<f64>, Vec<f64>)> = (0..W)
            .map(|lane| {
                let mut seeds = seeds.to_vec();
                seeds.rotate_left(lane);
                settled(&machines[lane], times[lane], &seeds)
            })
            .collect();

        let mut together = Dynamics::<L>::new(lanes(machines.each_ref()), false);
        let modes: Vec<&Mode<f64>> = alone.iter().map(|(dynamics, _)| dynamics.mode()).collect();
        *together.mode_mut() =
            pack_modes(&modes, &|x| L::from_array(std::array::from_fn(|i| x[i])));
        let y: Vec<L> = (0..alone[0].1.len())
            .map(|j| L::from_array(std::array::from_fn(|lane| alone[lane].1[j])))
            .collect();
        together.evaluate(L::from_array(times), &y);
        let packed = numbers(&together);
        for (lane, (dynamics, y)) in alone.iter_mut().enumerate() {
            dynamics.evaluate(times[lane], y);
            for (i, (one, many)) in numbers(dynamics).iter().zip(&packed).enumerate() {
                let many = many.get(lane);
                assert_eq!(
                    one.to_bits(),
                    many.to_bits(),
                    "number {i} in lane {lane} of {W}: {one:e} alone, {many:e} together"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn lanes_give_the_bits_of_each_case_alone(
        machine in machine_with_effects(MODELS),
        t in 0.001..0.05_f64,
        seeds in proptest::collection::vec(-1.0..1.0_f64, SEEDS),
    ) {
        in_all_lanes(Agree { machine: &machine, t, seeds: &seeds });
    }

    #[test]
    fn dual_numbers_give_the_derivative_along_any_line(
        machine in machine_with_effects(MODELS),
        t in 0.001..0.119_f64,
        seeds in proptest::collection::vec(-1.0..1.0_f64, SEEDS),
    ) {
        // Along the line all parameters move by up to 1e-3 of themselves, the state by 1e-3 of
        // another random state.
        let along = |s: f64| varied(&machine, 1e-3 * s, 7);
        let (mut plain, y) = settled(&machine, t, &seeds);
        let mut other = seeds.clone();
        other.reverse();
        let direction: Vec<f64> = random_state(&plain, &other).iter().map(|v| 1e-3 * v).collect();

        let mut dual = Dynamics::new(directional(&machine, &along(1.0)), false);
        *dual.mode_mut() = pack_modes(&[plain.mode()], &|x| Dual::constant(x[0]));
        let line: Vec<Dual<f64, 1>> = y
            .iter()
            .zip(&direction)
            .map(|(value, step)| Dual { value: *value, tangent: [*step] })
            .collect();
        dual.evaluate(Dual::constant(t), &line);
        let found = numbers(&dual);

        plain.evaluate(t, &y);
        for (a, b) in numbers(&plain).iter().zip(&found) {
            prop_assert_eq!(a.to_bits(), b.value.to_bits());
        }

        // Central differences with two widths, extrapolated to none (Richardson 1911); so narrow that
        // a switch of the contact or of friction hardly ever lies between.
        let at = |s: f64| {
            let mut moved = Dynamics::new(along(s), false);
            *moved.mode_mut() = plain.mode().clone();
            let y: Vec<f64> = y.iter().zip(&direction).map(|(y, d)| y + s * d).collect();
            moved.evaluate(t, &y);
            numbers(&moved)
        };
        let difference = |h: f64| -> Vec<f64> {
            let (more, less) = (at(h), at(-h));
            more.iter().zip(&less).map(|(a, b)| (a - b) / (2.0 * h)).collect()
        };
        let (wide, narrow) = (difference(8e-3), difference(4e-3));
        for (i, ((wide, narrow), dual)) in wide.iter().zip(&narrow).zip(&found).enumerate() {
            let expected = (4.0 * narrow - wide) / 3.0;
            let scale = expected.abs().max(1e-3 * dual.value.abs()).max(5e-3);
            // What the extrapolation leaves is a small part of what it took away.
            let allowed = 1e-6 * scale + 0.01 * (wide - narrow).abs();
            let off = (dual.tangent[0] - expected).abs();
            prop_assert!(off < allowed, "number {i}: {} against {expected}", dual.tangent[0]);
        }
    }
}

/// The machine with its big end's stiffness multiplied by `factor`.
fn stiffened(machine: &Machine, factor: f64) -> Machine {
    let mut machine = machine.clone();
    if let Revolute::Clear(clear) = &mut machine.throws[0].big_end
        && let ContactLaw::Impact(law) = &mut clear.contact
    {
        law.stiffness *= factor;
    }
    machine
}

/// The state at `end`.
fn run<S: Real>(machine: Machine<S>, end: f64) -> Vec<S> {
    let mut dynamics = Dynamics::new(machine, false);
    let y = dynamics.initial_state();
    let mut integrator = Integrator::new(&mut dynamics, 0.0, &y, 1e-12, 0.006);
    integrator.advance(&mut dynamics, end, |_, _| ()).unwrap();
    integrator.state().to_vec()
}

/// The derivative of the state at `end` by the big end's stiffness, against central differences.
fn check_sensitivity(name: &str, machine: &Machine, end: f64) {
    let sensitive = run(directional(machine, &stiffened(machine, 2.0)), end);
    let plain = run(machine.clone(), end);
    for (a, b) in plain.iter().zip(&sensitive) {
        assert_eq!(a.to_bits(), b.value.to_bits(), "{name}");
    }
    let difference = |h: f64| -> Vec<f64> {
        let [more, less] = [1.0 + h, 1.0 - h].map(|f| run(stiffened(machine, f), end));
        let pairs = more.iter().zip(&less);
        pairs.map(|(a, b)| (a - b) / (2.0 * h)).collect()
    };
    let (wide, narrow) = (difference(2e-4), difference(1e-4));
    let scales = Dynamics::new(machine.clone(), false).scales().to_vec();
    let mut worst = 0.0_f64;
    for (i, ((wide, narrow), dual)) in wide.iter().zip(&narrow).zip(&sensitive).enumerate() {
        let expected = (4.0 * narrow - wide) / 3.0;
        let size = expected.abs().max(0.01 * scales[i]);
        worst = worst.max((dual.tangent[0] - expected).abs() / size);
    }
    eprintln!("{name:32} sensitivity to {worst:.1e}");
    assert!(worst < 1e-6, "{name}: {worst:e}");
}

#[test]
fn a_run_over_dual_numbers_gives_the_sensitivity_of_the_state() {
    let impact = with_clearance(2e-4, 2e-4, 2e4);
    let mut jump = impact.clone();
    let mut rigid = impact.clone();
    if let Revolute::Clear(clear) = &mut jump.throws[0].small_end {
        clear.contact = ContactLaw::KelvinVoigt(KelvinVoigt {
            stiffness: 2e8,
            damping: 2e4,
        });
    }
    if let Revolute::Clear(clear) = &mut rigid.throws[0].small_end {
        clear.model = JointModel::TwoMode;
    }
    let mut free = impact.clone();
    free.crankshaft.inertia = 1.0;
    free.drive = Drive::Free(MotorLine {
        reference_speed: common::SPEED,
        mean_torque: 60.0,
        slope: 40.0,
    });
    for end in [0.05, 0.1] {
        check_sensitivity("impact", &impact, end);
        // Switches at which the force or the state jumps: their time's derivative counts.
        check_sensitivity("force jumps at touch", &jump, end);
        check_sensitivity("rates jump at touch", &rigid, end);
        check_sensitivity("free crank, gas jumps", &free, end);
    }
}
