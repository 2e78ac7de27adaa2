//! The discrete mode: which contacts are closed, which valves are open.
//!
//! Flags are scalars, 1 or 0, so that lanes may be in different modes.

use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// The mode of the whole machine.
    pub struct Mode<S> {
        /// 1 while the crank turns counter-clockwise, −1 while it turns clockwise.
        pub turning: S,
        /// The main bearing.
        pub main: ContactMode<S>,
        /// Each throw.
        pub throws: Vec<ThrowMode<S>>,
    }
}

parameters! {
    /// The mode of one throw.
    pub struct ThrowMode<S> {
        /// Contact at the big end.
        pub big_end: ContactMode<S>,
        /// Contact at the small end.
        pub small_end: ContactMode<S>,
        /// Contact at the guide's corners: upper rear, upper front, lower rear, lower front.
        pub guide: [ContactMode<S>; 4],
        /// 1 while the crank moves the piston away from the head: sin α · θ̇ > 0.
        pub outward: S,
        /// Gas at the head end.
        pub head_end: ChamberMode<S>,
        /// Gas at the crank end.
        pub crank_end: ChamberMode<S>,
    }
}

parameters! {
    /// The mode of one contact.
    #[derive(Copy)]
    pub struct ContactMode<S> {
        /// 1 while the surfaces overlap (for a rigid joint model: while the journal follows).
        pub touching: S,
        /// 1 while they press on each other: they touch, and the law does not pull.
        pub pressed: S,
        /// 1 beyond the kink of the contact law.
        pub deep: S,
        /// 1 beyond each kink of the friction law.
        pub slipping: [S; 2],
        /// Approach speed v₀ at the last touch, m/s.
        pub approach: S,
    }
}

parameters! {
    /// The mode of the gas in one chamber; both valves' flags are 0 while both are closed.
    #[derive(Copy)]
    pub struct ChamberMode<S> {
        /// 1 while the suction valve is open.
        pub suction: S,
        /// 1 while the discharge valve is open.
        pub discharge: S,
        /// What is trapped: p xᵐ at the stroke's beginning, over its value at the dead centre with an open
        /// valve. It is 1 where the crank comes round and the valves open.
        pub trapped: S,
    }
}

impl<S> Mode<S> {
    /// Shows each number of the mode to `put`, with the one of `other` in the same place.
    pub(crate) fn each(&mut self, other: &Mode, mut put: impl FnMut(&mut S, f64)) {
        put(&mut self.turning, other.turning);
        self.main.each(&other.main, &mut put);
        for (throw, other) in self.throws.iter_mut().zip(&other.throws) {
            throw.big_end.each(&other.big_end, &mut put);
            throw.small_end.each(&other.small_end, &mut put);
            for (corner, other) in throw.guide.iter_mut().zip(&other.guide) {
                corner.each(other, &mut put);
            }
            put(&mut throw.outward, other.outward);
            throw.head_end.each(&other.head_end, &mut put);
            throw.crank_end.each(&other.crank_end, &mut put);
        }
    }
}

impl<S> ContactMode<S> {
    fn each(&mut self, other: &ContactMode, put: &mut impl FnMut(&mut S, f64)) {
        put(&mut self.touching, other.touching);
        put(&mut self.pressed, other.pressed);
        put(&mut self.deep, other.deep);
        for (slipping, other) in self.slipping.iter_mut().zip(other.slipping) {
            put(slipping, other);
        }
        put(&mut self.approach, other.approach);
    }
}

impl<S> ChamberMode<S> {
    fn each(&mut self, other: &ChamberMode, put: &mut impl FnMut(&mut S, f64)) {
        put(&mut self.suction, other.suction);
        put(&mut self.discharge, other.discharge);
        put(&mut self.trapped, other.trapped);
    }
}

impl<S: Scalar> ContactMode<S> {
    /// Apart.
    pub fn apart() -> Self {
        let zero = S::zero();
        Self {
            touching: zero,
            pressed: zero,
            deep: zero,
            slipping: [zero; 2],
            approach: zero,
        }
    }
}

impl<S: Scalar> ChamberMode<S> {
    /// Both valves closed.
    pub fn closed() -> Self {
        Self {
            suction: S::zero(),
            discharge: S::zero(),
            trapped: S::one(),
        }
    }
}

/// `yes` where the flag is 1, `no` where it is 0.
#[inline(always)]
pub(crate) fn flagged<S: Scalar>(flag: S, yes: S, no: S) -> S {
    S::select(S::zero().lt(flag), yes, no)
}
