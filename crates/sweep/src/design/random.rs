//! Plain random sampling, point by point.

use rand::Rng;
use scalar::random::{Purpose, stream};

use super::hash::unit;

/// The first `dimensions` coordinates of point `index`, each in (0, 1).
pub fn point(seed: u64, index: u64, dimensions: usize) -> Vec<f64> {
    let mut stream = stream(seed, index, Purpose::Design);
    (0..dimensions).map(|_| unit(stream.next_u64())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_repeat_spread_and_do_not_depend_on_the_number_of_dimensions() {
        assert_eq!(point(1, 2, 3), point(1, 2, 3));
        assert_eq!(point(1, 2, 3)[..2], point(1, 2, 2)[..]);
        let mean = (0..1000).map(|i| point(4, i, 1)[0]).sum::<f64>() / 1000.0;
        // Four standard errors: 4 √(1/12/1000).
        assert!((mean - 0.5).abs() < 0.0366, "{mean}");
    }
}
