//! Significant digits of numbers that come by different ways and are one.

/// Digits to which the values of cases are compared. One length in two units, or a speed in rpm and in rad/s, differs
/// in the 16th.
pub(crate) const COMPARED: u32 = 12;

/// `value` to this many significant digits.
pub(crate) fn rounded(value: f64, digits: u32) -> f64 {
    let after_the_first = digits.saturating_sub(1) as usize;
    format!("{value:.after_the_first$e}")
        .parse()
        .unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_in_the_last_bit_is_one_number() {
        let lengths = [0.000_2_f64, 0.000_199_999_999_999_999_98];
        assert_ne!(lengths[0].to_bits(), lengths[1].to_bits());
        assert_eq!(lengths.map(|x| rounded(x, COMPARED)), [2e-4; 2]);
        assert_eq!(rounded(lengths[1], f64::DIGITS), 2e-4);
        assert_eq!(rounded(-1.234_567_890_123_4, COMPARED), -1.234_567_890_12);
        assert!(rounded(f64::NAN, COMPARED).is_nan());
        assert_eq!(rounded(f64::NEG_INFINITY, COMPARED), f64::NEG_INFINITY);
    }
}
