//! The machine with every joint ideal, against Newton and Euler written out by hand for this test:
//! positions, rates, accelerations, joint forces, guide, torque and main bearing.

use crate::common;

use common::{Run, SPEED, single_stage};
use mechanism::drive::{Drive, Fluctuation, GivenSpeed, MotorLine};
use mechanism::gas::CrankEnd;
use mechanism::{Direction, Evaluation, Machine, Throw};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// What the hand calculation of one throw gives, in the throw's own frame (x to its head).
struct Hand {
    position: f64,
    velocity: f64,
    acceleration: f64,
    rod_rate: f64,
    rod_acceleration: f64,
    /// Force of the crank pin on the rod.
    big: [f64; 2],
    /// Force of the crosshead pin on the rod.
    small: [f64; 2],
    /// Force of the guide on the crosshead, along y.
    guide: f64,
    gas: f64,
    /// Moment of the rod on the crank about the shaft's axis, turned round: what drives the throw.
    torque: f64,
}

/// The throw with its crank at `alpha` since top dead centre, `w` and `dw` its rates, under gravity
/// `g` in the throw's frame.
fn by_hand(throw: &Throw, alpha: f64, w: f64, dw: f64, g: [f64; 2]) -> Hand {
    let (r, l) = (throw.crank_radius, throw.rod.length);
    let (a, m, i) = (throw.rod.centre_of_mass, throw.rod.mass, throw.rod.inertia);
    let ms = throw.crosshead.mass;
    let (s, c) = alpha.sin_cos();
    // The rod's angle from R sin α + L sin φ = 0, and its derivatives.
    let sp = -r * s / l;
    let cp = (1.0 - sp * sp).sqrt();
    let p1 = -r * c * w / (l * cp);
    let p2 = (r * (s * w * w - c * dw) + l * sp * p1 * p1) / (l * cp);
    let position = r * c + l * cp;
    let velocity = -r * s * w - l * sp * p1;
    let acceleration = -r * (c * w * w + s * dw) - l * (cp * p1 * p1 + sp * p2);
    // The rod's centre of mass.
    let ax = -r * (c * w * w + s * dw) - a * (cp * p1 * p1 + sp * p2);
    let ay = r * (-s * w * w + c * dw) + a * (-sp * p1 * p1 + cp * p2);

    let gas = gas_by_hand(throw, alpha, position);
    // Crosshead along x; then the rod's moment about the crank pin; then the rod's forces.
    let small_x = gas + ms * g[0] - ms * acceleration;
    let moment_of_inertial = a * (cp * m * (ay - g[1]) - sp * m * (ax - g[0])) + i * p2;
    let small_y = (moment_of_inertial + l * sp * small_x) / (l * cp);
    let big = [m * (ax - g[0]) - small_x, m * (ay - g[1]) - small_y];
    Hand {
        position,
        velocity,
        acceleration,
        rod_rate: p1,
        rod_acceleration: p2,
        big,
        small: [small_x, small_y],
        guide: small_y - ms * g[1],
        gas,
        torque: r * (c * big[1] - s * big[0]),
    }
}

/// MODEL.md, sections 3 and 6.
fn gas_by_hand(throw: &Throw, alpha: f64, position: f64) -> f64 {
    let cylinder = &throw.cylinder;
    let (ps, pd, m) = (cylinder.suction, cylinder.discharge, cylinder.exponent);
    let expansion = cylinder.expansion_exponent;
    let (r, l) = (throw.crank_radius, throw.rod.length);
    let stroke = 2.0 * r;
    let outward = alpha.rem_euclid(TAU) < PI;
    let pressure = |dead: f64, x: f64, expanding: bool| {
        if expanding {
            (pd * (dead / x).powf(expansion)).clamp(ps, pd)
        } else {
            (ps * ((stroke + dead) / x).powf(m)).clamp(ps, pd)
        }
    };
    let face = PI * cylinder.piston_radius.powi(2);
    let s0 = cylinder.head_clearance;
    let head = pressure(s0, s0 + r + l - position, outward);
    match &cylinder.crank_end {
        None => (cylinder.back - head) * face,
        Some(end) => {
            let rod = PI * end.rod_radius.powi(2);
            let crank = pressure(end.clearance, end.clearance + position - (l - r), !outward);
            -head * face + crank * (face - rod) + cylinder.back * rod
        }
    }
}

/// Largest difference and largest size of each quantity.
#[derive(Default)]
struct Comparison(BTreeMap<&'static str, [f64; 2]>);

impl Comparison {
    fn add(&mut self, name: &'static str, ours: f64, hand: f64) {
        let [difference, size] = self.0.entry(name).or_default();
        *difference = difference.max((ours - hand).abs());
        *size = size.max(hand.abs());
    }

    fn check(&self, machine: &str) {
        for (name, [difference, size]) in &self.0 {
            let relative = difference / size.max(1e-9);
            eprintln!("{machine:24} {name:18} {relative:.1e}");
            assert!(relative < 1e-10, "{machine} {name}: {relative:e}");
        }
    }

    fn instant(&mut self, machine: &Machine, at: &Evaluation<f64>) {
        let g = [machine.gravity_x, machine.gravity_y];
        let shaft = &machine.crankshaft;
        let (s, c) = at.angle.sin_cos();
        let (w, dw) = (at.speed, at.shaft.angular);
        // The shaft: bearing + pins + weight = mass × acceleration; torque about its axis.
        let lever = shaft.mass * shaft.eccentricity;
        let mut bearing = [
            lever * (-c * w * w - s * dw) - shaft.mass * g[0],
            lever * (-s * w * w + c * dw) - shaft.mass * g[1],
        ];
        let mut torque = shaft.inertia * dw - lever * (c * g[1] - s * g[0]);
        let mut frame = [0.0; 2];
        for (throw, part) in machine.throws.iter().zip(&at.throws) {
            let (sign, shift) = match throw.direction {
                Direction::Forward => (1.0, 0.0),
                Direction::Opposed => (-1.0, -PI),
            };
            let local = g.map(|v| sign * v);
            let hand = by_hand(throw, at.angle + throw.pin_angle + shift, w, dw, local);
            let (motion, found) = (&part.motion, &part.accelerations);
            self.add("position", motion.crosshead, hand.position);
            self.add("velocity", motion.crosshead_rate, hand.velocity);
            self.add("acceleration", found.crosshead, hand.acceleration);
            self.add("rod rate", motion.rod_rate, hand.rod_rate);
            self.add("rod acceleration", found.rod, hand.rod_acceleration);
            self.add("gas force", part.gas.force, hand.gas);
            self.add("big end x", found.big_force.x, hand.big[0]);
            self.add("big end y", found.big_force.y, hand.big[1]);
            self.add("small end x", found.small_force.x, hand.small[0]);
            self.add("small end y", found.small_force.y, hand.small[1]);
            self.add("guide", part.joints.guide.force.y, hand.guide);
            for i in 0..2 {
                bearing[i] += sign * hand.big[i];
                frame[i] -= sign * [hand.gas, hand.guide][i];
            }
            torque += hand.torque;
        }
        self.add("bearing x", at.shaft.bearing_force.x, bearing[0]);
        self.add("bearing y", at.shaft.bearing_force.y, bearing[1]);
        self.add("crank torque", at.shaft.torque, torque);
        self.add("frame x", at.frame_force.x, frame[0] - bearing[0]);
        self.add("frame y", at.frame_force.y, frame[1] - bearing[1]);
    }
}

fn check(name: &str, machine: Machine) {
    let mut comparison = Comparison::default();
    let mut run = Run::start(machine.clone(), 1e-12, false);
    // No instant falls on a dead centre, where the gas may be on either side of its change.
    for i in 0..400 {
        run.advance(0.12 * (f64::from(i) + 0.37) / 397.3);
        let at = run.now().clone();
        comparison.instant(&machine, &at);
    }
    comparison.check(name);
}

#[test]
fn horizontal_single_acting() {
    check("horizontal", single_stage());
}

#[test]
fn vertical_with_an_eccentric_shaft() {
    let mut machine = single_stage();
    (machine.gravity_x, machine.gravity_y) = (-9.81, 0.0);
    machine.crankshaft.eccentricity = 0.02;
    check("vertical, eccentric", machine);
}

fn two_throws() -> Machine {
    let mut machine = single_stage();
    (machine.gravity_x, machine.gravity_y) = (-3.0, -9.3);
    machine.throws[0].cylinder.back = 1e5;
    machine.throws[0].cylinder.crank_end = Some(CrankEnd {
        rod_radius: 0.02,
        clearance: 0.03,
    });
    let mut second = machine.throws[0].clone();
    second.direction = Direction::Opposed;
    second.pin_angle = 2.5;
    second.rod.mass = 9.0;
    second.crosshead.mass = 25.0;
    second.cylinder.piston_radius = 0.04;
    machine.throws.push(second);
    machine
}

#[test]
fn two_opposed_double_acting_throws() {
    check("two throws", two_throws());
}

#[test]
fn two_throws_on_a_free_crank() {
    let mut machine = two_throws();
    machine.crankshaft.eccentricity = 0.015;
    machine.drive = Drive::Free(MotorLine {
        reference_speed: SPEED,
        mean_torque: 120.0,
        slope: 40.0,
    });
    // The hand calculation takes θ̈ from the program; with it the torque must be the motor's.
    check("two throws, free crank", machine);
}

#[test]
fn two_throws_at_a_speed_that_fluctuates() {
    let mut machine = two_throws();
    machine.crankshaft.eccentricity = 0.015;
    machine.crankshaft.inertia = 3.0;
    let harmonic = |amplitude, phase| Fluctuation { amplitude, phase };
    machine.drive = Drive::Given(GivenSpeed {
        speed: SPEED,
        fluctuation: vec![harmonic(0.03, 0.4), harmonic(0.02, -1.1)],
    });
    let mut run = Run::start(machine.clone(), 1e-12, false);
    run.advance(0.031);
    let at = run.now().clone();
    // θ = φ + 0.03 sin(φ + 0.4) + 0.01 sin(2 φ − 1.1), and its derivatives.
    let phi = SPEED * 0.031;
    let first = [phi + 0.4, 2.0 * phi - 1.1].map(f64::sin_cos);
    let [(s1, c1), (s2, c2)] = first;
    assert!((at.angle - (phi + 0.03 * s1 + 0.01 * s2)).abs() < 1e-12);
    assert!((at.speed / SPEED - (1.0 + 0.03 * c1 + 0.02 * c2)).abs() < 1e-12);
    let angular = -SPEED * SPEED * (0.03 * s1 + 0.04 * s2);
    assert!((at.shaft.angular / angular - 1.0).abs() < 1e-12);
    check("two throws, fluctuating", machine);
}
