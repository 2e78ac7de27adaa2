//! The normal distribution.

/// Standard deviations on either side that bound 95 % of it.
pub const QUANTILE: f64 = 1.959_964;
