//! Several numbers side by side: every operation acts on each lane alone.
//!
//! There is one type for each instruction set, whose numbers fill one register, or two of AVX2. Where the processor
//! has neither, a plain number is the one lane. Which of them it has is known when the program runs: [`in_lanes`]
//! chooses. No other way leads to the types, so nobody can use them on a processor that lacks them.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod operations;

pub use operations::Lanes;

use std::sync::OnceLock;

/// Work that is written for lanes of any width.
pub trait InLanes {
    /// What it yields.
    type Output;
    /// Does it in `W` lanes.
    fn run<L: Lanes<W>, const W: usize>(self) -> Self::Output;
}

/// The environment variable that holds the width of registers down.
pub const WIDTH_VARIABLE: &str = "CROSSHEAD_LANES";

/// Does `work` in lanes: 8 in a register of AVX-512 or in two of AVX2, 1 elsewhere. The results do not depend on
/// it.
pub fn in_lanes<T: InLanes>(work: T) -> T::Output {
    match width() {
        #[cfg(target_arch = "x86_64")]
        8 => work.run::<avx512::F64x8, 8>(),
        #[cfg(target_arch = "x86_64")]
        4 => work.run::<avx2::F64x8, 8>(),
        _ => work.run::<f64, 1>(),
    }
}

/// How many numbers the registers hold that [`in_lanes`] takes: 8 with AVX-512, 4 with AVX2, 1 elsewhere.
/// `CROSSHEAD_LANES` in the environment lowers it, to measure the gain of lanes. It never raises it above what the
/// processor has.
pub fn width() -> usize {
    static WIDTH: OnceLock<usize> = OnceLock::new();
    *WIDTH.get_or_init(|| {
        let asked = std::env::var(WIDTH_VARIABLE).ok();
        let most = asked.and_then(|text| text.parse().ok());
        let most = most.unwrap_or(usize::MAX);
        widths().into_iter().find(|w| *w <= most).unwrap_or(1)
    })
}

/// The widths that this processor has, the greatest first.
fn widths() -> Vec<usize> {
    #[cfg(target_arch = "x86_64")]
    {
        let has = [avx512::is_present(), avx2::is_present(), true];
        let widths = [8, 4, 1].into_iter().zip(has);
        widths.filter_map(|(w, has)| has.then_some(w)).collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    vec![1]
}

/// Does `work` in lanes of every width that this processor has: for tests.
pub fn in_all_lanes<T: InLanes + Copy>(work: T) -> Vec<T::Output> {
    let run = |width| match width {
        #[cfg(target_arch = "x86_64")]
        8 => work.run::<avx512::F64x8, 8>(),
        #[cfg(target_arch = "x86_64")]
        4 => work.run::<avx2::F64x8, 8>(),
        _ => work.run::<f64, 1>(),
    };
    widths().into_iter().map(run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mask, Scalar};

    fn f<S: Scalar>(x: S, y: S) -> S {
        let (s, c) = (x * y).sin_cos();
        let far = (x * 40.0 - y).sin_cos();
        let apart = x.lt(y).and(y.lt(S::constant(2.0)).not()).or(c.lt(s));
        let chosen = S::select(apart, far.0, -far.1);
        let sums = (x.exp() * s - c / (y + 2.0)).abs().sqrt();
        sums.mul_add(y, sums) + (x + y).ln() * x.powf(y).max(y) - 1.5
            + chosen * (x.ln().min(-x) - 3.0).exp()
    }

    const X: [f64; 8] = [0.1, 0.7, 2.5, 40.0, 1e-3, 3.3, 0.9, 11.0];
    const Y: [f64; 8] = [1.3, 0.2, 0.9, 0.01, 7.0, 1.1, 2.2, 0.5];

    #[derive(Clone, Copy)]
    struct Bits;

    impl InLanes for Bits {
        type Output = usize;
        fn run<L: Lanes<W>, const W: usize>(self) -> usize {
            let take = |of: [f64; 8]| L::from_array(std::array::from_fn(|i| of[i]));
            let lanes = L::vectorised(|| f(take(X), take(Y)));
            for i in 0..W {
                assert_eq!(lanes.get(i).to_bits(), f(X[i], Y[i]).to_bits(), "lane {i}");
            }
            let truths = std::array::from_fn(|i| i % 3 == 0);
            assert_eq!(L::truths(L::mask(truths)), truths);
            assert!(L::mask(truths).any());
            W
        }
    }

    #[test]
    fn each_lane_has_the_bits_of_the_plain_number_at_every_width() {
        let widths = in_all_lanes(Bits);
        assert_eq!(widths.len(), super::widths().len());
        assert_eq!(widths.last(), Some(&1));
    }
}
