//! The page about chaos: the tables, and the few cases that are simulated again for it.

mod bifurcations;
pub(super) mod cases;
mod motions;
mod page;
mod shown;
mod spectra;
