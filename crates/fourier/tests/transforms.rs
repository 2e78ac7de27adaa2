//! Inverses, real and complex, and bits that do not depend on what came before.

use fourier::{Complex64, forward, inverse, inverse_complex};

fn samples(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * i) as f64 * 0.37).sin()).collect()
}

#[test]
fn inverse_undoes_forward() {
    for n in [1, 2, 3, 8, 17, 1200] {
        let back = inverse(forward(&mut samples(n)), n);
        for (b, x) in back.iter().zip(samples(n)) {
            assert!((b / n as f64 - x).abs() < 1e-13, "n = {n}");
        }
    }
}

#[test]
fn complex_inverse_agrees_with_the_real_one() {
    for n in [2, 16, 45] {
        let half = forward(&mut samples(n));
        let mut whole: Vec<Complex64> = (0..n)
            .map(|k| half.get(k).copied().unwrap_or_else(|| half[n - k].conj()))
            .collect();
        inverse_complex(&mut whole);
        for (c, x) in whole.iter().zip(inverse(half, n)) {
            assert!((c - x).norm() < 1e-12, "n = {n}");
        }
    }
}

#[test]
fn bits_do_not_depend_on_earlier_lengths() {
    let lengths = [8192, 6144, 4608];
    let fresh = lengths.map(|n| {
        std::thread::spawn(move || forward(&mut samples(n)))
            .join()
            .unwrap()
    });
    let used = std::thread::spawn(move || {
        for n in (1..400).map(|i| 16 * i) {
            forward(&mut samples(n));
        }
        lengths.map(|n| forward(&mut samples(n)))
    });
    assert_eq!(fresh, used.join().unwrap());
}
