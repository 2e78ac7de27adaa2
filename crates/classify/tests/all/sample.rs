//! Numbers that are the same on every machine.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Columns of uniform numbers in 0 to 1.
pub fn uniform(columns: usize, rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut column = || (0..rows).map(|_| random.random::<f64>()).collect();
    (0..columns).map(|_| column()).collect()
}

/// A group for each row.
pub fn each_by_itself(rows: usize) -> Vec<String> {
    (0..rows).map(|row| row.to_string()).collect()
}
