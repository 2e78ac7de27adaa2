//! The catalogue: physics that a first model leaves out, one effect per file.
//!
//! An effect is a line in the machine file; where the list is empty the model is the one of
//! MODEL.md. A new effect that acts in the equations is a file here and a line in `catalogue!`: a
//! struct of parameters, its [`declaration!`](macro@crate::declaration), and those methods of `Acts` that
//! say where it acts. Section of the machine file, schema and tables follow from these. Effects that
//! only change the machine's data (a clearance, the frame) or what sensors make of it need nothing
//! here.

mod acting;
mod acts;
mod alternatives;
mod check;
mod place;

pub(crate) use acting::{Acting, AtJoint};
pub(crate) use acts::{Acts, ChamberAt, HARDENED, JointAt, PistonAt, RodSpring, Shape};
pub use alternatives::{Alternatives, Oval, Shaken};
pub use place::{End, Joint, Place};

use crate::declaration::{Declaration, Kind};
use crate::lift::{alternatives, parameters};
use crate::plane::Vec2;
use scalar::Scalar;

/// The methods of [`Acts`], each as the law at hand has it.
macro_rules! each_law {
    ($kinds:tt $method:ident($($argument:ident: $type:ty),*) -> $output:ty; $($rest:tt)*) => {
        fn $method(&self, $($argument: $type),*) -> $output {
            S::vectorised(#[inline(always)] || at_hand! { $kinds self.$method($($argument),*) })
        }
        each_law! { $kinds $($rest)* }
    };
    ($kinds:tt) => {};
}

/// A method of the law at hand.
macro_rules! at_hand {
    ([$($kind:ident)*] $self:ident.$method:ident $arguments:tt) => {
        match $self {
            $( Law::$kind(law) => law.$method $arguments, )*
        }
    };
}

/// The one list of the effects that act in the equations: it makes the modules, [`Law`] and its
/// dispatch.
macro_rules! catalogue {
    ($( $module:ident::$kind:ident, )*) => {
        $( mod $module; pub use $module::$kind; )*

        /// The effects that act in the equations.
        pub const CATALOGUE: &[Entry] = &[$( Entry {
            name: stringify!($module),
            declaration: $module::DECLARATION,
            law: |values, alternatives| Law::$kind($module::law(values, alternatives)),
        } ),*];

        alternatives! {
            /// What an effect does, with its parameters.
            pub enum Law<S> {
                $( #[doc = concat!("See [`", stringify!($kind), "`].")] $kind($kind), )*
            }
        }

        impl<S> Law<S> {
            /// The part of the machine that it acts on.
            #[inline(always)]
            pub fn kind(&self) -> Kind {
                match self {
                    $( Self::$kind(_) => $module::DECLARATION.kind, )*
                }
            }
        }

        impl<S: Scalar> Acts<S> for Law<S> {
            each_law! { [$($kind)*]
                line_pressures(lines: [S; 2], at: &ChamberAt<S>) -> [S; 2];
                suction_held() -> Option<S>;
                drifts() -> bool;
                drift(at: &ChamberAt<S>) -> S;
                piston_force(at: &PistonAt<S>) -> S;
                frame_acceleration(angle: S, speed: S) -> Option<Vec2<S>>;
                frame_motion(angle: S, speed: S) -> Option<[Vec2<S>; 2]>;
                rod() -> Option<RodSpring<S>>;
                shape(bearing: Vec2<S>, journal: Vec2<S>, clearance: S) -> Option<Shape<S>>;
                film_force(at: &JointAt<S>) -> S;
            }
        }
    };
}

catalogue! {
    valve_loss::ValveLoss,
    suction_unloading::SuctionUnloading,
    ring_leakage::RingLeakage,
    valve_leakage::ValveLeakage,
    heat_transfer::HeatTransfer,
    gas_pulsation::GasPulsation,
    valve_flutter::ValveFlutter,
    ring_friction::RingFriction,
    squeeze_film::SqueezeFilm,
    bearing_ovality::BearingOvality,
    rod_flexibility::RodFlexibility,
    rotating_unbalance::RotatingUnbalance,
    misalignment::Misalignment,
    empirical_force::EmpiricalForce,
}

/// An effect that acts in the equations.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name in the machine file.
    pub name: &'static str,
    /// What files, schemas, tables and searches know of it.
    pub declaration: Declaration,
    /// The law with values of the parameters, SI, in their order.
    pub law: fn(&[f64], Alternatives) -> Law,
}

parameters! {
    /// An effect of the catalogue at its place.
    pub struct Effect<S> {
        /// What it does.
        pub law: Law<S>,
        fixed {
            /// Where.
            pub place: Place,
        }
    }
}

impl<S> Law<S> {
    /// The law at every place where it can act.
    pub fn everywhere(self) -> Effect<S> {
        let place = Place::default();
        Effect { law: self, place }
    }
}
