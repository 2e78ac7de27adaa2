//! The crosshead in a guide with clearance: it settles on the lower face, its corners share the
//! weight and the tilting moment.

use crate::common;

use common::{REVOLUTION, Run, single_stage};
use mechanism::drive::{Drive, GivenSpeed};
use mechanism::joints::contact::{ContactLaw, KelvinVoigt};
use mechanism::joints::friction::{Coulomb, FrictionLaw};
use mechanism::joints::guide::{Guide, GuideClearance};
use mechanism::{Dynamics, Machine};

const CLEARANCE: f64 = 2e-4;
const HALF_LENGTH: f64 = 0.12;
const HALF_HEIGHT: f64 = 0.08;
const STIFFNESS: f64 = 2e8;
const FRICTION: f64 = 0.1;

// Corners: upper rear, upper front, lower rear, lower front.
const REAR: usize = 2;
const FRONT: usize = 3;

fn guide(friction: FrictionLaw) -> Guide {
    Guide::Clear(GuideClearance {
        clearance: CLEARANCE,
        half_length: HALF_LENGTH,
        half_height: HALF_HEIGHT,
        contact: ContactLaw::KelvinVoigt(KelvinVoigt {
            stiffness: STIFFNESS,
            damping: 2e4,
        }),
        friction,
    })
}

/// The single-stage machine without gas, turning slowly, with a clear guide.
fn slow(speed: f64, friction: FrictionLaw) -> Machine {
    let mut machine = single_stage();
    machine.drive = Drive::Given(GivenSpeed {
        speed,
        fluctuation: Vec::new(),
    });
    machine.throws[0].cylinder.piston_radius = 0.0;
    machine.throws[0].guide = guide(friction);
    machine
}

/// What the guide carries of a horizontal machine at rest: the crosshead and the small end's share
/// of the rod, N.
fn weight(machine: &Machine) -> f64 {
    let throw = &machine.throws[0];
    let share = throw.rod.centre_of_mass / throw.rod.length;
    -machine.gravity_y * (throw.crosshead.mass + throw.rod.mass * share)
}

fn corner_forces(dynamics: &Dynamics<f64>) -> [f64; 4] {
    let guide = dynamics.evaluation().throws[0].joints.guide;
    guide.corners.map(|corner| corner.normal_force)
}

#[test]
fn at_rest_the_lower_corners_share_the_weight() {
    let machine = slow(1e-4, FrictionLaw::none());
    let weight = weight(&machine);
    let mut run = Run::start(machine, 1e-10, true);
    run.now();
    let start = run.dynamics.energy().total();
    run.advance(0.3);
    let guide = run.now().throws[0].joints.guide;
    let forces = corner_forces(&run.dynamics);
    eprintln!(
        "corners {forces:.6?} N, half the weight {:.6} N",
        0.5 * weight
    );
    assert_eq!(forces[..REAR], [0.0, 0.0]);
    for force in &forces[REAR..] {
        assert!((force / (0.5 * weight) - 1.0).abs() < 1e-6, "{force}");
    }
    let sunk = CLEARANCE + 0.5 * weight / STIFFNESS;
    assert!((guide.position.x / -sunk - 1.0).abs() < 1e-9);
    assert!(guide.position.y.abs() < 1e-12);

    // What the fall set free is in the dampers, but for what the springs hold.
    let ledger = run.dynamics.layout().ledger.unwrap();
    let works = &run.integrator.state()[ledger..ledger + 4];
    let stored = run.dynamics.energy().total() - start;
    let missing = stored - works[0] - works[1] + works[2] + works[3];
    eprintln!(
        "ledger to {:.1e} of the fall's energy",
        missing / (weight * CLEARANCE)
    );
    assert!(missing.abs() < 1e-9 * weight * CLEARANCE);
    assert!(works[3] > 0.9 * weight * CLEARANCE);
}

#[test]
fn in_a_vertical_machine_the_guide_carries_no_weight() {
    let mut machine = slow(1e-4, FrictionLaw::none());
    (machine.gravity_x, machine.gravity_y) = (-9.81, 0.0);
    let mut run = Run::start(machine, 1e-10, false);
    run.advance(0.05);
    run.now();
    assert_eq!(corner_forces(&run.dynamics), [0.0; 4]);
}

#[test]
fn the_corner_ahead_carries_the_moment_of_the_friction() {
    let friction = FrictionLaw::Coulomb(Coulomb {
        coefficient: FRICTION,
        slip_speed: 1e-4,
    });
    let speed = 2.0;
    let mut run = Run::start(slow(speed, friction), 1e-10, false);
    // Down the first half of the stroke, back up the second: at mid-stroke twice.
    for (turns, ahead, behind) in [(0.25, REAR, FRONT), (0.75, FRONT, REAR)] {
        run.advance(turns * std::f64::consts::TAU / speed);
        run.now();
        let forces = corner_forces(&run.dynamics);
        let both = forces[ahead] + forces[behind];
        // Friction μN acts h below the pin; the normal forces act l before and behind it.
        let expected = FRICTION * both * HALF_HEIGHT / HALF_LENGTH;
        let found = forces[ahead] - forces[behind];
        eprintln!("at {turns} turns: {found:.5} N more on the corner ahead ({expected:.5})");
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        assert_eq!(forces[..REAR], [0.0, 0.0]);
    }
}

#[test]
fn the_face_that_the_ideal_guide_presses_on_carries_the_load() {
    let mut machine = single_stage();
    let mut guide = guide(FrictionLaw::none());
    // Little play and much damping: the crosshead soon follows the face.
    if let Guide::Clear(clear) = &mut guide {
        clear.clearance = 1e-5;
        clear.contact = ContactLaw::KelvinVoigt(KelvinVoigt {
            stiffness: STIFFNESS,
            damping: 6e4,
        });
    }
    machine.throws[0].guide = guide;
    let mut ideal = Dynamics::new(single_stage(), false);
    let mut run = Run::start(machine, 1e-9, false);
    let (mut same, mut asked) = (0, 0);
    let (mut clear_sum, mut ideal_sum) = (0.0, 0.0);
    for i in 0..2000 {
        let t = REVOLUTION * (5.0 + f64::from(i) / 1000.0) + 1e-7;
        run.advance(t);
        run.now();
        let forces = corner_forces(&run.dynamics);
        let gas = run.dynamics.evaluation().throws[0].gas.force;
        let wanted = ideal_guide_force(&mut ideal, t, gas);
        let lower = forces[REAR] + forces[FRONT];
        let upper = forces[0] + forces[1];
        clear_sum += lower - upper;
        ideal_sum += wanted;
        if wanted.abs() > 300.0 {
            asked += 1;
            same += i32::from((lower - upper) * wanted > 0.0);
        }
    }
    eprintln!(
        "{same} of {asked} on the ideal guide's face; mean {:.2} N, ideal {:.2} N",
        clear_sum / 2000.0,
        ideal_sum / 2000.0
    );
    assert!(asked > 500 && same * 100 > asked * 95, "{same} of {asked}");
    assert!((clear_sum / ideal_sum - 1.0).abs() < 0.02);
}

/// The ideal guide's force along y at `t` under the gas force `gas`.
fn ideal_guide_force(ideal: &mut Dynamics<f64>, t: f64, gas: f64) -> f64 {
    let part = ideal.evaluate(t, &[]).throws[0];
    let (sine, cosine) = part.motion.rod_sin_cos;
    part.joints.guide.force.y + (gas - part.gas.force) * sine / cosine
}
