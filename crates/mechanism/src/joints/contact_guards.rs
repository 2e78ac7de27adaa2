//! The guards of a compliant contact, and what they switch.

use super::contact::{ContactLaw, pressing};
use super::friction::FrictionLaw;
use crate::mode::{ContactMode, flagged};
use scalar::Scalar;

/// Guards of one contact: overlap, pressing, the law's kink, two kinks of the friction.
pub(crate) const CONTACT_GUARDS: usize = 5;

/// The guards of a compliant contact.
#[inline(always)]
pub(crate) fn contact_guards<S: Scalar>(
    contact: &ContactLaw<S>,
    friction: &FrictionLaw<S>,
    penetration: S,
    excess: [S; 2],
    slip: S,
    mode: &ContactMode<S>,
) -> [S; CONTACT_GUARDS] {
    let one = S::one();
    let mut guards = [one; CONTACT_GUARDS];
    guards[0] = flagged(mode.touching, penetration, -penetration);
    let sign = pressing(excess);
    guards[1] = flagged(mode.touching, flagged(mode.pressed, sign, -sign), one);
    if let Some(depth) = contact.kink() {
        guards[2] = flagged(mode.deep, penetration - depth, depth - penetration);
    }
    if let Some(kinks) = friction.kinks() {
        for ((guard, kink), beyond) in guards[3..].iter_mut().zip(kinks).zip(mode.slipping) {
            let excess = slip.abs() - kink;
            *guard = flagged(beyond, excess, -excess);
        }
    }
    guards
}

/// Changes the mode of a compliant contact whose guard number `guard` crossed.
pub(crate) fn switch_contact<S: Scalar>(mode: &mut ContactMode<S>, guard: usize, rate: S) {
    let flip = |flag: &mut S| *flag = S::one() - *flag;
    match guard {
        0 => {
            flip(&mut mode.touching);
            mode.pressed = mode.touching;
            mode.approach = flagged(mode.touching, rate.max(S::zero()), mode.approach);
        }
        1 => flip(&mut mode.pressed),
        2 => flip(&mut mode.deep),
        _ => flip(&mut mode.slipping[guard - 3]),
    }
}
