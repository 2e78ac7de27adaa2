//! What can be measured, a sensor a file.
//!
//! A new sensor is a file here and a line in `sensors!`: a [`Declaration`], and a function `read`
//! that takes its value from an evaluation of the equations of motion. Section of the machine file,
//! schema, channels of bundles and tables follow from these.

mod declaration;
mod housing;
mod place;

pub use declaration::{Channel, Declaration};
pub use place::{Axis, ChamberEnd, Place, PlaceKey};

use crate::structure::Structure;
use integrate::Real;
use mechanism::declaration::Quantity;
use mechanism::{Evaluation, Machine};
use scalar::Scalar;
use std::f64::consts::TAU;

/// The one list of sensors: it makes the modules, [`Measured`] and its dispatch. The fields of a
/// line are the keys that say where the sensor sits.
macro_rules! sensors {
    ($( $module:ident::$kind:ident $({ $($field:ident: $type:ty),+ })?, )*) => {
        $( mod $module; )*

        /// All sensors.
        pub const SENSORS: &[Entry] = &[$( Entry {
            name: stringify!($module),
            declaration: $module::DECLARATION,
            places: &[$($( sensors!(@place $field) ),+)?],
            measured: |_place| Measured::$kind $({ $($field: _place.$field),+ })?,
        } ),*];

        /// Positions in the list.
        enum Position { $($kind),* }

        /// A quantity that a sensor can see. `throw` is an index into the machine's throws.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Measured {
            $(
                #[doc = concat!("The sensor `", stringify!($module), "` of [`SENSORS`].")]
                $kind $({ $(
                    #[doc = concat!("Its ", stringify!($field), ".")]
                    $field: $type,
                )+ })?,
            )*
        }

        impl Measured {
            /// The quantity, an angle since the start.
            #[inline(always)]
            pub(crate) fn unwrapped<S: Scalar>(&self, at: &Evaluation<S>) -> S {
                match *self {
                    $( Measured::$kind $({ $($field),+ })? => $module::read(at $($(, $field)+)?), )*
                }
            }

            /// Whether it is an angle, which jumps back once a turn.
            #[inline(always)]
            pub(crate) fn is_angle(&self) -> bool {
                match self {
                    $( Measured::$kind { .. } => matches!($module::DECLARATION.quantity, Quantity::Angle), )*
                }
            }

            /// What it is in the list of sensors.
            pub fn entry(&self) -> &'static Entry {
                let position = match self {
                    $( Measured::$kind { .. } => Position::$kind as usize, )*
                };
                &SENSORS[position]
            }

            /// Where it is measured.
            pub fn place(&self) -> Place {
                match *self {
                    $( Measured::$kind $({ $($field),+ })? => Place {
                        $($( $field, )+)?
                        ..Place::default()
                    }, )*
                }
            }
        }
    };

    (@place throw) => { PlaceKey::Throw };
    (@place axis) => { PlaceKey::Axis };
    (@place end) => { PlaceKey::End };
}

sensors! {
    crosshead_acceleration::CrossheadAcceleration { throw: usize },
    crosshead_lateral_acceleration::CrossheadLateralAcceleration { throw: usize },
    frame_acceleration::FrameAcceleration { axis: Axis },
    frame_velocity::FrameVelocity { axis: Axis },
    housing_acceleration::HousingAcceleration { throw: usize, axis: Axis },
    housing_velocity::HousingVelocity { throw: usize, axis: Axis },
    cylinder_pressure::CylinderPressure { throw: usize, end: ChamberEnd },
    crank_angle::CrankAngle,
    crank_speed::CrankSpeed,
}

/// A sensor of the list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name in the machine file.
    pub name: &'static str,
    /// What files, schemas and tables know of it.
    pub declaration: Declaration,
    /// The keys that say where it sits.
    pub places: &'static [PlaceKey],
    /// What it measures at a place.
    pub measured: fn(Place) -> Measured,
}

impl Entry {
    /// Whether each throw can have one.
    pub fn is_of_throw(&self) -> bool {
        self.places.contains(&PlaceKey::Throw)
    }
}

impl Measured {
    /// The quantity at an instant, SI.
    pub fn value<S: Real>(&self, at: &Evaluation<S>) -> S {
        self.wrapped(self.unwrapped(at))
    }

    /// What is shown of an angle that grows without end: where it stands in its turn.
    pub(crate) fn wrapped<S: Real>(&self, x: S) -> S {
        match self.is_angle() {
            true => x - TAU * (x.value() / TAU).floor(),
            false => x,
        }
    }

    /// The column name of this quantity, with its unit, as recording bundles have it. `throws`
    /// are the names of the machine's throws, empty in a machine of one.
    pub fn column(&self, throws: &[&str]) -> String {
        let throw = self.throw().and_then(|throw| throws.get(throw));
        let channel = &self.entry().declaration.channels[self.place().channel()];
        channel.column(throw.copied().unwrap_or_default())
    }

    /// The throw whose quantity this is; none for the frame and the crank.
    pub fn throw(&self) -> Option<usize> {
        (self.entry().is_of_throw()).then_some(self.place().throw)
    }

    /// What carries a sensor of it on `machine`, where that swings.
    pub fn structure(&self, machine: &Machine) -> Option<Structure> {
        (self.entry().declaration.structure)(machine, &self.place())
    }

    /// Unit of the recorded numbers, as in the column name's ending but written out.
    pub fn unit(&self) -> &'static str {
        self.entry().declaration.unit
    }
}
