//! Linear and angular momentum at random states of random machines: a contact acts on both bodies
//! equally and at one point, so that only what acts from outside changes the momentum.

use crate::common;

use common::random::{MODELS, SEEDS, cases, machine, random_state, settle};
use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::{JointModel, Revolute};
use mechanism::plane::{Vec2, moment, turned};
use mechanism::{Direction, Dynamics, Evaluation, Machine};
use proptest::prelude::*;

/// Sums over the machine's bodies and over the forces from outside, in the machine's frame; and
/// the sum of the sizes of the terms, to measure round-off by.
struct Balance {
    /// Rate of the linear momentum, N.
    momentum_rate: Vec2<f64>,
    /// Rate of the angular momentum about the origin, N m.
    spin_rate: f64,
    weight: Vec2<f64>,
    /// Forces of main bearing, guides and gas.
    outside: Vec2<f64>,
    /// Moments of all forces from outside, the drive's torque included, about the origin.
    moment: f64,
    size: f64,
}

impl Balance {
    fn at(machine: &Machine, at: &Evaluation<f64>) -> Self {
        let zero = Vec2::new(0.0, 0.0);
        let mut sum = Balance {
            momentum_rate: zero,
            spin_rate: 0.0,
            weight: zero,
            outside: zero,
            moment: at.shaft.torque,
            size: at.shaft.torque.abs(),
        };
        let gravity = Vec2::new(machine.gravity_x, machine.gravity_y);
        let shaft = &machine.crankshaft;
        let (w, dw) = (at.speed, at.shaft.angular);
        let (s, c) = at.angle.sin_cos();
        let lever = Vec2::new(c, s) * shaft.eccentricity;
        let central = shaft.inertia - shaft.mass * shaft.eccentricity.powi(2);
        let turning = |arm: Vec2<f64>, w: f64, dw: f64| turned(arm) * dw - arm * (w * w);
        sum.body(
            shaft.mass,
            at.main.offset + lever,
            at.shaft.centre + turning(lever, w, dw),
            central * dw,
            gravity,
        );
        // Where the journal's surface touches the frame's; a massless link acts at the centre.
        let surface = match &machine.main {
            Revolute::Clear(clear) if clear.model != JointModel::MasslessLink => {
                at.main.normal * clear.journal_radius
            }
            _ => zero,
        };
        sum.force(at.main.offset + surface, at.shaft.bearing_force);

        for (throw, part) in machine.throws.iter().zip(&at.throws) {
            // An opposed throw's frame is turned by half a revolution; moments stay.
            let sign = match throw.direction {
                Direction::Forward => 1.0,
                Direction::Opposed => -1.0,
            };
            let (motion, found) = (&part.motion, &part.accelerations);
            let along = Vec2::new(motion.rod_sin_cos.1, motion.rod_sin_cos.0);
            let eye_acceleration =
                at.shaft.centre * sign + turning(motion.pin, w, dw) - found.big_end;
            let arm = along * throw.rod.centre_of_mass;
            let rod = &throw.rod;
            sum.body(
                rod.mass,
                (motion.big_eye[0] + arm) * sign,
                (eye_acceleration + turning(arm, motion.rod_rate, found.rod)) * sign,
                rod.inertia * found.rod,
                gravity,
            );
            let guide = &part.joints.guide;
            let pin = Vec2::new(motion.crosshead, guide.position.x);
            sum.body(
                throw.crosshead.mass,
                pin * sign,
                Vec2::new(found.crosshead, found.guide.x) * sign,
                match throw.guide {
                    Guide::Ideal => 0.0,
                    Guide::Clear(_) => throw.crosshead.inertia * found.guide.y,
                },
                gravity,
            );
            let along_x = Vec2::new(part.gas.force + part.gas.effects, 0.0);
            sum.force(pin * sign, (along_x + guide.force) * sign);
            sum.moment += guide.moment;
        }
        sum
    }

    fn body(
        &mut self,
        mass: f64,
        place: Vec2<f64>,
        acceleration: Vec2<f64>,
        spin_rate: f64,
        gravity: Vec2<f64>,
    ) {
        let rate = acceleration * mass;
        self.momentum_rate += rate;
        self.spin_rate += moment(place, rate) + spin_rate;
        self.weight += gravity * mass;
        self.moment += moment(place, gravity) * mass;
        self.size += rate.norm() + spin_rate.abs();
    }

    fn force(&mut self, place: Vec2<f64>, force: Vec2<f64>) {
        self.outside += force;
        self.moment += moment(place, force);
        self.size += force.norm();
    }
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn only_outside_forces_change_the_momentum(
        machine in machine(MODELS),
        t in 0.0..0.12_f64,
        seeds in proptest::collection::vec(-1.0..1.0_f64, SEEDS),
    ) {
        let mut dynamics = Dynamics::new(machine.clone(), false);
        let mut y = random_state(&dynamics, &seeds);
        settle(&mut dynamics, t, &mut y);
        let at = dynamics.evaluate(t, &y).clone();
        let sum = Balance::at(&machine, &at);

        let linear = (sum.momentum_rate - sum.weight - sum.outside).norm() / sum.size;
        prop_assert!(linear < 1e-13, "linear: {linear:e}");
        let angular = (sum.spin_rate - sum.moment).abs() / sum.size;
        prop_assert!(angular < 1e-13, "angular: {angular:e}");
        // The frame takes the reaction of all that is outside.
        let frame = (at.frame_force + sum.momentum_rate - sum.weight).norm() / sum.size;
        prop_assert!(frame < 1e-13, "frame: {frame:e}");
    }
}

#[test]
fn rod_and_crosshead_in_free_contact_keep_their_momentum() {
    // Big end apart, crosshead between its faces, no gas, no weight: rod and crosshead act on
    // each other alone, through the small end.
    let mut machine = common::with_clearance(4e-4, 2e-4, 2e4);
    let Revolute::Clear(pin) = common::joint(2e-4, 0.05, 2.4e10, 2e4) else {
        unreachable!()
    };
    let throw = &mut machine.throws[0];
    throw.cylinder.piston_radius = 0.0;
    throw.guide = Guide::Clear(mechanism::joints::guide::GuideClearance {
        clearance: 4e-4,
        half_length: 0.12,
        half_height: 0.08,
        contact: pin.contact,
        friction: pin.friction,
    });
    (machine.gravity_x, machine.gravity_y) = (0.0, 0.0);
    let mut dynamics = Dynamics::new(machine.clone(), false);
    let layout = dynamics.layout().throws[0];
    let mut worst = 0.0_f64;
    for i in 0..200 {
        let gamma = 0.1 * f64::from(i);
        let t = 0.0006 * f64::from(i) + 1e-4;
        let mut y = dynamics.initial_state();
        let (big, small, guide) = (
            layout.big_end.unwrap(),
            layout.small_end.unwrap(),
            layout.guide.unwrap(),
        );
        y[big..big + 4].copy_from_slice(&[1e-4, -1e-4, 0.1, 0.2]);
        let depth = 2e-4 + 1e-5 * f64::from(i % 7 + 1);
        let (sine, cosine) = gamma.sin_cos();
        let (inward, slip) = (0.02, 0.2 * (3.0 * gamma).sin());
        y[small..small + 4].copy_from_slice(&[
            depth * cosine,
            depth * sine,
            inward * cosine - slip * sine,
            inward * sine + slip * cosine,
        ]);
        y[guide..guide + 4].copy_from_slice(&[1e-4, 3e-4, -0.05, 0.3]);
        settle(&mut dynamics, t, &mut y);
        let at = dynamics.evaluate(t, &y);
        let part = &at.throws[0];
        assert!(part.joints.small_end.normal_force > 0.0);
        assert_eq!(part.joints.big_end.normal_force, 0.0);
        assert_eq!(part.joints.guide.force.norm(), 0.0);

        // Shaft and frame take part in nothing: leave the shaft's own terms out.
        let mut loose = machine.clone();
        loose.crankshaft.mass = 0.0;
        loose.crankshaft.inertia = 0.0;
        let mut isolated = at.clone();
        isolated.shaft.bearing_force = Vec2::new(0.0, 0.0);
        isolated.shaft.torque = 0.0;
        let sum = Balance::at(&loose, &isolated);
        worst = worst
            .max(sum.momentum_rate.norm() / sum.size)
            .max(sum.spin_rate.abs() / sum.size);
    }
    eprintln!("free contact: {worst:.1e} of the forces");
    assert!(worst < 1e-14, "{worst:e}");
}
