//! Eight lanes: one register of AVX-512.
//!
//! The functions here may only run where the processor has these instructions: the types are made by
//! [`in_lanes`](super::in_lanes) alone, which asks [`is_present`]. A function that has been compiled
//! without them cannot take them in, so all that stands between here and [`vectorised`] must be inlined.
#![expect(
    unsafe_code,
    reason = "vector instructions; see the module's page for why they are there"
)]

use super::operations::{Lanes, lanes};
use crate::Mask;
use crate::elementary::{MAGIC, MAGIC_EXPONENT, SPLIT_BIAS};
use std::arch::x86_64::*;

/// Eight numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct F64x8(__m512d);

/// Eight truth values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truths(__mmask8);

lanes!(F64x8, 8, few: 2);

/// Whether this processor has the instructions.
pub(super) fn is_present() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
}

#[inline(always)]
fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw")]
    fn with_instructions<T>(work: impl FnOnce() -> T) -> T {
        work()
    }
    // SAFETY: only `in_lanes` gets here, which asks `is_present`.
    unsafe { with_instructions(work) }
}

impl F64x8 {
    #[inline(always)]
    fn numbers(&self) -> &[f64; 8] {
        // SAFETY: `F64x8` is these registers alone, whose numbers lie in memory one after another.
        unsafe { &*(&raw const self.0).cast() }
    }
    #[inline(always)]
    fn numbers_mut(&mut self) -> &mut [f64; 8] {
        // SAFETY: `F64x8` is these registers alone, whose numbers lie in memory one after another.
        unsafe { &mut *(&raw mut self.0).cast() }
    }
}

impl Truths {
    fn to_array(self) -> [bool; 8] {
        std::array::from_fn(|lane| self.0 >> lane & 1 == 1)
    }
    fn from_array(truths: [bool; 8]) -> Self {
        let bits = truths.iter().enumerate();
        Self(bits.fold(0, |all, (lane, truth)| all | u8::from(*truth) << lane))
    }
}

impl Mask for Truths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
}

#[inline(always)]
fn splat(x: f64) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_set1_pd(x) })
}
#[inline(always)]
fn add(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_add_pd(a.0, b.0) })
}
#[inline(always)]
fn subtract(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_sub_pd(a.0, b.0) })
}
#[inline(always)]
fn multiply(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_mul_pd(a.0, b.0) })
}
#[inline(always)]
fn divide(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_div_pd(a.0, b.0) })
}
#[inline(always)]
fn multiply_add(a: F64x8, b: F64x8, c: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_fmadd_pd(a.0, b.0, c.0) })
}
#[inline(always)]
fn negate(a: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_xor_pd(a.0, _mm512_set1_pd(-0.0)) })
}
#[inline(always)]
fn square_root(a: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_sqrt_pd(a.0) })
}
#[inline(always)]
fn less(a: F64x8, b: F64x8) -> Truths {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    Truths(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0) })
}
#[inline(always)]
fn equal(a: F64x8, b: F64x8) -> bool {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a.0, b.0) == 0xff }
}
#[inline(always)]
fn choose(mask: Truths, yes: F64x8, no: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { _mm512_mask_blend_pd(mask.0, no.0, yes.0) })
}
#[inline(always)]
fn bit(a: F64x8, number: u32) -> Truths {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    Truths(unsafe {
        _mm512_test_epi64_mask(_mm512_castpd_si512(a.0), _mm512_set1_epi64(1 << number))
    })
}
#[inline(always)]
fn two_to_the(a: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let biased = _mm512_add_epi64(_mm512_castpd_si512(a.0), _mm512_set1_epi64(1023));
        F64x8(_mm512_castsi512_pd(_mm512_slli_epi64::<52>(biased)))
    }
}
#[inline(always)]
fn split(a: F64x8) -> (F64x8, F64x8) {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let bits = _mm512_castpd_si512(a.0);
        let offset = _mm512_add_epi64(bits, _mm512_set1_epi64(SPLIT_BIAS as i64));
        let biased = _mm512_srli_epi64::<52>(offset);
        let power = _mm512_slli_epi64::<52>(biased);
        let one = _mm512_set1_epi64(1023 << 52);
        let fraction = _mm512_sub_epi64(bits, _mm512_sub_epi64(power, one));
        let exponent = _mm512_or_si512(biased, _mm512_set1_epi64(MAGIC_EXPONENT as i64));
        let exponent = _mm512_sub_pd(_mm512_castsi512_pd(exponent), _mm512_set1_pd(MAGIC));
        (F64x8(_mm512_castsi512_pd(fraction)), F64x8(exponent))
    }
}
