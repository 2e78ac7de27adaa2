//! Four lanes: one register of AVX2.
//!
//! The functions here may only run where the processor has these instructions: the types are made by
//! [`in_lanes`](super::in_lanes) alone, which asks [`is_present`]. A function that has been compiled
//! without them cannot take them in, so all that stands between here and [`vectorised`] must be inlined.
#![expect(
    unsafe_code,
    reason = "vector instructions; see the module's page for why they are there"
)]

use super::Lanes;
use crate::Mask;
use crate::elementary::{MAGIC, MAGIC_EXPONENT, SPLIT_BIAS};
use std::arch::x86_64::*;

/// Four numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F64x4(__m256d);

/// Four truth values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truths(__m256d);

super::lanes!(F64x4, 4);

/// Whether this processor has the instructions.
pub(super) fn is_present() -> bool {
    is_x86_feature_detected!("avx2")
}

#[inline(always)]
fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    #[target_feature(enable = "avx2")]
    fn with_instructions<T>(work: impl FnOnce() -> T) -> T {
        work()
    }
    // SAFETY: the processor has them.
    unsafe { with_instructions(work) }
}

impl F64x4 {
    #[inline(always)]
    fn numbers(&self) -> &[f64; 4] {
        // SAFETY: the register's numbers lie in memory one after another.
        unsafe { &*(&raw const self.0).cast() }
    }
    #[inline(always)]
    fn numbers_mut(&mut self) -> &mut [f64; 4] {
        // SAFETY: as above.
        unsafe { &mut *(&raw mut self.0).cast() }
    }
}

impl Truths {
    fn to_array(self) -> [bool; 4] {
        // SAFETY: as below.
        let signs = unsafe { _mm256_movemask_pd(self.0) };
        std::array::from_fn(|lane| signs >> lane & 1 == 1)
    }
    fn from_array(truths: [bool; 4]) -> Self {
        let numbers = truths.map(|truth| f64::from_bits(if truth { u64::MAX } else { 0 }));
        Self(F64x4::from_array(numbers).0)
    }
}

impl Mask for Truths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY, here and below: the processor has the instructions, and none of them touches memory.
        Self(unsafe { _mm256_and_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(unsafe { _mm256_or_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_castsi256_pd(_mm256_set1_epi64x(-1))) })
    }
    #[inline(always)]
    fn any(self) -> bool {
        unsafe { _mm256_movemask_pd(self.0) != 0 }
    }
}

#[inline(always)]
fn splat(x: f64) -> F64x4 {
    F64x4(unsafe { _mm256_set1_pd(x) })
}
#[inline(always)]
fn add(a: F64x4, b: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_add_pd(a.0, b.0) })
}
#[inline(always)]
fn subtract(a: F64x4, b: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_sub_pd(a.0, b.0) })
}
#[inline(always)]
fn multiply(a: F64x4, b: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_mul_pd(a.0, b.0) })
}
#[inline(always)]
fn divide(a: F64x4, b: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_div_pd(a.0, b.0) })
}
#[inline(always)]
fn negate(a: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_xor_pd(a.0, _mm256_set1_pd(-0.0)) })
}
#[inline(always)]
fn square_root(a: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_sqrt_pd(a.0) })
}
#[inline(always)]
fn less(a: F64x4, b: F64x4) -> Truths {
    Truths(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0) })
}
#[inline(always)]
fn choose(mask: Truths, yes: F64x4, no: F64x4) -> F64x4 {
    F64x4(unsafe { _mm256_blendv_pd(no.0, yes.0, mask.0) })
}
#[inline(always)]
fn bit(a: F64x4, number: u32) -> Truths {
    unsafe {
        let wanted = _mm256_set1_epi64x(1 << number);
        let found = _mm256_and_si256(_mm256_castpd_si256(a.0), wanted);
        Truths(_mm256_castsi256_pd(_mm256_cmpeq_epi64(found, wanted)))
    }
}
#[inline(always)]
fn two_to_the(a: F64x4) -> F64x4 {
    unsafe {
        let biased = _mm256_add_epi64(_mm256_castpd_si256(a.0), _mm256_set1_epi64x(1023));
        F64x4(_mm256_castsi256_pd(_mm256_slli_epi64::<52>(biased)))
    }
}
#[inline(always)]
fn split(a: F64x4) -> (F64x4, F64x4) {
    unsafe {
        let bits = _mm256_castpd_si256(a.0);
        let offset = _mm256_add_epi64(bits, _mm256_set1_epi64x(SPLIT_BIAS as i64));
        let biased = _mm256_srli_epi64::<52>(offset);
        let power = _mm256_slli_epi64::<52>(biased);
        let one = _mm256_set1_epi64x(1023 << 52);
        let fraction = _mm256_sub_epi64(bits, _mm256_sub_epi64(power, one));
        let exponent = _mm256_or_si256(biased, _mm256_set1_epi64x(MAGIC_EXPONENT as i64));
        let exponent = _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(MAGIC));
        (F64x4(_mm256_castsi256_pd(fraction)), F64x4(exponent))
    }
}
