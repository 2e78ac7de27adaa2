//! What must not change the motion, or change it in a known way: a mirror, whole revolutions of
//! time, other units; and what must vanish with the clearance.

use crate::common;

use common::random::{cases, machine};
use common::{REVOLUTION, Run, reference, reference_machine, single_stage, with_clearance};
use integrate::{Integrator, System};
use mechanism::drive::Drive;
use mechanism::effects::Law;
use mechanism::joints::contact::{ContactLaw, Restitution};
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::{JointModel, Revolute};
use mechanism::state::Layout;
use mechanism::{Dynamics, Machine};
use proptest::prelude::*;

/// Long enough for many contacts, short enough that chaos does not blow rounding up.
const DURATION: f64 = 0.2 * REVOLUTION;

const COMPLIANT: &[JointModel] = &[JointModel::ThreeMode];

/// The state of `machine` after `duration`, having started `nudge` scales off its initial state.
fn state_after(machine: &Machine, duration: f64, nudge: f64) -> Vec<f64> {
    let mut dynamics = Dynamics::new(machine.clone(), false);
    let mut y = dynamics.initial_state();
    for (y, scale) in y.iter_mut().zip(dynamics.scales()) {
        *y += nudge * scale;
    }
    let mut run = Integrator::new(&mut dynamics, 0.0, &y, 1e-12, duration / 40.0);
    run.advance(&mut dynamics, duration, |_, _| ()).unwrap();
    run.state().to_vec()
}

/// How far two runs may differ for rounding alone: some times as far as a nudge of 1e-12 of the
/// clearances leads astray.
fn rounding(machine: &Machine, duration: f64) -> f64 {
    let [plain, nudged] = [0.0, 1e-12].map(|nudge| state_after(machine, duration, nudge));
    let allowed = 30.0 * difference(&plain, &nudged, &scales(machine));
    allowed.max(1e-9)
}

/// Largest difference of two states, component by component in the scales of the tolerance.
fn difference(a: &[f64], b: &[f64], scales: &[f64]) -> f64 {
    let each = a.iter().zip(b).zip(scales);
    each.map(|((a, b), s)| ((a - b) / s).abs())
        .fold(0.0, f64::max)
}

fn scales(machine: &Machine) -> Vec<f64> {
    Dynamics::new(machine.clone(), false).scales().to_vec()
}

/// The machine seen in a mirror along the cylinder's axis: it turns the other way.
fn mirrored(machine: &Machine) -> Machine {
    let mut mirrored = machine.clone();
    mirrored.gravity_y *= -1.0;
    match &mut mirrored.drive {
        Drive::Given(given) => given.speed *= -1.0,
        Drive::Free(motor) => {
            motor.reference_speed *= -1.0;
            motor.mean_torque *= -1.0;
        }
    }
    for throw in &mut mirrored.throws {
        throw.pin_angle *= -1.0;
    }
    mirrored
}

/// The mirror image of a state: y, tilt and crank angle change sign.
fn mirror(y: &mut [f64], layout: &Layout) {
    let mut flip = |at: Option<usize>, offsets: &[usize]| {
        if let Some(i) = at {
            for j in offsets {
                y[i + j] *= -1.0;
            }
        }
    };
    flip(layout.main, &[1, 3]);
    flip(layout.crank, &[0, 1]);
    for throw in &layout.throws {
        flip(throw.big_end, &[1, 3]);
        flip(throw.small_end, &[1, 3]);
        flip(throw.guide, &[0, 1, 2, 3]);
    }
}

/// The machine in units of length, mass and time that are 1/`length`, 1/`mass` and 1/`time` of
/// ours.
fn rescaled(machine: &Machine, length: f64, mass: f64, time: f64) -> Machine {
    let (speed, force) = (length / time, mass * length / (time * time));
    let (pressure, inertia) = (force / (length * length), mass * length * length);
    let mut m = machine.clone();
    let contact = |law: &mut ContactLaw| match law {
        ContactLaw::Impact(law) => {
            law.stiffness *= force / length.powf(law.exponent);
            law.damping *= force / speed;
            law.depth *= length;
        }
        ContactLaw::Hertz(law) => law.stiffness *= force / length.powf(law.exponent),
        ContactLaw::KelvinVoigt(law) => {
            law.stiffness *= force / length;
            law.damping *= force / speed;
        }
        ContactLaw::HuntCrossley(law)
        | ContactLaw::LankaraniNikravesh(law)
        | ContactLaw::Flores(law) => {
            law.stiffness *= force / length.powf(law.exponent);
            law.slowest_approach *= speed;
        }
        other => panic!("{other:?} is not among the laws that are drawn"),
    };
    let friction = |law: &mut FrictionLaw| match law {
        FrictionLaw::None(_) => {}
        FrictionLaw::Coulomb(law) => law.slip_speed *= speed,
        FrictionLaw::Adams(law) => {
            law.stiction_speed *= speed;
            law.transition_speed *= speed;
        }
        FrictionLaw::Ambrosio(law) => {
            law.slow *= speed;
            law.fast *= speed;
        }
    };
    let joint = |joint: &mut Revolute| {
        if let Revolute::Clear(clear) = joint {
            clear.clearance *= length;
            clear.journal_radius *= length;
            contact(&mut clear.contact);
            friction(&mut clear.friction);
        }
    };
    m.gravity_x *= speed / time;
    m.gravity_y *= speed / time;
    m.crankshaft.mass *= mass;
    m.crankshaft.inertia *= inertia;
    m.crankshaft.eccentricity *= length;
    match &mut m.drive {
        Drive::Given(given) => given.speed /= time,
        Drive::Free(motor) => {
            motor.reference_speed /= time;
            motor.mean_torque *= force * length;
            motor.slope *= force * length * time;
        }
    }
    joint(&mut m.main);
    for effect in &mut m.effects {
        if let Law::RingFriction(rings) = &mut effect.law {
            rings.coulomb_force *= force;
            rings.per_pressure *= force / pressure;
            rings.slip_speed *= speed;
            rings.viscous *= force / speed;
        }
    }
    for throw in &mut m.throws {
        throw.crank_radius *= length;
        throw.rod.length *= length;
        throw.rod.mass *= mass;
        throw.rod.centre_of_mass *= length;
        throw.rod.inertia *= inertia;
        throw.crosshead.mass *= mass;
        throw.crosshead.inertia *= inertia;
        let cylinder = &mut throw.cylinder;
        cylinder.piston_radius *= length;
        cylinder.suction *= pressure;
        cylinder.discharge *= pressure;
        cylinder.back *= pressure;
        cylinder.head_clearance *= length;
        if let Some(end) = &mut cylinder.crank_end {
            end.rod_radius *= length;
            end.clearance *= length;
        }
        joint(&mut throw.big_end);
        joint(&mut throw.small_end);
        if let Guide::Clear(clear) = &mut throw.guide {
            clear.clearance *= length;
            clear.half_length *= length;
            clear.half_height *= length;
            contact(&mut clear.contact);
            friction(&mut clear.friction);
        }
    }
    m
}

/// A state in the same other units.
fn rescale(y: &mut [f64], layout: &Layout, length: f64, time: f64) {
    let mut scale = |at: Option<usize>, first: f64, second: f64| {
        if let Some(i) = at {
            for (j, factor) in [first, second, first / time, second / time]
                .into_iter()
                .enumerate()
            {
                y[i + j] *= factor;
            }
        }
    };
    scale(layout.main, length, length);
    for throw in &layout.throws {
        scale(throw.big_end, length, length);
        scale(throw.small_end, length, length);
        scale(throw.guide, length, 1.0);
    }
    if let Some(i) = layout.crank {
        y[i + 1] /= time;
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn a_mirror_mirrors_the_motion(machine in machine(COMPLIANT)) {
        let layout = Layout::new(&machine, false);
        let seen = state_after(&mirrored(&machine), DURATION, 0.0);
        let mut plain = state_after(&machine, DURATION, 0.0);
        mirror(&mut plain, &layout);
        let off = difference(&seen, &plain, &scales(&machine));
        let allowed = rounding(&machine, DURATION);
        prop_assert!(off < allowed, "{off:e}, allowed {allowed:e}");
    }

    #[test]
    fn whole_revolutions_of_time_change_nothing(machine in machine(COMPLIANT)) {
        let ends = [0.0, 11.0].map(|revolutions| {
            let start = revolutions * REVOLUTION;
            let mut dynamics = Dynamics::new(machine.clone(), false);
            let y = dynamics.initial_state();
            let mut run = Integrator::new(&mut dynamics, start, &y, 1e-12, DURATION / 40.0);
            run.advance(&mut dynamics, start + DURATION, |_, _| ()).unwrap();
            run.state().to_vec()
        });
        let off = difference(&ends[0], &ends[1], &scales(&machine));
        let allowed = rounding(&machine, DURATION);
        prop_assert!(off < allowed, "{off:e}, allowed {allowed:e}");
    }

    #[test]
    fn other_units_give_the_same_motion(machine in machine(COMPLIANT)) {
        let (length, mass, time) = (1.7, 0.3, 0.6);
        let layout = Layout::new(&machine, false);
        let other = rescaled(&machine, length, mass, time);
        let found = state_after(&other, DURATION * time, 0.0);
        let mut expected = state_after(&machine, DURATION, 0.0);
        rescale(&mut expected, &layout, length, time);
        let mut sizes = scales(&machine);
        rescale(&mut sizes, &layout, length, time);
        let off = difference(&found, &expected, &sizes);
        let allowed = rounding(&machine, DURATION);
        prop_assert!(off < allowed, "{off:e}, allowed {allowed:e}");
    }
}

#[test]
fn a_settled_regular_motion_repeats_with_the_revolution() {
    let reference = reference();
    for case in ["big_02mm", "small_01mm", "both_01mm"] {
        let machine = reference_machine(&reference[case]["parameters"]);
        let scales = scales(&machine);
        let mut run = Run::start(machine, 1e-11, false);
        let mut off = 0.0_f64;
        let mut seen: Vec<Vec<f64>> = Vec::new();
        for i in 0..40 {
            run.advance((30.0 + f64::from(i) / 20.0 + 0.013) * REVOLUTION);
            seen.push(run.integrator.state().to_vec());
        }
        for (now, later) in seen[..20].iter().zip(&seen[20..]) {
            off = off.max(difference(now, later, &scales));
        }
        eprintln!("{case}: repeats to {off:.1e} of the clearance");
        assert!(off < 1e-8, "{case}: {off:e}");
    }
}

#[test]
fn the_ideal_machine_is_the_limit_of_small_clearances() {
    let deviation = |clearance: f64| {
        let mut machine = with_clearance(clearance, clearance, 2e4);
        let throw = &mut machine.throws[0];
        for end in [&mut throw.big_end, &mut throw.small_end] {
            if let Revolute::Clear(clear) = end {
                // So stiff that what the journals sink in shrinks with the clearance.
                clear.contact = ContactLaw::HuntCrossley(Restitution {
                    stiffness: 2.4e10 * (1e-4 / clearance).powf(1.5),
                    exponent: 1.5,
                    restitution: 0.4,
                    slowest_approach: 1e-3,
                });
            }
        }
        let mut ideal = Dynamics::new(single_stage(), false);
        let mut run = Run::start(machine, 1e-9, false);
        let (mut place, mut rate) = (0.0_f64, 0.0_f64);
        for i in 0..=600 {
            let t = REVOLUTION * (1.0 + f64::from(i) / 300.0);
            run.advance(t);
            let clear = run.now().throws[0].motion;
            let rigid = ideal.evaluate(t, &[]).throws[0].motion;
            place = place.max((clear.crosshead - rigid.crosshead).abs());
            rate = rate.max((clear.crosshead_rate - rigid.crosshead_rate).abs());
        }
        [place, rate]
    };
    let mut last = [f64::INFINITY; 2];
    for clearance in [4e-4, 1e-4, 2.5e-5, 6.25e-6] {
        let [place, rate] = deviation(clearance);
        eprintln!(
            "c = {clearance:.2e} m: place off by {:.3} c, speed by {rate:.4} m/s",
            place / clearance
        );
        // Two joints, each by its clearance and what it sinks in.
        assert!((1.5..5.0).contains(&(place / clearance)));
        assert!(place < 0.5 * last[0] && rate < last[1]);
        last = [place, rate];
    }
}
