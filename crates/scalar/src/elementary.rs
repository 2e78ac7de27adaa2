//! Sine, cosine, exponential and logarithm in IEEE additions, multiplications, divisions and fused
//! multiply-adds. These are written where they are meant and nowhere else: the same bits on every machine.
//!
//! Each reduces its argument to a short interval and sums a polynomial there. The error is below 4e-18 of
//! the result everywhere (found by the exchange algorithm of Remez 1934 in 60 digits, and rounded). The
//! tests below hold each to 4 units in the last place of the platform's function over 200,000 arguments.

use crate::{Mask, Scalar};

/// A number, or several side by side, that can be taken apart.
pub trait Bits: Scalar {
    /// Whether bit `number` of the representation is 1.
    fn bit(self, number: u32) -> Self::Mask;
    /// 2 to the power of the whole number in the lowest 11 bits of the representation.
    fn two_to_the(self) -> Self;
    /// f and k of x = 2^k f with f in [sqrt(1/2), sqrt(2)), for a positive, normal x.
    fn split(self) -> (Self, Self);
}

/// What to add to the bits of x so that the exponent then is k + 1023. It is minus the bits of sqrt(1/2), and
/// the bits of 1.
pub(crate) const SPLIT_BIAS: u64 = (1023_u64 << 52).wrapping_sub(0x3fe6_a09e_667f_3bcd);
/// 2^52, as bits: with a whole number below 2^52 in its place for the fraction it is the sum of both.
pub(crate) const MAGIC_EXPONENT: u64 = 1075 << 52;
/// 2^52 + 1023.
pub(crate) const MAGIC: f64 = 4_503_599_627_371_519.0;

impl Bits for f64 {
    #[inline(always)]
    fn bit(self, number: u32) -> bool {
        self.to_bits() >> number & 1 == 1
    }
    #[inline(always)]
    fn two_to_the(self) -> f64 {
        f64::from_bits(self.to_bits().wrapping_add(1023) << 52)
    }
    #[inline(always)]
    fn split(self) -> (f64, f64) {
        let bits = self.to_bits();
        let biased = bits.wrapping_add(SPLIT_BIAS) >> 52;
        let fraction = bits.wrapping_sub((biased << 52).wrapping_sub(1023 << 52));
        let exponent = f64::from_bits(biased | MAGIC_EXPONENT) - MAGIC;
        (f64::from_bits(fraction), exponent)
    }
}

/// (sin r − r)/r³ in r², for |r| up to π/4.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_3,
    0.008_333_333_333_322_118,
    -0.000_198_412_698_295_895_47,
    2.755_731_362_137_272e-6,
    -2.505_074_775_935_292_3e-8,
    1.589_622_989_953_627_8e-10,
];
/// (cos r − 1)/r² in r², for |r| up to π/4; the first is exact.
const COSINE: [f64; 7] = [
    -0.5,
    0.041_666_666_666_666_595,
    -0.001_388_888_888_887_305_6,
    2.480_158_728_885_164e-5,
    -2.755_731_417_927_275_3e-7,
    2.087_570_083_816_871e-9,
    -1.135_853_630_514_399_9e-11,
];
/// (e^r − 1 − r)/r² in r, for |r| up to ln 2/2.
const EXPONENTIAL: [f64; 10] = [
    0.500_000_000_000_001_1,
    0.166_666_666_666_664_13,
    0.041_666_666_666_530_27,
    0.008_333_333_333_494_425,
    0.001_388_888_894_359_615_7,
    0.000_198_412_695_065_790_57,
    2.480_149_313_727_596_7e-5,
    2.755_758_644_248_999_6e-6,
    2.763_023_367_352_606e-7,
    2.500_001_819_500_999e-8,
];
/// (artanh s − s)/s³ in s², for |s| up to tan² π/8.
const LOGARITHM: [f64; 7] = [
    0.333_333_333_333_336_7,
    0.199_999_999_997_073_27,
    0.142_857_143_711_958_65,
    0.111_110_992_864_125_7,
    0.090_917_821_715_554_97,
    0.076_570_250_686_711_33,
    0.073_979_768_971_849_98,
];

/// The polynomial with these coefficients at `x`: even and odd powers each by Horner's rule, so that
/// two sums grow side by side (Knuth 1997, section 4.6.4).
#[inline(always)]
fn sum<S: Scalar, const N: usize>(coefficients: &[f64; N], x: S) -> S {
    let square = x * x;
    let mut last = S::constant(coefficients[N - 1]);
    let mut other = S::constant(coefficients[N - 2]);
    let mut i = N - 2;
    while i > 0 {
        i -= 1;
        (last, other) = (other, last.mul_add(square, S::constant(coefficients[i])));
    }
    // The last one that was added to holds the constant.
    last.mul_add(x, other)
}

/// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer, and leaves that integer in
/// the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// pi/2 in three parts (Cody and Waite 1980): the first two have trailing zeros, so that their
/// products with an integer below 2^20 are exact.
const HALF_PI: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];

/// ln 2 in two parts, the first with 21 trailing zero bits.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// `x` without `count` times the sum of the parts. A loop, as `fold` may be compiled without the instructions of
/// lanes.
#[inline(always)]
fn without<S: Scalar, const N: usize>(x: S, count: S, parts: &[f64; N]) -> S {
    let mut rest = x;
    let mut i = 0;
    while i < N {
        rest = count.mul_add(S::constant(-parts[i]), rest);
        i += 1;
    }
    rest
}

/// Sine and cosine of `x` radians, for |x| below 1e6 (19,000 revolutions).
#[inline(always)]
pub fn sin_cos<S: Bits>(x: S) -> (S, S) {
    let shifted = x.mul_add(
        S::constant(std::f64::consts::FRAC_2_PI),
        S::constant(ROUNDER),
    );
    let quarter = shifted - ROUNDER;
    let r = without(x, quarter, &HALF_PI);
    let r2 = r * r;

    let sine = sum(&SINE, r2);
    let cosine = sum(&COSINE, r2);
    let sine = (r * r2).mul_add(sine, r);
    let cosine = r2.mul_add(cosine, S::constant(1.0));

    // The quadrant is in the lowest two bits: 1 and 3 swap sine and cosine, 2 and 3 turn the sine's
    // sign, 1 and 2 the cosine's.
    let (odd, beyond) = (shifted.bit(0), shifted.bit(1));
    let s = S::select(odd, cosine, sine);
    let c = S::select(odd, sine, cosine);
    let between = odd.and(beyond.not()).or(beyond.and(odd.not()));
    (S::select(beyond, -s, s), S::select(between, -c, c))
}

/// e to the power `x`, for |x| below 700.
#[inline(always)]
pub fn exp<S: Bits>(x: S) -> S {
    let shifted = x.mul_add(S::constant(std::f64::consts::LOG2_E), S::constant(ROUNDER));
    let k = shifted - ROUNDER;
    let r = without(x, k, &LN_2);
    let value = S::constant(1.0) + (r * r).mul_add(sum(&EXPONENTIAL, r), r);
    value * shifted.two_to_the()
}

/// Natural logarithm of a positive, normal `x`.
#[inline(always)]
pub fn ln<S: Bits>(x: S) -> S {
    let (f, k) = x.split();
    // ln f = 2 artanh s = 2 (s + s^3/3 + s^5/5 + ...), written as f - 1 and a correction, so
    // that nothing is lost near f = 1.
    let g = f - 1.0;
    let s = g / (g + 2.0);
    let s2 = s * s;
    let half_square = g * 0.5 * g;
    let correction = s * (s2 * 2.0).mul_add(sum(&LOGARITHM, s2), half_square);
    let low = k.mul_add(S::constant(LN_2[1]), correction);
    k.mul_add(S::constant(LN_2[0]), g - (half_square - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ulps(ours: f64, theirs: f64) -> f64 {
        let spacing = f64::from_bits(theirs.abs().to_bits() + 1) - theirs.abs();
        (ours - theirs).abs() / spacing
    }

    fn worst(
        arguments: impl Iterator<Item = f64>,
        ours: fn(f64) -> f64,
        theirs: fn(f64) -> f64,
    ) -> f64 {
        arguments
            .map(|x| ulps(ours(x), theirs(x)))
            .fold(0.0, f64::max)
    }

    /// 200,000 arguments spread over `low..high`, never on round numbers.
    fn grid(low: f64, high: f64) -> impl Iterator<Item = f64> {
        (0..200_000).map(move |i| low + (high - low) * (f64::from(i) + 0.345_678_9) / 200_000.0)
    }

    #[test]
    fn sine_and_cosine_agree_with_the_platform_to_a_few_ulps() {
        assert!(worst(grid(-700.0, 700.0), |x| sin_cos(x).0, f64::sin) < 4.0);
        assert!(worst(grid(-700.0, 700.0), |x| sin_cos(x).1, f64::cos) < 4.0);
    }

    #[test]
    fn exponential_agrees_with_the_platform_to_a_few_ulps() {
        assert!(worst(grid(-30.0, 30.0), exp, f64::exp) < 4.0);
    }

    #[test]
    fn logarithm_agrees_with_the_platform_to_a_few_ulps() {
        assert!(worst(grid(0.5, 2.0), ln, f64::ln) < 4.0);
        assert!(worst(grid(1e-6, 1e6), ln, f64::ln) < 4.0);
    }

    #[test]
    fn arc_tangent_agrees_with_the_platform_to_a_few_ulps_and_has_its_slope() {
        assert!(worst(grid(-3.0, 3.0), Scalar::atan, f64::atan) < 4.0);
        assert!(worst(grid(-1e6, 1e6), Scalar::atan, f64::atan) < 4.0);
        for x in [-40.0, -1.0, -0.3, 0.0, 0.7, 5.0] {
            let slope = crate::Dual::<f64, 1>::variable(x, 0).atan().tangent[0];
            assert!((slope * (1.0 + x * x) - 1.0).abs() < 1e-13, "{x}: {slope}");
        }
    }

    #[test]
    fn exact_values_are_exact() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(ln(1.0), 0.0);
    }
}
