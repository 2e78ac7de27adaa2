//! Hashing of small whole numbers, for everything that is drawn by index.

/// Mixes `value` so that every bit of it changes about half of the result's bits: the finaliser of
/// SplitMix64 (Steele, Lea and Flood 2014), with the constants of Stafford's variant 13.
fn mix(mut value: u64) -> u64 {
    value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// One number that stands for the sequence `words`.
pub fn hash(words: &[u64]) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    words.iter().fold(GOLDEN, |state, &word| {
        mix(state.wrapping_add(GOLDEN) ^ mix(word.wrapping_add(GOLDEN)))
    })
}

/// The number in (0, 1) that the upper 52 bits of `bits` stand for: the middle of its step, so
/// that neither end is ever reached and every quantile is finite.
pub fn unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_bit_flips_about_half_of_the_output_bits() {
        let start = hash(&[3, 4]);
        for bit in 0..64 {
            let flipped = (hash(&[3 ^ (1 << bit), 4]) ^ start).count_ones();
            assert!((14..=50).contains(&flipped), "bit {bit}: {flipped}");
        }
        assert_ne!(hash(&[3, 4]), hash(&[4, 3]));
        assert_ne!(hash(&[0]), hash(&[0, 0]));
    }

    #[test]
    fn unit_numbers_stay_inside() {
        assert!(unit(0) > 0.0);
        assert!(unit(u64::MAX) < 1.0);
        assert_eq!(unit(1 << 63), 0.5 + 0.5 / (1_u64 << 52) as f64);
    }
}
