//! Windows, spectra, order tracking, filters and resampling of sampled signals.
//!
//! Everything works on slices of `f64` in the caller's unit and says what is wrong with an
//! [`Error`]. A slice of samples is in order of time, evenly spaced, or in order of the crank angle where the
//! documentation says so. Results do not depend on the thread, nor on what was computed before.
//!
//! | question | module |
//! |---|---|
//! | how much at which frequency? | [`amplitude_spectrum`](mod@amplitude_spectrum), [`welch`](mod@welch), [`spectral_shape`](mod@spectral_shape), [`windows`], [`segments`] |
//! | where are the impacts, and how often? | [`spectral_kurtosis`](mod@spectral_kurtosis), [`kurtogram`](mod@kurtogram), [`envelope`](mod@envelope), [`cepstrum`] |
//! | how much at which multiple of the speed? | [`crank_angle`], [`tacho`], [`angle_resampling`], [`order_spectrum`](mod@order_spectrum) |
//! | how do the revolutions differ? | [`synchronous_average`], [`crank_waterfall`](mod@crank_waterfall), [`phase_portrait`] |
//! | what do standards and indicators ask for? | [`overall_vibration`], [`indicated_work`](mod@indicated_work) |
//! | what does a measuring chain do? | [`biquad`], [`high_pass`], [`decimate`], [`delay`], [`noise`] |
//! | what has it done? | [`nonsynchronous`], [`quantisation`] |

pub mod amplitude_spectrum;
pub mod angle_resampling;
pub mod biquad;
pub mod cepstrum;
pub mod channel;
pub mod crank_angle;
pub mod crank_waterfall;
pub mod decimate;
pub mod delay;
pub mod envelope;
pub mod error;
pub mod high_pass;
pub mod indicated_work;
mod interpolation;
mod kaiser;
pub mod kurtogram;
pub mod noise;
pub mod nonsynchronous;
pub mod order_lines;
pub mod order_spectrum;
pub mod overall_vibration;
pub mod phase_portrait;
pub mod quantisation;
pub mod segments;
pub mod spectral_kurtosis;
pub mod spectral_shape;
pub mod synchronous_average;
pub mod tacho;
pub mod welch;
pub mod windows;

pub use error::Error;
pub use fourier::Complex64;
