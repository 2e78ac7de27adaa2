//! The sizes of the state's components, against which the tolerance is measured.

use crate::drive::Drive;
use crate::joints::guide::Guide;
use crate::joints::revolute::Revolute;
use crate::machine::Machine;
use crate::state::Layout;
use scalar::Scalar;

/// Rate scale over offset scale, 1/s: contact rings at some hundred Hz.
const RATE: f64 = 1e3;
/// Scale of a frame's displacement, m.
const FRAME: f64 = 1e-5;
/// Scale of a rod's stretch.
const STRETCH: f64 = 1e-5;
/// Scale of the gas's drift off its polytrope.
const DRIFT: f64 = 1e-3;
/// Scale of the crank angle's deviation, rad.
const ANGLE: f64 = 1e-3;

/// The size of each component of the state that counts as 1 for the tolerance: clearances for
/// offsets. The ledger does not steer the step.
pub(crate) fn scales<S: Scalar>(machine: &Machine<S>, layout: &Layout) -> Vec<S> {
    let mut scales = vec![S::constant(f64::INFINITY); layout.dimension];
    let mut set = |at: Option<usize>, [first, second]: [S; 2]| {
        if let Some(i) = at {
            let sizes = [first, second, first * RATE, second * RATE];
            scales[i..i + 4].copy_from_slice(&sizes);
        }
    };
    let size = |joint: &Revolute<S>| joint.clear().map_or(S::zero(), |c| c.clearance);
    set(layout.main, [size(&machine.main); 2]);
    for (throw, at) in machine.throws.iter().zip(&layout.throws) {
        set(at.big_end, [size(&throw.big_end); 2]);
        set(at.small_end, [size(&throw.small_end); 2]);
        if let Guide::Clear(guide) = &throw.guide {
            set(
                at.guide,
                [guide.clearance, guide.clearance / guide.half_length],
            );
        }
    }
    set(layout.frame, [S::constant(FRAME); 2]);
    for at in &layout.throws {
        if let Some(i) = at.rod {
            scales[i] = S::constant(STRETCH);
            scales[i + 1] = S::constant(STRETCH * RATE);
        }
        if let Some(i) = at.gas {
            scales[i..i + 2].fill(S::constant(DRIFT));
        }
    }
    if let (Some(i), Drive::Free(motor)) = (layout.crank, &machine.drive) {
        scales[i] = S::constant(ANGLE);
        scales[i + 1] = motor.reference_speed.abs() * ANGLE;
    }
    scales
}
