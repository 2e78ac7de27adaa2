//! Windows, spectra, order tracking, filters and resampling of sampled signals.
//!
//! Everything works on slices of `f64` in the caller's unit and says what is wrong with an
//! [`Error`]. Results do not depend on the thread, nor on what was computed before.
//!
//! | question | module |
//! |---|---|
//! | how much at which frequency? | [`amplitude_spectrum`](mod@amplitude_spectrum), [`windows`] |
//! | how much at which multiple of the speed? | [`crank_angle`], [`angle_resampling`], [`order_spectrum`](mod@order_spectrum) |
//! | how do the revolutions differ? | [`phase_portrait`] |
//! | what does a measuring chain do? | [`biquad`], [`decimate`], [`noise`] |

pub mod amplitude_spectrum;
pub mod angle_resampling;
pub mod biquad;
pub mod channel;
pub mod crank_angle;
pub mod decimate;
pub mod error;
mod fft;
mod interpolation;
mod kaiser;
pub mod noise;
pub mod order_spectrum;
pub mod phase_portrait;
pub mod windows;

pub use error::Error;
pub use rustfft::num_complex::Complex64;
