//! Eight lanes: two registers of AVX2. Most of an evaluation waits for the operation before; of two registers
//! one is worked on while the other waits.
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
pub(super) struct F64x8([__m256d; 2]);

/// Eight truth values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truths([__m256d; 2]);

lanes!(F64x8, 8, few: 4);

/// What a function of one register makes of both.
macro_rules! both {
    ($function:path, $($of:expr),+) => {
        [$function($($of.0[0]),+), $function($($of.0[1]),+)]
    };
}

/// Whether this processor has the instructions.
pub(super) fn is_present() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[inline(always)]
fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    #[target_feature(enable = "avx2,fma")]
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
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        let [low, high] = self.0.map(|half| unsafe { _mm256_movemask_pd(half) });
        let signs = low | high << 4;
        std::array::from_fn(|lane| signs >> lane & 1 == 1)
    }
    fn from_array(truths: [bool; 8]) -> Self {
        let numbers = truths.map(|truth| f64::from_bits(if truth { u64::MAX } else { 0 }));
        Self(F64x8::from_array(numbers).0)
    }
}

impl Mask for Truths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        Self(unsafe { both!(_mm256_and_pd, self, other) })
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        Self(unsafe { both!(_mm256_or_pd, self, other) })
    }
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        let all = Self(unsafe { [_mm256_castsi256_pd(_mm256_set1_epi64x(-1)); 2] });
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        Self(unsafe { both!(_mm256_xor_pd, self, all) })
    }
    #[inline(always)]
    fn any(self) -> bool {
        // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
        unsafe { _mm256_movemask_pd(self.0[0]) | _mm256_movemask_pd(self.0[1]) != 0 }
    }
}

#[inline(always)]
fn splat(x: f64) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { [_mm256_set1_pd(x); 2] })
}
#[inline(always)]
fn add(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_add_pd, a, b) })
}
#[inline(always)]
fn subtract(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_sub_pd, a, b) })
}
#[inline(always)]
fn multiply(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_mul_pd, a, b) })
}
#[inline(always)]
fn divide(a: F64x8, b: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_div_pd, a, b) })
}
#[inline(always)]
fn multiply_add(a: F64x8, b: F64x8, c: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_fmadd_pd, a, b, c) })
}
#[inline(always)]
fn negate(a: F64x8) -> F64x8 {
    let sign = splat(-0.0);
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_xor_pd, a, sign) })
}
#[inline(always)]
fn square_root(a: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_sqrt_pd, a) })
}
#[inline(always)]
fn less(a: F64x8, b: F64x8) -> Truths {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    Truths(unsafe { both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b) })
}
#[inline(always)]
fn equal(a: F64x8, b: F64x8) -> bool {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let [low, high] = both!(_mm256_cmp_pd::<_CMP_EQ_OQ>, a, b);
        _mm256_movemask_pd(_mm256_and_pd(low, high)) == 0xf
    }
}
#[inline(always)]
fn choose(mask: Truths, yes: F64x8, no: F64x8) -> F64x8 {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    F64x8(unsafe { both!(_mm256_blendv_pd, no, yes, mask) })
}
#[inline(always)]
fn bit(a: F64x8, number: u32) -> Truths {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let wanted = _mm256_set1_epi64x(1 << number);
        let low = _mm256_and_si256(_mm256_castpd_si256(a.0[0]), wanted);
        let high = _mm256_and_si256(_mm256_castpd_si256(a.0[1]), wanted);
        Truths([
            _mm256_castsi256_pd(_mm256_cmpeq_epi64(low, wanted)),
            _mm256_castsi256_pd(_mm256_cmpeq_epi64(high, wanted)),
        ])
    }
}
#[inline(always)]
fn two_to_the(a: F64x8) -> F64x8 {
    F64x8(both!(power, a))
}
#[inline(always)]
fn power(a: __m256d) -> __m256d {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let biased = _mm256_add_epi64(_mm256_castpd_si256(a), _mm256_set1_epi64x(1023));
        _mm256_castsi256_pd(_mm256_slli_epi64::<52>(biased))
    }
}
#[inline(always)]
fn split(a: F64x8) -> (F64x8, F64x8) {
    let [low, high] = both!(split_half, a);
    (F64x8([low.0, high.0]), F64x8([low.1, high.1]))
}
#[inline(always)]
fn split_half(a: __m256d) -> (__m256d, __m256d) {
    // SAFETY: only `in_lanes` gets here, which asks `is_present`; no memory is touched.
    unsafe {
        let bits = _mm256_castpd_si256(a);
        let offset = _mm256_add_epi64(bits, _mm256_set1_epi64x(SPLIT_BIAS as i64));
        let biased = _mm256_srli_epi64::<52>(offset);
        let power = _mm256_slli_epi64::<52>(biased);
        let one = _mm256_set1_epi64x(1023 << 52);
        let fraction = _mm256_sub_epi64(bits, _mm256_sub_epi64(power, one));
        let exponent = _mm256_or_si256(biased, _mm256_set1_epi64x(MAGIC_EXPONENT as i64));
        let exponent = _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(MAGIC));
        (_mm256_castsi256_pd(fraction), exponent)
    }
}
