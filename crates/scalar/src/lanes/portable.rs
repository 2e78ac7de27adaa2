//! Two lanes in plain numbers: for every processor.

use super::operations::{Lanes, lanes};
use crate::Mask;
use crate::elementary::Bits;

/// Two numbers.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub(super) struct F64x2([f64; 2]);

/// Two truth values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truths([bool; 2]);

lanes!(F64x2, 2);

impl F64x2 {
    #[inline(always)]
    fn numbers(&self) -> &[f64; 2] {
        &self.0
    }
    #[inline(always)]
    fn numbers_mut(&mut self) -> &mut [f64; 2] {
        &mut self.0
    }
}

impl Truths {
    fn to_array(self) -> [bool; 2] {
        self.0
    }
    fn from_array(truths: [bool; 2]) -> Self {
        Self(truths)
    }
}

impl Mask for Truths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self([self.0[0] | other.0[0], self.0[1] | other.0[1]])
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self([!self.0[0], !self.0[1]])
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0[0] | self.0[1]
    }
}

#[inline(always)]
fn splat(x: f64) -> F64x2 {
    F64x2([x; 2])
}
#[inline(always)]
fn both(a: F64x2, b: F64x2, f: impl Fn(f64, f64) -> f64) -> F64x2 {
    F64x2([f(a.0[0], b.0[0]), f(a.0[1], b.0[1])])
}
#[inline(always)]
fn add(a: F64x2, b: F64x2) -> F64x2 {
    both(a, b, |a, b| a + b)
}
#[inline(always)]
fn subtract(a: F64x2, b: F64x2) -> F64x2 {
    both(a, b, |a, b| a - b)
}
#[inline(always)]
fn multiply(a: F64x2, b: F64x2) -> F64x2 {
    both(a, b, |a, b| a * b)
}
#[inline(always)]
fn divide(a: F64x2, b: F64x2) -> F64x2 {
    both(a, b, |a, b| a / b)
}
#[inline(always)]
fn multiply_add(a: F64x2, b: F64x2, c: F64x2) -> F64x2 {
    let of = |lane: usize| a.0[lane].mul_add(b.0[lane], c.0[lane]);
    F64x2([of(0), of(1)])
}
#[inline(always)]
fn negate(a: F64x2) -> F64x2 {
    F64x2(a.0.map(|a| -a))
}
#[inline(always)]
fn square_root(a: F64x2) -> F64x2 {
    F64x2(a.0.map(f64::sqrt))
}
#[inline(always)]
fn less(a: F64x2, b: F64x2) -> Truths {
    Truths([a.0[0] < b.0[0], a.0[1] < b.0[1]])
}
#[inline(always)]
fn equal(a: F64x2, b: F64x2) -> bool {
    a.0 == b.0
}
#[inline(always)]
fn choose(mask: Truths, yes: F64x2, no: F64x2) -> F64x2 {
    let of = |lane: usize| {
        if mask.0[lane] {
            yes.0[lane]
        } else {
            no.0[lane]
        }
    };
    F64x2([of(0), of(1)])
}
#[inline(always)]
fn bit(a: F64x2, number: u32) -> Truths {
    Truths(a.0.map(|a| a.bit(number)))
}
#[inline(always)]
fn two_to_the(a: F64x2) -> F64x2 {
    F64x2(a.0.map(f64::two_to_the))
}
#[inline(always)]
fn split(a: F64x2) -> (F64x2, F64x2) {
    let [(f0, k0), (f1, k1)] = a.0.map(f64::split);
    (F64x2([f0, f1]), F64x2([k0, k1]))
}
#[inline(always)]
fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    crate::fused::vectorised(work)
}
