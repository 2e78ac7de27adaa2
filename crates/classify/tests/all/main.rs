//! Areas, boosting, the domain gap and baselines.

mod area;
mod baseline;
mod boosting;
mod domain_gap;
mod sample;
