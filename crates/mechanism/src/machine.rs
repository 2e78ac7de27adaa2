//! The machine as plain data, SI units throughout.
//!
//! Every struct is generic over its number type: `Machine` (plain numbers) is what files are read
//! into; [`lift`](crate::lift) takes it over into dual numbers or lanes.

use crate::drive::Drive;
use crate::effects::Effect;
use crate::frame::Frame;
use crate::gas::Cylinder;
use crate::housing::Housing;
use crate::joints::guide::Guide;
use crate::joints::revolute::{JointModel, Revolute};
use crate::lift::parameters;

parameters! {
    /// A reciprocating compressor.
    pub struct Machine<S> {
        /// Crankshaft, flywheel and rotor.
        pub crankshaft: Crankshaft<S>,
        /// What turns the crankshaft.
        pub drive: Drive<S>,
        /// Bearing between crankshaft (journal) and frame.
        pub main: Revolute<S>,
        /// One entry per cylinder.
        pub throws: Vec<Throw<S>>,
        /// Acceleration of gravity along x (toward the head), m/s².
        pub gravity_x: S,
        /// Acceleration of gravity along y, m/s² (−9.81 for a horizontal machine).
        pub gravity_y: S,
        /// The elastically mounted frame, where there is one.
        pub frame: Option<Frame<S>>,
        /// Physics beyond the first model; see [`crate::effects`].
        pub effects: Vec<Effect<S>>,
    }
}

parameters! {
    /// The rotating body. Its centre of mass lies `eccentricity` from the shaft's axis, in the
    /// direction of a crank pin with `pin_angle = 0`.
    pub struct Crankshaft<S> {
        /// Mass, kg; moves only where the main bearing has clearance.
        pub mass: S,
        /// Moment of inertia about the shaft's axis, kg m², flywheel and rotor included.
        pub inertia: S,
        /// Distance of the centre of mass from the axis, m.
        pub eccentricity: S,
    }
}

parameters! {
    /// Crank, connecting rod, crosshead and cylinder of one throw.
    pub struct Throw<S> {
        /// Crank radius R (half the stroke), m.
        pub crank_radius: S,
        /// Angle ψ of this throw's crank pin on the shaft, rad.
        pub pin_angle: S,
        /// The connecting rod.
        pub rod: Rod<S>,
        /// Crosshead, piston rod and piston.
        pub crosshead: Crosshead<S>,
        /// Cylinder and gas.
        pub cylinder: Cylinder<S>,
        /// Joint between crank pin (journal) and rod (bearing).
        pub big_end: Revolute<S>,
        /// Joint between crosshead pin (journal) and rod (bearing).
        pub small_end: Revolute<S>,
        /// Joint between crosshead and guide.
        pub guide: Guide<S>,
        /// The housing of the guide, where sensors sit on it.
        pub housing: Option<Housing<S>>,
        fixed {
            /// Name that prefixes this throw's channels and labels; empty in a machine of one.
            pub name: String,
            /// Which way the cylinder lies.
            pub direction: Direction,
        }
    }
}

/// Which way a throw's cylinder lies from the crankshaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along +x.
    Forward,
    /// Along −x. The throw is computed in its own frame, which is the machine's turned by half a
    /// revolution: x points to its own head, y the other way.
    Opposed,
}

parameters! {
    /// The connecting rod.
    pub struct Rod<S> {
        /// Distance L between the eye centres, m.
        pub length: S,
        /// Mass, kg.
        pub mass: S,
        /// Distance a from the big-end eye to the centre of mass, m.
        pub centre_of_mass: S,
        /// Moment of inertia about the centre of mass, kg m².
        pub inertia: S,
    }
}

parameters! {
    /// Crosshead, piston rod and piston: one rigid body whose centre of mass is the crosshead pin.
    pub struct Crosshead<S> {
        /// Mass, kg.
        pub mass: S,
        /// Moment of inertia about the pin, kg m²; felt only where the guide has clearance.
        pub inertia: S,
    }
}

impl<S> Machine<S> {
    /// The names of the throws; one empty name in a machine of one.
    pub fn throw_names(&self) -> Vec<&str> {
        let throws = self.throws.iter();
        throws.map(|throw| throw.name.as_str()).collect()
    }

    /// Whether this is the model of MODEL.md without any addition that costs time where it is not there:
    /// no effects, ideal guides, compliant contact in every joint with clearance. Most machines are.
    pub(crate) fn is_plain(&self) -> bool {
        let compliant = |joint: &Revolute<S>| {
            joint
                .clear()
                .is_none_or(|clear| clear.model == JointModel::ThreeMode)
        };
        let plain = |throw: &Throw<S>| {
            throw.guide.clear().is_none()
                && compliant(&throw.big_end)
                && compliant(&throw.small_end)
        };
        self.effects.is_empty() && compliant(&self.main) && self.throws.iter().all(plain)
    }
}
