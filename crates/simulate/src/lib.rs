//! A machine at an operating point becomes a run.
//!
//! [`simulate`](simulate()) integrates the machine past its transient and records what its sensors
//! see, anti-aliased, without noise. [`measure`](measure()) is the rest of the measuring chain:
//! noise, range, resolution. The two are apart because repeated measurements of one run differ in
//! noise alone.
//!
//! What the equations say beyond a record: [`poincare`] sections, [`bifurcation`] diagrams and the
//! [`regime`] of a motion with its Lyapunov exponents. What its user looks at first: the
//! [`indicator_card`] of each chamber and the [`rod_load`] of each throw.

mod asked;
pub mod bifurcation;
mod chain;
pub mod chamber;
mod ensemble;
pub mod error;
pub mod flow;
mod free_vibration;
pub mod indicator_card;
mod instants;
mod leaving;
pub mod lookout;
pub mod lyapunov;
pub mod measure;
mod moved;
mod orbit;
pub mod penetration;
mod period;
pub mod periodic_orbit;
pub mod poincare;
mod polynomial;
pub mod record;
mod recorder;
pub mod regime;
mod repetition;
mod return_map;
pub mod rod_load;
mod run;
mod sampler;
mod section;
pub mod sensitivity;
pub mod sensor;
pub mod sensors;
pub mod settings;
mod settle;
mod simulate;
mod slider_crank;
mod span;
mod strobes;
pub mod structure;
mod tangents;
mod task;
pub mod trace;
mod warm_start;

pub use asked::Asked;
pub use chamber::Chamber;
pub use ensemble::{settled_together, simulate_together};
pub use error::Error;
pub use flow::{Cycle, Flow};
pub use indicator_card::IndicatorCard;
pub use lyapunov::{Exponent, ExponentSettings, exponents};
pub use measure::{CutOff, cut_off, doubts, measure};
pub use penetration::Penetration;
pub use periodic_orbit::PeriodicOrbit;
pub use poincare::{SectionSettings, Sections, sections};
pub use record::Record;
pub use regime::{Extent, Motion, Regime, machine_motion, motion};
pub use repetition::LONGEST_PERIOD;
pub use rod_load::RodLoad;
pub use sensitivity::{Moved, Sensitivities, sensitivities};
pub use sensor::{
    Axis, Chain, ChamberEnd, Hum, LowPass, Measured, Noise, NoiseLevel, Range, Resonance, Sensor,
    Structure,
};
pub use settings::{Settings, Transient, Unrecordable};
pub use settle::settle;
pub use simulate::{simulate, simulate_later, simulate_watched};
pub use trace::{JointTrace, ThrowTrace, Trace};
pub use warm_start::WarmStart;
