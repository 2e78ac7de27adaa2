//! Fourier transforms, with the plans kept per thread.
//!
//! The transforms of `rustfft` are generic: each crate that plans one compiles all of them, half a megabyte. Here they
//! are compiled once.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

pub use rustfft::num_complex::Complex64;

/// Lengths kept per thread. Windows of a sweep come in many lengths; past this number the plans
/// are dropped, so that memory does not grow with the sweep.
const KEPT: usize = 16;

/// The plans of one direction by length.
///
/// Every length is planned from nothing. A shared planner would build a transform out of the
/// shorter ones that it happens to hold. Then the last bits of a result would depend on what
/// the thread had computed before.
struct Plans<T: ?Sized>(RefCell<BTreeMap<usize, Arc<T>>>);

impl<T: ?Sized> Plans<T> {
    const fn new() -> Self {
        Self(RefCell::new(BTreeMap::new()))
    }

    fn get(&self, length: usize, plan: impl FnOnce() -> Arc<T>) -> Arc<T> {
        let mut plans = self.0.borrow_mut();
        if plans.len() >= KEPT && !plans.contains_key(&length) {
            plans.clear();
        }
        let entry = plans.entry(length);
        Arc::clone(entry.or_insert_with(plan))
    }
}

thread_local! {
    static FORWARD: Plans<dyn RealToComplex<f64>> = const { Plans::new() };
    static INVERSE: Plans<dyn ComplexToReal<f64>> = const { Plans::new() };
    static COMPLEX_INVERSE: Plans<dyn Fft<f64>> = const { Plans::new() };
}

/// X_k = Σ_j x_j e^(−2πi jk/n) for k = 0 ..= n/2. Uses `x` as work space; `x` is not empty.
pub fn forward(x: &mut [f64]) -> Vec<Complex64> {
    let n = x.len();
    let plan = FORWARD.with(|plans| plans.get(n, || RealFftPlanner::new().plan_fft_forward(n)));
    let mut spectrum = plan.make_output_vec();
    plan.process(x, &mut spectrum)
        .expect("the plan was made for this length");
    spectrum
}

/// x_j = Σ_k X_k e^(2πi jk/n) over all n bins, of which `spectrum` holds 0 ..= n/2 (no 1/n).
/// The imaginary parts of bin 0 and of the Nyquist bin are ignored. `n` is not 0.
pub fn inverse(mut spectrum: Vec<Complex64>, n: usize) -> Vec<f64> {
    spectrum[0].im = 0.0;
    if n.is_multiple_of(2) {
        spectrum[n / 2].im = 0.0;
    }
    let plan = INVERSE.with(|plans| plans.get(n, || RealFftPlanner::new().plan_fft_inverse(n)));
    let mut x = plan.make_output_vec();
    plan.process(&mut spectrum, &mut x)
        .expect("the plan was made for this length, and bins 0 and n/2 are real");
    x
}

/// x_j = Σ_k X_k e^(2πi jk/n) of complex values, in place (no 1/n). `x` is not empty.
pub fn inverse_complex(x: &mut [Complex64]) {
    let n = x.len();
    let plan = COMPLEX_INVERSE.with(|p| p.get(n, || FftPlanner::new().plan_fft_inverse(n)));
    plan.process(x);
}
