//! The catalogue of effects as the machine file has it.
//!
//! An effect that acts in the equations is a file and a line in [`mechanism::effects`], and nothing
//! here: its section follows from its [`declaration`](mechanism::declaration). An effect that changes
//! the file, the machine's data or its sensors is a file here and a line in [`own!`]: its declaration,
//! and what it does, as methods of [`act::Act`].

mod act;
mod catalogue;
mod present;
mod section;

pub use catalogue::{CATALOGUE, Choice, Entry, Parameter, at_path, entry, of_path, proposed};
pub use mechanism::declaration::{Kind, Proposal};

pub(super) use act::{Draft, Joint, Place};
pub(super) use present::{Effects, idle};
pub(super) use section::EffectSection;

use act::Act;
use mechanism::declaration::Declaration;

/// The one list of the effects that act outside the equations, each group after the effect of
/// [`mechanism::effects`] that it follows in the catalogue.
macro_rules! own {
    ($( after $after:ident { $($module:ident),+ } )+) => {
        $( $( mod $module; )+ )+

        /// Where in the catalogue, name, declaration, and what the effect does with values.
        type Own = (&'static str, &'static str, Declaration, fn(&[f64]) -> Box<dyn Act>);

        const OWN: &[Own] = &[$( $( (
            stringify!($after),
            stringify!($module),
            $module::DECLARATION,
            |values| Box::new($module::Values::new(values)),
        ) ),+ ),+];
    };
}

own! {
    after squeeze_film { guide_clearance, extra_clearance, thermal_clearance }
    after rod_flexibility { frame_compliance }
    after misalignment {
        speed_fluctuation, crank_angle_offset, sensor_resonance, sensor_gain, sensor_offset,
        sensor_delay, sensor_highpass, mains_hum
    }
}
