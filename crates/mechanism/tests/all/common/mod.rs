//! Machines for the tests, and runs of them.
#![allow(dead_code)] // The tests of crate simulate and the benches use some of it.

pub mod random;

use integrate::Integrator;
use mechanism::drive::{Drive, GivenSpeed, MotorLine};
use mechanism::gas::{CrankEnd, Cylinder};
use mechanism::joints::contact::{ContactLaw, Impact};
use mechanism::joints::friction::{Coulomb, FrictionLaw};
use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::{Clearance, JointModel, Revolute};
use mechanism::{Crankshaft, Crosshead, Direction, Dynamics, Machine, Rod, Throw};
use serde_json::Value;

/// 500 rpm in rad/s.
pub const SPEED: f64 = 500.0 * std::f64::consts::TAU / 60.0;
/// One revolution at 500 rpm, s.
pub const REVOLUTION: f64 = 0.12;

/// A compliant joint of MODEL.md section 5.
pub fn joint(clearance: f64, journal_radius: f64, stiffness: f64, damping: f64) -> Revolute {
    Revolute::Clear(Clearance {
        clearance,
        journal_radius,
        contact: ContactLaw::Impact(Impact {
            stiffness,
            exponent: 1.5,
            damping,
            depth: 1e-5,
        }),
        friction: FrictionLaw::Coulomb(Coulomb {
            coefficient: 0.05,
            slip_speed: 0.01,
        }),
        model: JointModel::ThreeMode,
    })
}

/// The single-stage machine of MODEL.md section 5 with both ends ideal.
pub fn single_stage() -> Machine {
    Machine {
        crankshaft: Crankshaft {
            mass: 60.0,
            inertia: 8.0,
            eccentricity: 0.0,
        },
        drive: Drive::Given(GivenSpeed {
            speed: SPEED,
            fluctuation: Vec::new(),
        }),
        main: Revolute::Ideal,
        throws: vec![Throw {
            crank_radius: 0.12,
            pin_angle: 0.0,
            rod: Rod {
                length: 0.6,
                mass: 12.0,
                centre_of_mass: 0.22,
                inertia: 0.6,
            },
            crosshead: Crosshead {
                mass: 18.0,
                inertia: 0.15,
            },
            cylinder: Cylinder {
                piston_radius: 0.05,
                suction: 0.105e6,
                discharge: 0.393e6,
                back: 0.0,
                exponent: 1.4,
                expansion_exponent: 1.4,
                head_clearance: 0.024,
                crank_end: None,
            },
            big_end: Revolute::Ideal,
            small_end: Revolute::Ideal,
            guide: Guide::Ideal,
            housing: None,
            name: String::new(),
            direction: Direction::Forward,
        }],
        gravity_x: 0.0,
        gravity_y: -9.81,
        frame: None,
        effects: Vec::new(),
    }
}

/// The same with the given radial clearances, m; 0 is ideal.
pub fn with_clearance(big: f64, small: f64, damping: f64) -> Machine {
    let mut machine = single_stage();
    if big > 0.0 {
        machine.throws[0].big_end = joint(big, 0.050, 2.40e10, damping);
    }
    if small > 0.0 {
        machine.throws[0].small_end = joint(small, 0.035, 2.00e10, damping);
    }
    machine
}

/// The machine that a case of reference.json describes.
pub fn reference_machine(parameters: &Value) -> Machine {
    let number = |v: &Value, key: &str| v[key].as_f64().unwrap();
    let mut machine = single_stage();
    let template = machine.throws.remove(0);
    for (i, p) in parameters["throws"].as_array().unwrap().iter().enumerate() {
        let end = |s: &str| {
            if number(p, if s == "B" { "bigclear" } else { "smallclear" }) == 0.0 {
                return Revolute::Ideal;
            }
            let of = |name: &str| number(p, &format!("{name}{s}"));
            Revolute::Clear(Clearance {
                clearance: of("c"),
                journal_radius: of("Rj"),
                contact: ContactLaw::Impact(Impact {
                    stiffness: of("K"),
                    exponent: of("n"),
                    damping: of("Cmax"),
                    depth: of("dmax"),
                }),
                friction: FrictionLaw::Coulomb(Coulomb {
                    coefficient: of("cf"),
                    slip_speed: of("vs"),
                }),
                model: JointModel::ThreeMode,
            })
        };
        let mut throw = template.clone();
        throw.name = format!("throw{}", i + 1);
        throw.crank_radius = number(p, "R");
        throw.pin_angle = number(p, "psi");
        throw.direction = if number(p, "sigma") < 0.0 {
            Direction::Opposed
        } else {
            Direction::Forward
        };
        throw.rod = Rod {
            length: number(p, "L"),
            mass: number(p, "mr"),
            centre_of_mass: number(p, "a"),
            inertia: number(p, "Ir"),
        };
        throw.crosshead.mass = number(p, "ms");
        let radius = |area: f64| (area / std::f64::consts::PI).sqrt();
        throw.cylinder = Cylinder {
            piston_radius: radius(number(p, "Ap")),
            suction: number(p, "ps"),
            discharge: number(p, "pd"),
            back: number(p, "pb"),
            exponent: number(p, "m"),
            expansion_exponent: number(p, "m"),
            head_clearance: number(p, "S0"),
            crank_end: (number(p, "da") != 0.0).then(|| CrankEnd {
                rod_radius: radius(number(p, "Arod")),
                clearance: number(p, "S0c"),
            }),
        };
        throw.big_end = end("B");
        throw.small_end = end("S");
        machine.throws.push(throw);
    }
    let drive = &parameters["drive"];
    if number(drive, "free") == 0.0 {
        machine.drive = Drive::Given(GivenSpeed {
            speed: number(drive, "omega"),
            fluctuation: Vec::new(),
        });
    } else {
        machine.crankshaft.inertia = number(drive, "J");
        machine.drive = Drive::Free(MotorLine {
            reference_speed: number(drive, "omega_ref"),
            mean_torque: number(drive, "T0"),
            slope: number(drive, "kT"),
        });
    }
    machine
}

/// A run in progress.
pub struct Run {
    pub dynamics: Dynamics<f64>,
    pub integrator: Integrator<f64>,
}

impl Run {
    pub fn start(machine: Machine, tolerance: f64, ledger: bool) -> Self {
        let mut dynamics = Dynamics::new(machine, ledger);
        let y = dynamics.initial_state();
        let integrator = Integrator::new(&mut dynamics, 0.0, &y, tolerance, REVOLUTION / 20.0);
        Self {
            dynamics,
            integrator,
        }
    }

    pub fn advance(&mut self, end: f64) {
        self.integrator.reach(&mut self.dynamics, end).unwrap();
    }

    /// Evaluates at the present time and state.
    pub fn now(&mut self) -> &mechanism::Evaluation<f64> {
        let y = self.integrator.state().to_vec();
        self.dynamics.evaluate(self.integrator.time(), &y)
    }
}

/// The file `name` under data/reference/trajectories.
pub fn reference_file(name: &str) -> String {
    let path = format!(
        "{}/../../data/reference/trajectories/{name}",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// reference.json.
pub fn reference() -> Value {
    serde_json::from_str(&reference_file("reference.json")).unwrap()
}
