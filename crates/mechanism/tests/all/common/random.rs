//! Random machines and random states for property tests.

use super::single_stage;
use integrate::System;
use mechanism::drive::{Drive, MotorLine};
use mechanism::effects::{
    BearingOvality, Effect, EmpiricalForce, End, GasPulsation, HeatTransfer, Joint, Law,
    Misalignment, Oval, Place, RingFriction, RingLeakage, RodFlexibility, RotatingUnbalance,
    Shaken, SqueezeFilm, SuctionUnloading, ValveFlutter, ValveLeakage, ValveLoss,
};
use mechanism::gas::CrankEnd;
use mechanism::joints::contact::{ContactLaw, Hertz, Impact, KelvinVoigt, Restitution};
use mechanism::joints::friction::{Adams, Ambrosio, Coulomb, FrictionLaw};
use mechanism::joints::guide::{Guide, GuideClearance};
use mechanism::joints::revolute::{Clearance, JointModel, Revolute};
use mechanism::{Direction, Dynamics, Machine, Throw};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Every model of a joint.
pub const MODELS: &[JointModel] = &[
    JointModel::ThreeMode,
    JointModel::TwoMode,
    JointModel::MasslessLink,
];

/// How many random numbers in [-1, 1] a random state wants.
pub const SEEDS: usize = 23;

/// So many cases, the same in every run.
pub fn cases(number: u32) -> ProptestConfig {
    ProptestConfig {
        cases: number,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(20_251_121),
        max_shrink_iters: 40,
        ..ProptestConfig::default()
    }
}

/// A contact law of any kind.
pub fn contact() -> impl Strategy<Value = ContactLaw> {
    let restitution = |e| Restitution {
        stiffness: 2e10,
        exponent: 1.5,
        restitution: e,
        slowest_approach: 1e-3,
    };
    prop_oneof![
        (1e10..8e10, 1.4..1.7, 5e2..3e4, 5e-6..3e-5).prop_map(|(stiffness, exponent, c, depth)| {
            ContactLaw::Impact(Impact {
                stiffness,
                exponent,
                damping: c,
                depth,
            })
        }),
        (1e10..8e10).prop_map(|stiffness| ContactLaw::Hertz(Hertz {
            stiffness,
            exponent: 1.5
        })),
        (5e7..4e8, 1e3..2e4).prop_map(|(stiffness, damping)| ContactLaw::KelvinVoigt(
            KelvinVoigt { stiffness, damping }
        )),
        (0.3..0.95).prop_map(move |e| ContactLaw::HuntCrossley(restitution(e))),
        (0.3..0.95).prop_map(move |e| ContactLaw::LankaraniNikravesh(restitution(e))),
        (0.3..0.95).prop_map(move |e| ContactLaw::Flores(restitution(e))),
    ]
}

/// A friction law of any kind.
pub fn friction() -> impl Strategy<Value = FrictionLaw> {
    prop_oneof![
        Just(FrictionLaw::none()),
        (0.01..0.1, 0.005..0.05).prop_map(|(coefficient, slip_speed)| {
            FrictionLaw::Coulomb(Coulomb {
                coefficient,
                slip_speed,
            })
        }),
        (0.02..0.1).prop_map(|coefficient| FrictionLaw::Adams(Adams {
            static_coefficient: 1.5 * coefficient,
            dynamic_coefficient: coefficient,
            stiction_speed: 0.02,
            transition_speed: 0.1,
        })),
        (0.01..0.1).prop_map(|coefficient| FrictionLaw::Ambrosio(Ambrosio {
            coefficient,
            slow: 0.01,
            fast: 0.1,
        })),
    ]
}

/// A joint of any of the given models, or an ideal one.
pub fn joint(models: &'static [JointModel]) -> impl Strategy<Value = Revolute> {
    let clear = (
        5e-5..4e-4,
        0.03..0.06,
        contact(),
        friction(),
        proptest::sample::select(models),
    )
        .prop_map(|(clearance, journal_radius, contact, friction, model)| {
            Revolute::Clear(Clearance {
                clearance,
                journal_radius,
                contact,
                friction,
                model,
            })
        });
    prop_oneof![1 => Just(Revolute::Ideal), 3 => clear]
}

/// A guide with clearance, or an ideal one.
pub fn guide() -> impl Strategy<Value = Guide> {
    let clear = (5e-5..4e-4, contact(), friction()).prop_map(|(clearance, contact, friction)| {
        Guide::Clear(GuideClearance {
            clearance,
            half_length: 0.12,
            half_height: 0.08,
            contact,
            friction,
        })
    });
    prop_oneof![1 => Just(Guide::Ideal), 2 => clear]
}

fn throw(models: &'static [JointModel]) -> impl Strategy<Value = Throw> {
    let bodies = (6.0..20.0, 0.15..0.35, 0.3..1.0, 12.0..30.0, 0.08..0.3);
    let gas = (0.0..2e5, any::<bool>(), 0.015..0.05, 1.1..1.5);
    let place = (any::<bool>(), 0.0..std::f64::consts::TAU);
    (bodies, joint(models), joint(models), guide(), gas, place).prop_map(
        |(bodies, big_end, small_end, guide, gas, place)| {
            let mut throw = single_stage().throws.remove(0);
            throw.rod.mass = bodies.0;
            throw.rod.centre_of_mass = bodies.1;
            throw.rod.inertia = bodies.2;
            throw.crosshead.mass = bodies.3;
            throw.crosshead.inertia = bodies.4;
            throw.big_end = big_end;
            throw.small_end = small_end;
            throw.guide = guide;
            throw.cylinder.back = gas.0;
            throw.cylinder.crank_end = gas.1.then_some(CrankEnd {
                rod_radius: 0.02,
                clearance: 0.03,
            });
            throw.cylinder.head_clearance = gas.2;
            throw.cylinder.expansion_exponent = gas.3;
            if place.0 {
                throw.direction = Direction::Opposed;
            }
            throw.pin_angle = place.1;
            throw
        },
    )
}

fn effects() -> impl Strategy<Value = Vec<Effect>> {
    let rings = Law::RingFriction(RingFriction {
        coulomb_force: 30.0,
        per_pressure: 2e-4,
        slip_speed: 0.02,
        viscous: 0.0,
    });
    let valves = Law::ValveLoss(ValveLoss {
        suction: 0.1,
        discharge: 0.2,
        suction_linear: 0.0,
        discharge_linear: 0.0,
        suction_overshoot: 0.0,
        discharge_overshoot: 0.0,
        overshoot_angle: 0.2,
    });
    let all = [rings, valves].map(Law::everywhere).to_vec();
    proptest::sample::subsequence(all, 0..=2)
}

/// One of every effect that acts in the equations, each at one of its places.
pub fn catalogue() -> Vec<Effect> {
    let at = |law: Law, joint, end| Effect {
        law,
        place: Place {
            throw: None,
            joint,
            end,
        },
    };
    vec![
        at(
            Law::ValveLoss(ValveLoss {
                suction: 0.1,
                discharge: 0.2,
                suction_linear: 0.02,
                discharge_linear: 0.03,
                suction_overshoot: 0.05,
                discharge_overshoot: 0.04,
                overshoot_angle: 0.3,
            }),
            None,
            None,
        ),
        at(
            Law::RingFriction(RingFriction {
                coulomb_force: 30.0,
                per_pressure: 2e-4,
                slip_speed: 0.02,
                viscous: 4.0,
            }),
            None,
            None,
        ),
        at(
            Law::SuctionUnloading(SuctionUnloading {
                held: 0.9,
                loss: 0.1,
            }),
            None,
            Some(End::Head),
        ),
        at(
            Law::RingLeakage(RingLeakage {
                area: 5e-6,
                gas_speed: 290.0,
                critical_ratio: 0.4,
                laminar: 0.3,
                behind: 0.0,
            }),
            None,
            None,
        ),
        at(
            Law::ValveLeakage(ValveLeakage {
                suction: 2e-6,
                discharge: 1e-6,
                gas_speed: 290.0,
                critical_ratio: 0.5,
                laminar: 0.1,
            }),
            None,
            Some(End::Head),
        ),
        at(
            Law::HeatTransfer(HeatTransfer {
                stanton: 0.02,
                wall_temperature: 1.2,
            }),
            None,
            None,
        ),
        at(
            Law::GasPulsation(GasPulsation {
                order: 3.0,
                suction: 0.02,
                suction_phase: 0.4,
                discharge: 0.05,
                discharge_phase: 1.1,
            }),
            None,
            None,
        ),
        at(
            Law::ValveFlutter(ValveFlutter {
                natural_frequency: 300.0,
                damping_ratio: 0.1,
                suction: 0.04,
                discharge: 0.06,
            }),
            None,
            None,
        ),
        at(
            Law::RotatingUnbalance(RotatingUnbalance {
                eccentricity: 1e-3,
                phase: 0.7,
                body: Shaken::Frame,
            }),
            None,
            None,
        ),
        at(
            Law::RotatingUnbalance(RotatingUnbalance {
                eccentricity: 2e-3,
                phase: 0.1,
                body: Shaken::Crosshead,
            }),
            None,
            None,
        ),
        at(
            Law::Misalignment(Misalignment {
                first: 200.0,
                first_phase: 0.3,
                second: 100.0,
                second_phase: 1.9,
                third: 60.0,
                third_phase: -0.4,
                load_exponent: 0.5,
            }),
            None,
            None,
        ),
        at(
            Law::RodFlexibility(RodFlexibility {
                compliance: 5e-9,
                damping_ratio: 0.02,
                hardening: 0.5,
            }),
            None,
            None,
        ),
        at(
            Law::SqueezeFilm(SqueezeFilm {
                viscosity: 0.02,
                length: 2e-3,
                roughness: 0.1,
                separation: 0.4,
                long: 0.3,
            }),
            Some(Joint::SmallEnd),
            None,
        ),
        at(
            Law::BearingOvality(BearingOvality {
                amplitude: 2e-5,
                direction: 0.6,
                oval: Oval::Bearing,
                lobes: 4e-6,
                lobes_direction: 0.5,
                growth: 0.3,
            }),
            Some(Joint::BigEnd),
            None,
        ),
        at(
            Law::BearingOvality(BearingOvality {
                amplitude: 1e-5,
                direction: 2.0,
                oval: Oval::Journal,
                lobes: 4e-6,
                lobes_direction: 0.5,
                growth: 0.3,
            }),
            None,
            None,
        ),
        at(
            Law::EmpiricalForce(EmpiricalForce {
                constant: 40.0,
                cosines: [50.0, -30.0, 20.0, 10.0],
                sines: [-20.0, 40.0, 10.0, -10.0],
                displacement: [100.0, 60.0],
                velocity: [-10.0, -3.0, 0.2],
                friction: [-60.0, -10.0, -20.0],
                slip_speed: 0.05,
                acceleration: 2.0,
                gas_force: 15.0,
                offsets: [30.0, -40.0],
            }),
            None,
            None,
        ),
    ]
}

/// A machine with some of all the effects.
pub fn machine_with_effects(models: &'static [JointModel]) -> impl Strategy<Value = Machine> {
    let all = catalogue();
    let some = proptest::sample::subsequence(all.clone(), 0..=all.len());
    (machine(models), some).prop_map(|(mut machine, effects)| {
        machine.effects = effects;
        machine
    })
}

/// A machine of one or two throws whose joints are of the given models, on a free crank or not,
/// in any direction of gravity.
pub fn machine(models: &'static [JointModel]) -> impl Strategy<Value = Machine> {
    let throws = proptest::collection::vec(throw(models), 1..=2);
    let shaft = (30.0..100.0, 4.0..12.0, 0.0..0.03);
    (
        throws,
        joint(models),
        shaft,
        any::<bool>(),
        0.0..std::f64::consts::TAU,
        effects(),
    )
        .prop_map(|(throws, main, shaft, free, down, effects)| {
            let mut machine = single_stage();
            machine.throws = throws;
            machine.main = main;
            machine.crankshaft.mass = shaft.0;
            machine.crankshaft.inertia = shaft.1;
            machine.crankshaft.eccentricity = shaft.2;
            (machine.gravity_x, machine.gravity_y) = (9.81 * down.cos(), 9.81 * down.sin());
            machine.effects = effects;
            if free {
                machine.drive = Drive::Free(MotorLine {
                    reference_speed: super::SPEED,
                    mean_torque: 60.0,
                    slope: 40.0,
                });
            }
            machine
        })
}

/// Switches into the mode that `(t, y)` calls for. A rigid joint beyond its clearance whose force
/// would pull has none; there any mode serves.
pub fn settle(dynamics: &mut Dynamics<f64>, t: f64, y: &mut [f64]) {
    let mut guards = vec![0.0; dynamics.guard_count()];
    for _ in 0..5 {
        for guard in 0..guards.len() {
            dynamics.guards(t, y, &mut guards);
            if guards[guard] <= 0.0 {
                dynamics.switch(guard, t, y);
            }
        }
    }
}

/// A state with offsets up to 1.2 clearances and rates up to 0.3 m/s.
pub fn random_state(dynamics: &Dynamics<f64>, seeds: &[f64]) -> Vec<f64> {
    let machine = dynamics.machine();
    let mut y = dynamics.initial_state();
    let mut next = seeds.iter().copied().cycle();
    let mut one = || next.next().unwrap();
    let mut place = |at: Option<usize>, sizes: [f64; 2]| {
        if let Some(i) = at {
            for (j, size) in sizes.into_iter().enumerate() {
                y[i + j] = 1.2 * size * one();
                y[i + 2 + j] = 0.3 * size / sizes[0] * one();
            }
        }
    };
    let clearance = |joint: &Revolute| joint.clear().map_or(0.0, |c| c.clearance);
    let layout = dynamics.layout();
    place(layout.main, [clearance(&machine.main); 2]);
    for (throw, at) in machine.throws.iter().zip(&layout.throws) {
        place(at.big_end, [clearance(&throw.big_end); 2]);
        place(at.small_end, [clearance(&throw.small_end); 2]);
        if let Guide::Clear(guide) = &throw.guide {
            place(
                at.guide,
                [guide.clearance, guide.clearance / guide.half_length],
            );
        }
    }
    for at in &layout.throws {
        if let Some(i) = at.rod {
            y[i] = 1e-4 * one();
            y[i + 1] = 0.1 * one();
        }
        if let Some(i) = at.gas {
            y[i] = 0.05 * one();
            y[i + 1] = 0.05 * one();
        }
    }
    if let (Some(i), Drive::Free(_)) = (layout.crank, &machine.drive) {
        y[i] = one();
        y[i + 1] = one();
    }
    y
}
