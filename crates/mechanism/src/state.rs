//! What the state vector holds, and in which order.
//!
//! The coordinates are the offsets of the joints with clearance, e = journal centre − bearing
//! centre, and their rates: the deviation from the ideal mechanism at the actual crank angle.
//! They are as small as the clearance, so a tolerance relative to the clearance is enough, and no
//! digits are lost in differences of large coordinates. An ideal joint has no coordinates; the
//! mechanism with none is pure kinematics.

use crate::drive::Drive;
use crate::effects::{Acting, Acts};
use crate::machine::Machine;
use scalar::Scalar;

/// Where each part of the state lies: the index of its first component.
///
/// | part | components |
/// |---|---|
/// | joint with clearance, frame | `x, y, ẋ, ẏ` (m, m/s) |
/// | guide | `y, τ, ẏ, τ̇` (m, rad, per second) |
/// | elastic rod | its stretch `η, η̇` (1, 1/s) |
/// | gas that leaves its polytrope | the drifts of head end and crank end (1) |
/// | free crank | `θ − ω_ref t, θ̇ − ω_ref` (rad, rad/s) |
/// | ledger | four works (J) |
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The main bearing's offset.
    pub main: Option<usize>,
    /// Each throw's joints.
    pub throws: Vec<ThrowLayout>,
    /// The free crank.
    pub crank: Option<usize>,
    /// The frame.
    pub frame: Option<usize>,
    /// The energy ledger: work of the gas, work of the drive, friction loss, damping loss, J.
    pub ledger: Option<usize>,
    /// Length of the state.
    pub dimension: usize,
}

/// Where the joints of one throw lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThrowLayout {
    /// Offset at the big end.
    pub big_end: Option<usize>,
    /// Offset at the small end.
    pub small_end: Option<usize>,
    /// Shift and tilt in the guide.
    pub guide: Option<usize>,
    /// Stretch of the rod.
    pub rod: Option<usize>,
    /// Drifts of the gas off its polytropes.
    pub gas: Option<usize>,
}

impl ThrowLayout {
    /// That of a throw of a plain machine ([`Machine::is_plain`]), so that the compiler knows it.
    #[inline(always)]
    pub(crate) fn plain(&self) -> Self {
        Self {
            guide: None,
            rod: None,
            gas: None,
            ..*self
        }
    }
}

impl Layout {
    /// The layout of `machine`, with the energy ledger or without.
    pub fn new<S: Scalar>(machine: &Machine<S>, ledger: bool) -> Self {
        let mut next = 0;
        let mut room = |present: bool, length: usize| {
            present.then(|| {
                next += length;
                next - length
            })
        };
        let main = room(machine.main.clear().is_some(), 4);
        let throws = machine
            .throws
            .iter()
            .enumerate()
            .map(|(i, throw)| {
                let effects = Acting::on_throw(&machine.effects, i);
                ThrowLayout {
                    big_end: room(throw.big_end.clear().is_some(), 4),
                    small_end: room(throw.small_end.clear().is_some(), 4),
                    guide: room(throw.guide.clear().is_some(), 4),
                    rod: room(effects.rod().is_some(), 2),
                    gas: room(effects.all().any(|effect| effect.drifts()), 2),
                }
            })
            .collect();
        let crank = room(matches!(machine.drive, Drive::Free(_)), 2);
        let frame = room(machine.frame.is_some(), 4);
        let ledger = room(ledger, 4);
        Self {
            main,
            throws,
            crank,
            frame,
            ledger,
            dimension: next,
        }
    }
}
