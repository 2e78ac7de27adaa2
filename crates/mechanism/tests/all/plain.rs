//! A plain machine, whose equations are compiled by themselves, against the same machine with an effect
//! that does nothing: whether a machine is plain may not be seen.

use crate::common;

use common::{REVOLUTION, Run, joint, with_clearance};
use mechanism::effects::{Law, RingFriction};
use mechanism::gas::CrankEnd;
use mechanism::{Dynamics, Machine};

/// The same with rings of no friction.
fn not_plain(machine: &Machine) -> Machine {
    let rings = RingFriction {
        coulomb_force: 0.0,
        per_pressure: 0.0,
        slip_speed: 0.01,
        viscous: 0.0,
    };
    Machine {
        effects: vec![Law::RingFriction(rings).everywhere()],
        ..machine.clone()
    }
}

#[test]
fn a_plain_machine_moves_as_one_with_an_effect_that_does_nothing() {
    let both = with_clearance(3e-4, 2e-4, 2e4);
    let mut with_main = both.clone();
    with_main.main = joint(1e-4, 0.06, 2.6e10, 2e4);
    let mut big_alone = with_clearance(2e-4, 0.0, 2e4);
    big_alone.throws[0].cylinder.crank_end = Some(CrankEnd {
        rod_radius: 0.02,
        clearance: 0.03,
    });
    for machine in [both, with_main, big_alone] {
        let mut other = Dynamics::new(not_plain(&machine), false);
        let mut run = Run::start(machine, 1e-9, false);
        for i in 1..=60 {
            run.advance(f64::from(i) * 0.037 * REVOLUTION);
            let (t, y) = (run.integrator.time(), run.integrator.state().to_vec());
            other.mode_mut().clone_from(run.dynamics.mode());
            let found = run.dynamics.evaluate(t, &y).throws[0].accelerations;
            let expected = other.evaluate(t, &y).throws[0].accelerations;
            let pairs = [
                (found.crosshead, expected.crosshead),
                (found.big_end.x, expected.big_end.x),
                (found.big_end.y, expected.big_end.y),
                (found.small_end.x, expected.small_end.x),
                (found.small_end.y, expected.small_end.y),
                (found.rod, expected.rod),
            ];
            for (found, expected) in pairs {
                let off = (found - expected).abs();
                assert!(off <= 1e-12 * expected.abs().max(1.0), "{found} {expected}");
            }
        }
    }
}
