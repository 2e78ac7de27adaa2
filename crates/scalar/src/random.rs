//! Random streams that depend on what they are for, never on thread or order.
//!
//! ChaCha8 (Bernstein 2008) is specified, so a seed gives the same numbers on every machine and
//! with every version of the crate. A stream is keyed by the sweep's seed and numbered by the
//! case and the purpose within it.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A stream of random numbers.
pub type Stream = ChaCha8Rng;

/// What a stream of a case is drawn for; another purpose never shifts the numbers of this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The values of a random design.
    Design,
    /// The variation of unknowns.
    Variation,
    /// The noise of the sensors.
    Noise,
    /// Membership of a split.
    Split,
    /// The crank angle at which a recording begins.
    Start,
}

/// The stream of `purpose` for case (or group) `index` of the sweep with this `seed`.
pub fn stream(seed: u64, index: u64, purpose: Purpose) -> Stream {
    let mut key = [0_u8; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8] = purpose as u8;
    let mut generator = ChaCha8Rng::from_seed(key);
    generator.set_stream(index);
    generator
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, index, purpose| stream(seed, index, purpose).next_u64();
        assert_eq!(draw(1, 2, Purpose::Noise), draw(1, 2, Purpose::Noise));
        assert_ne!(draw(1, 2, Purpose::Noise), draw(1, 3, Purpose::Noise));
        assert_ne!(draw(1, 2, Purpose::Noise), draw(2, 2, Purpose::Noise));
        assert_ne!(draw(1, 2, Purpose::Noise), draw(1, 2, Purpose::Design));
    }
}
