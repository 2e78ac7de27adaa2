//! Effects on the frame, and through it on what is measured.

use super::{at_angles, ideal, near, order, revolution, size};
use crate::common::{REVOLUTION, Run, SPEED, single_stage, with_clearance};
use mechanism::effects::{Effect, Law, RotatingUnbalance, Shaken};
use mechanism::frame::Frame;
use mechanism::{Dynamics, Machine};
use std::f64::consts::TAU;

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
        hardening: 0.0,
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

/// Springs that harden: what the frame feels is what its equation of motion gives at its place.
#[test]
fn a_frame_hardens_with_the_square_of_its_displacement() {
    let (mass, frequency, hardening) = (450.0, 40.0, 0.7);
    let natural = TAU * frequency;
    let felt = |hardening: f64| {
        let mut machine = single_stage();
        machine.frame = Some(Frame {
            mass,
            stiffness_x: mass * natural * natural,
            stiffness_y: mass * natural * natural,
            damping_x: 0.0,
            damping_y: 0.0,
            hardening,
            carries: true,
        });
        let mut dynamics = Dynamics::new(machine, false);
        let state = dynamics.initial_state();
        let place = dynamics.layout().frame.unwrap();
        [0.0, 1e-4, -2e-4].map(|x| {
            let mut y = state.clone();
            y[place] = x;
            dynamics.evaluate(0.0, &y).throws[0].carried.x
        })
    };
    let (linear, hard) = (felt(0.0), felt(hardening));
    for (i, x) in [0.0, 1e-4, -2e-4_f64].into_iter().enumerate() {
        let spring = natural * natural * x;
        near(linear[i] - linear[0] + 1.0, 1.0 - spring, 1e-9);
        let stiffer = spring * hardening * (x / 1e-4).powi(2);
        near(hard[i] - linear[i] + 1.0, 1.0 - stiffer, 1e-9);
    }
}
