//! Poincaré sections of the running machine: where it stands each time the crank passes an angle,
//! and each time a journal touches its bearing.
//!
//! Both are located, not sampled. The section is one more guard of the integration, zero where the
//! crank passes. So a free crank is caught at the angle itself, not at multiples of a period. Impacts
//! are the guards of the contacts.
//!
//! n points that repeat are a period of n revolutions. Points on a curve are a quasi-periodic motion,
//! a cloud of points is a chaotic one.

pub use crate::section::{
    Impact, Joint, JointPoint, Revolution, Sections, ThrowPoint, clear_joints,
};

use crate::error::Error;
use crate::return_map::ReturnMap;
use mechanism::Machine;

/// How sections are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionSettings {
    /// Crank angle of the section, rad; 0 is the top dead centre of a throw with `pin_angle` 0.
    pub angle: f64,
    /// Revolutions that are thrown away. With none the first revolution is the start itself.
    pub transient: u32,
    /// Revolutions that are kept.
    pub revolutions: u32,
    /// Relative local error of the integration.
    pub tolerance: f64,
}

impl Default for SectionSettings {
    fn default() -> Self {
        Self {
            angle: 0.0,
            transient: 50,
            revolutions: 100,
            tolerance: 1e-9,
        }
    }
}

/// Runs `machine` and takes its sections.
///
/// # Errors
/// Where the integration cannot meet its tolerance, or a free crank stalls.
pub fn sections(machine: &Machine, settings: &SectionSettings) -> Result<Sections, Error> {
    let mut strobe = ReturnMap::start(machine, settings.angle, settings.tolerance);
    for left in (0..settings.transient).rev() {
        strobe.revolve(left == 0)?;
    }
    let revolutions = (0..settings.revolutions).map(|_| strobe.revolve(true));
    Ok(Sections {
        joints: clear_joints(machine),
        revolutions: revolutions.collect::<Result<_, _>>()?,
    })
}
