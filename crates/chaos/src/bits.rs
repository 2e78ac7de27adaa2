//! Comparisons of many numbers at once, whose results are the bits of words.

/// Bits in a word.
pub(crate) const WORD: usize = u64::BITS as usize;

/// Which of these numbers are less than `limit`, a bit each, the first one the lowest. There are [`WORD`] at most.
#[inline(always)]
pub(crate) fn below(numbers: &[f64], limit: f64) -> u64 {
    let mut bytes = [0; WORD];
    for (byte, number) in bytes.iter_mut().zip(numbers) {
        *byte = u8::from(*number < limit);
    }
    // Eight bytes of 0 or 1 become the eight highest bits of a product, the first one the lowest.
    let (eights, _) = bytes.as_chunks::<8>();
    let packed = eights
        .iter()
        .map(|eight| u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56);
    packed
        .enumerate()
        .fold(0, |word, (place, byte)| word | byte << (8 * place))
}
