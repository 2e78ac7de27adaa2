//! Windows, spectra, order tracking, filters and resampling of sampled signals.

pub mod channel;
