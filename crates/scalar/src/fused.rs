//! Fused multiply-adds for plain numbers: one instruction where the processor has it. Elsewhere it is a call of the C
//! library, which takes long and rounds the same.
#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "instructions that not every processor has")
)]

/// Does `work` with the instructions that the processor has for fused multiply-adds.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    #[target_feature(enable = "avx2,fma")]
    fn with_instructions<T>(work: impl FnOnce() -> T) -> T {
        work()
    }
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor has them, as the line before has found.
        unsafe { with_instructions(work) }
    } else {
        work()
    }
}

/// Does `work`: elsewhere all processors have the same instructions.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn vectorised<T>(work: impl FnOnce() -> T) -> T {
    work()
}
