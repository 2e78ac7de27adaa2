//! Several numbers side by side: every operation acts on each lane alone.
//!
//! A plain array, so that one source serves every vector width: the loops below are unrolled
//! and vectorised by the compiler for whatever instructions the caller was compiled for. A crate
//! with fixed vector types would settle the width when it is compiled, not when it runs.

use crate::{Mask, Scalar};
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// `W` independent numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const W: usize>(pub [f64; W]);

impl<const W: usize> Lanes<W> {
    #[inline(always)]
    fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for x in &mut self.0 {
            *x = f(*x);
        }
        self
    }
    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (x, y) in self.0.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        self
    }
}

/// One truth value per lane.
impl<const W: usize> Mask for [bool; W] {
    #[inline]
    fn and(mut self, other: Self) -> Self {
        self.iter_mut().zip(other).for_each(|(a, b)| *a &= b);
        self
    }
    #[inline]
    fn or(mut self, other: Self) -> Self {
        self.iter_mut().zip(other).for_each(|(a, b)| *a |= b);
        self
    }
    #[inline]
    fn not(mut self) -> Self {
        self.iter_mut().for_each(|a| *a = !*a);
        self
    }
    #[inline]
    fn any(self) -> bool {
        self.iter().any(|m| *m)
    }
}

/// Lane-wise binary operators, with another [`Lanes`] and with a plain number.
macro_rules! operator {
    ($trait:ident, $method:ident, $assign:ident, $assign_method:ident, $op:tt) => {
        impl<const W: usize> $trait for Lanes<W> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
        impl<const W: usize> $trait<f64> for Lanes<W> {
            type Output = Self;
            #[inline]
            fn $method(self, other: f64) -> Self {
                self.map(|a| a $op other)
            }
        }
        impl<const W: usize> $assign for Lanes<W> {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    };
}

operator!(Add, add, AddAssign, add_assign, +);
operator!(Sub, sub, SubAssign, sub_assign, -);
operator!(Mul, mul, MulAssign, mul_assign, *);
operator!(Div, div, DivAssign, div_assign, /);

impl<const W: usize> Neg for Lanes<W> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const W: usize> Zero for Lanes<W> {
    #[inline]
    fn zero() -> Self {
        Self([0.0; W])
    }
    #[inline]
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<const W: usize> One for Lanes<W> {
    #[inline]
    fn one() -> Self {
        Self([1.0; W])
    }
}

impl<const W: usize> Scalar for Lanes<W> {
    type Mask = [bool; W];

    #[inline]
    fn constant(x: f64) -> Self {
        Self([x; W])
    }
    #[inline]
    fn lt(self, other: Self) -> [bool; W] {
        let mut mask = [false; W];
        for (mask, (a, b)) in mask.iter_mut().zip(self.0.iter().zip(&other.0)) {
            *mask = a < b;
        }
        mask
    }
    #[inline]
    fn select(mask: [bool; W], yes: Self, mut no: Self) -> Self {
        for (mask, (no, yes)) in mask.iter().zip(no.0.iter_mut().zip(yes.0)) {
            *no = if *mask { yes } else { *no };
        }
        no
    }
    #[inline]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (mut sine, mut cosine) = (self, self);
        for i in 0..W {
            (sine.0[i], cosine.0[i]) = crate::elementary::sin_cos(self.0[i]);
        }
        (sine, cosine)
    }
    #[inline]
    fn exp(self) -> Self {
        self.map(crate::elementary::exp)
    }
    #[inline]
    fn ln(self) -> Self {
        self.map(crate::elementary::ln)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn f<S: Scalar>(x: S, y: S) -> S {
        let (s, c) = (x * y).sin_cos();
        (x.exp() * s - c / (y + 2.0)).abs().sqrt() + (x + y).ln() * x.powf(y).max(y) - 1.5
    }

    #[test]
    fn each_lane_has_the_bits_of_the_plain_number() {
        let x = [0.1, 0.7, 2.5, 40.0, 1e-3, 3.3, 0.9, 11.0];
        let y = [1.3, 0.2, 0.9, 0.01, 7.0, 1.1, 2.2, 0.5];
        let lanes = f(Lanes(x), Lanes(y));
        for i in 0..8 {
            assert_eq!(lanes.0[i].to_bits(), f(x[i], y[i]).to_bits(), "lane {i}");
        }
    }
}
