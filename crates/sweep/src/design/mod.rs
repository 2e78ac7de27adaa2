//! Designs of experiments. A point is computed from its index; nothing is stored.

pub mod full_factorial;
pub mod hash;
mod joe_kuo;
pub mod latin_hypercube;
pub mod random;
pub mod sobol;
