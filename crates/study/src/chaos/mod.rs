//! What a dataset shows of chaos: exponents and regimes, and the motions behind them.

pub mod agreement;
pub mod bifurcations;
pub mod cases;
pub mod claims;
pub mod motions;
pub mod regime;
pub mod shown;
pub mod spectra;
