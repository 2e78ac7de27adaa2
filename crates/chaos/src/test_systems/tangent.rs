//! The growth of a tangent along a trajectory (Benettin et al. 1980).

use scalar::Dual;

/// Samples left out at the start.
pub const TRANSIENT: usize = 2000;

/// A coordinate with its derivative along the one tangent that is followed.
pub type Tangent = Dual<f64, 1>;

/// Means of `growth` (nats per call) over successive stretches after the transient.
pub fn mean_growths(
    (length, stretches): (usize, usize),
    mut growth: impl FnMut() -> f64,
) -> Vec<f64> {
    (0..TRANSIENT).for_each(|_| {
        growth();
    });
    (0..stretches)
        .map(|_| (0..length).map(|_| growth()).sum::<f64>() / length as f64)
        .collect()
}

/// Brings the tangent back to length 1 and returns the logarithm of what it was.
pub fn renormalise(y: &mut [Tangent]) -> f64 {
    let norm = y.iter().map(|c| c.tangent[0].powi(2)).sum::<f64>().sqrt();
    y.iter_mut().for_each(|c| c.tangent[0] /= norm);
    norm.ln()
}
