//! The joint models of the literature beside the compliant contact: the massless link, and free
//! flight with following but no impact.

use crate::common;

use common::{REVOLUTION, Run, joint, single_stage, with_clearance};
use mechanism::drive::{Drive, MotorLine};
use mechanism::joints::revolute::{JointModel, JointState, Revolute};
use mechanism::mode::ContactMode;
use mechanism::{Dynamics, Machine};

const CLEARANCE: f64 = 2e-4;

/// Gives every clear joint of the machine the same model.
fn with_model(mut machine: Machine, model: JointModel) -> Machine {
    let throw = &mut machine.throws[0];
    for joint in [&mut machine.main, &mut throw.big_end, &mut throw.small_end] {
        if let Revolute::Clear(clear) = joint {
            clear.model = model;
        }
    }
    machine
}

/// Machines with clearance in one place, in two, in three, and with a free crank.
fn machines(model: JointModel) -> Vec<(&'static str, Machine)> {
    let main = |mut machine: Machine| {
        machine.main = joint(CLEARANCE, 0.06, 2.4e10, 2e4);
        machine.crankshaft.eccentricity = 0.02;
        machine
    };
    let free = |mut machine: Machine| {
        machine.drive = Drive::Free(MotorLine {
            reference_speed: common::SPEED,
            mean_torque: 60.0,
            slope: 40.0,
        });
        machine
    };
    let c = CLEARANCE;
    [
        ("big end", with_clearance(c, 0.0, 2e4)),
        ("small end", with_clearance(0.0, c, 2e4)),
        ("both ends", with_clearance(c, c, 2e4)),
        ("main bearing", main(single_stage())),
        ("all three", main(with_clearance(c, c, 2e4))),
        (
            "all three, free crank",
            free(main(with_clearance(c, c, 2e4))),
        ),
    ]
    .map(|(name, machine)| (name, with_model(machine, model)))
    .to_vec()
}

/// The joints with clearance: state, mode, and the force by which the surfaces push each other.
fn joints(dynamics: &Dynamics<f64>) -> Vec<(JointState<f64>, ContactMode<f64>, f64)> {
    let (at, mode, machine) = (dynamics.evaluation(), dynamics.mode(), dynamics.machine());
    let (part, throw) = (&at.throws[0].joints, &machine.throws[0]);
    let forces = &at.throws[0].accelerations;
    [
        // The bearing pushes the journal inward, the journal the rod's eye outward.
        (&machine.main, at.main, mode.main, -at.shaft.bearing_force),
        (
            &throw.big_end,
            part.big_end,
            mode.throws[0].big_end,
            forces.big_force,
        ),
        (
            &throw.small_end,
            part.small_end,
            mode.throws[0].small_end,
            forces.small_force,
        ),
    ]
    .into_iter()
    .filter(|(joint, ..)| joint.clear().is_some())
    .map(|(_, state, mode, force)| (state, mode, state.normal.dot(&force)))
    .collect()
}

/// Runs the machine, shows `see` the dynamics at the end of every step, and gives what the energy
/// ledger misses over the energy turned over.
fn run(machine: Machine, revolutions: f64, mut see: impl FnMut(&Dynamics<f64>)) -> f64 {
    let mut run = Run::start(machine, 3e-11, true);
    run.now();
    let start = run.dynamics.energy().total();
    let end = revolutions * REVOLUTION;
    run.integrator
        .advance(&mut run.dynamics, end, |dynamics, step| {
            dynamics.evaluate(step.start + step.length, &step.to);
            see(dynamics);
        })
        .unwrap();
    run.now();
    let ledger = run.dynamics.layout().ledger.unwrap();
    let works = &run.integrator.state()[ledger..ledger + 4];
    let stored = run.dynamics.energy().total() - start;
    let missing = stored - works[0] - works[1] + works[2] + works[3];
    missing.abs() / works.iter().map(|w| w.abs()).sum::<f64>()
}

#[test]
fn a_massless_link_keeps_its_length_and_the_ledger() {
    for (name, machine) in machines(JointModel::MasslessLink) {
        let mut off = 0.0_f64;
        let imbalance = run(machine, 20.3, |dynamics| {
            for (joint, ..) in joints(dynamics) {
                off = off.max(joint.penetration.abs() / CLEARANCE);
            }
        });
        eprintln!("massless link, {name:22} length to {off:.1e}, ledger to {imbalance:.1e}");
        assert!(off < 1e-9, "{name}: {off:e}");
        assert!(imbalance < 1e-7, "{name}: {imbalance:e}");
    }
}

#[test]
fn a_two_mode_joint_follows_without_rebound_and_keeps_the_ledger() {
    for (name, machine) in machines(JointModel::TwoMode) {
        let (mut off, mut beyond, mut approach, mut pull) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let (mut followed, mut flown) = (0, 0);
        let imbalance = run(machine, 20.3, |dynamics| {
            for (joint, mode, push) in joints(dynamics) {
                let gap = joint.penetration / CLEARANCE;
                if mode.touching > 0.0 {
                    off = off.max(gap.abs());
                    approach = approach.max(joint.penetration_rate.abs());
                    pull = pull.max(-push);
                    followed += 1;
                } else {
                    beyond = beyond.max(gap);
                    flown += 1;
                }
            }
        });
        eprintln!(
            "two-mode, {name:22} on the circle to {off:.1e}, radial speed to {approach:.1e} m/s, beyond it {beyond:.1e}, pull {pull:.1e} N, ledger to {imbalance:.1e}; {followed} steps followed, {flown} flown"
        );
        assert!(off < 1e-9, "{name}: {off:e}");
        assert!(beyond < 1e-9, "{name}: {beyond:e}");
        assert!(approach < 1e-9, "{name}: {approach:e}");
        // The switch is located on the step's interpolant: a last sliver of pull may remain.
        assert!(pull < 1e-3, "{name}: {pull:e}");
        assert!(imbalance < 1e-7, "{name}: {imbalance:e}");
        assert!(followed > 0 && flown > 0, "{name}: {followed} {flown}");
    }
}

#[test]
fn a_massless_link_displaces_the_crosshead_by_its_length_at_most() {
    let machine = with_model(
        with_clearance(0.0, CLEARANCE, 2e4),
        JointModel::MasslessLink,
    );
    let mut ideal = Dynamics::new(single_stage(), false);
    let mut run = Run::start(machine, 1e-10, false);
    let mut largest = 0.0_f64;
    for i in 0..2000 {
        let t = REVOLUTION * f64::from(i) / 500.0;
        run.advance(t);
        let place = ideal.evaluate(t, &[]).throws[0].motion.crosshead;
        let motion = run.now().throws[0].motion;
        // A link across the rod turns the rod a little: c / cos φ.
        let allowed = CLEARANCE / motion.rod_sin_cos.1;
        largest = largest.max((motion.crosshead - place).abs() / allowed);
    }
    eprintln!("massless link displaces the crosshead by {largest:.4} c/cos φ at most");
    assert!(largest <= 1.0 + 1e-9 && largest > 0.9, "{largest}");
}

/// Peak of the crosshead's acceleration and of the joints' forces in a settled revolution.
fn peaks(machine: Machine) -> [f64; 3] {
    let mut run = Run::start(machine, 1e-9, false);
    let mut peaks = [0.0_f64; 3];
    run.advance(20.0 * REVOLUTION);
    let mut y = run.integrator.state().to_vec();
    run.integrator
        .advance(&mut run.dynamics, 21.0 * REVOLUTION, |dynamics, step| {
            for i in 1..=8 {
                let share = f64::from(i) / 8.0;
                step.interpolate(share, &mut y);
                let at = dynamics.evaluate(step.start + share * step.length, &y);
                let (part, joints) = (&at.throws[0].accelerations, &at.throws[0].joints);
                let force = |joint: &JointState<f64>, rigid: f64| joint.force.norm() + rigid;
                for (peak, now) in peaks.iter_mut().zip([
                    part.crosshead.abs(),
                    force(&joints.big_end, part.big_force.norm()),
                    force(&joints.small_end, part.small_force.norm()),
                ]) {
                    *peak = peak.max(now);
                }
            }
        })
        .unwrap();
    peaks
}

#[test]
fn the_models_differ_in_their_peaks() {
    let clear = || with_clearance(CLEARANCE, CLEARANCE, 2e4);
    let rows = [
        ("ideal", single_stage()),
        (
            "massless link",
            with_model(clear(), JointModel::MasslessLink),
        ),
        ("two-mode", with_model(clear(), JointModel::TwoMode)),
        ("three-mode", clear()),
    ]
    .map(|(name, machine)| (name, peaks(machine)));
    eprintln!("both ends 0.2 mm:  acceleration m/s2, big end N, small end N");
    for (name, [acceleration, big, small]) in rows {
        eprintln!("{name:16} {acceleration:10.1} {big:10.0} {small:10.0}");
    }
    // The link has neither friction nor damping: its swings after reversals of the load never
    // die down, and pull with several times the load.
    let [ideal, clear @ ..] = rows.map(|(_, [acceleration, ..])| acceleration);
    assert!(clear.iter().all(|peak| *peak > 1.2 * ideal));
    assert!(clear[0] > clear[1] && clear[1] > clear[2]);
}
