//! The motion itself, as no sensor sees it: for pictures and checks.

use mechanism::joints::revolute::{JointState, Revolute};
use mechanism::{Evaluation, Machine};
use std::f64::consts::TAU;

/// Poses, rates and forces at the rate at which the motion is sampled before decimation.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Entries per recorded sample: entry `i * stride` belongs to sample `i`.
    pub stride: usize,
    /// Crank angle in [0, 2π), rad.
    pub crank_angle: Vec<f64>,
    /// Its rate, rad/s.
    pub crank_speed: Vec<f64>,
    /// Its second rate, rad/s².
    pub crank_acceleration: Vec<f64>,
    /// Torque of the drive on the shaft, N m.
    pub torque: Vec<f64>,
    /// The main bearing, where it has clearance.
    pub main: Option<JointTrace>,
    /// Each throw.
    pub throws: Vec<ThrowTrace>,
}

/// One throw.
#[derive(Clone, Debug, Default)]
pub struct ThrowTrace {
    /// Position of the crosshead pin, m.
    pub position: Vec<f64>,
    /// Its speed, m/s.
    pub velocity: Vec<f64>,
    /// Its acceleration, m/s².
    pub acceleration: Vec<f64>,
    /// Gas pressure at the head end, Pa.
    pub pressure: Vec<f64>,
    /// Gas pressure at the crank end, Pa; none where the cylinder is single acting.
    pub crank_end_pressure: Option<Vec<f64>>,
    /// Force of the gas on piston and crosshead toward the head, N.
    pub gas_force: Vec<f64>,
    /// Force of the effects on the crosshead toward the head, N.
    pub effects: Vec<f64>,
    /// The big end, where it has clearance.
    pub big_end: Option<JointTrace>,
    /// The small end, where it has clearance.
    pub small_end: Option<JointTrace>,
}

/// One joint with clearance.
#[derive(Clone, Debug)]
pub struct JointTrace {
    /// Radial clearance, m.
    pub clearance: f64,
    /// Offset of the journal along x, m.
    pub x: Vec<f64>,
    /// Offset of the journal along y, m.
    pub y: Vec<f64>,
    /// Normal contact force, N.
    pub normal_force: Vec<f64>,
    /// Friction, N.
    pub friction_force: Vec<f64>,
}

impl JointTrace {
    fn new(joint: &Revolute) -> Option<Self> {
        joint.clear().map(|clear| Self {
            clearance: clear.clearance,
            x: Vec::new(),
            y: Vec::new(),
            normal_force: Vec::new(),
            friction_force: Vec::new(),
        })
    }

    fn push(&mut self, at: &JointState<f64>) {
        self.x.push(at.offset.x);
        self.y.push(at.offset.y);
        self.normal_force.push(at.normal_force);
        self.friction_force.push(at.friction_force);
    }
}

impl Trace {
    pub(crate) fn new(machine: &Machine, stride: usize) -> Self {
        Self {
            stride,
            main: JointTrace::new(&machine.main),
            throws: machine
                .throws
                .iter()
                .map(|throw| ThrowTrace {
                    big_end: JointTrace::new(&throw.big_end),
                    small_end: JointTrace::new(&throw.small_end),
                    crank_end_pressure: throw.cylinder.crank_end.as_ref().map(|_| Vec::new()),
                    ..ThrowTrace::default()
                })
                .collect(),
            ..Self::default()
        }
    }

    pub(crate) fn push(&mut self, at: &Evaluation<f64>) {
        self.crank_angle.push(at.angle.rem_euclid(TAU));
        self.crank_speed.push(at.speed);
        self.crank_acceleration.push(at.shaft.angular);
        self.torque.push(at.shaft.torque);
        if let Some(main) = &mut self.main {
            main.push(&at.main);
        }
        for (trace, throw) in self.throws.iter_mut().zip(&at.throws) {
            trace.position.push(throw.motion.crosshead);
            trace.velocity.push(throw.motion.crosshead_rate);
            trace.acceleration.push(throw.accelerations.crosshead);
            trace.pressure.push(throw.gas.head_end.pressure);
            if let Some(pressure) = &mut trace.crank_end_pressure {
                pressure.push(throw.gas.crank_end.pressure);
            }
            trace.gas_force.push(throw.gas.force);
            trace.effects.push(throw.gas.effects);
            if let Some(big) = &mut trace.big_end {
                big.push(&throw.joints.big_end);
            }
            if let Some(small) = &mut trace.small_end {
                small.push(&throw.joints.small_end);
            }
        }
    }
}
