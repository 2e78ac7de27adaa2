//! Prints the exponents of the test systems by the tangent method, with the standard error from ten
//! stretches: `exponents [SAMPLES] [SYSTEM]`.
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::test_systems::System;

const STRETCHES: usize = 10;

fn main() {
    let samples = std::env::args().nth(1).and_then(|a| a.parse().ok());
    let samples: usize = samples.unwrap_or(4_000_000);
    let name = std::env::args().nth(2).unwrap_or_default().to_lowercase();
    for system in System::ALL {
        if !system.name().to_lowercase().contains(&name) {
            continue;
        }
        let found = system.tangent_exponents(samples / STRETCHES, STRETCHES);
        let mean = found.iter().sum::<f64>() / STRETCHES as f64;
        let square: f64 = found.iter().map(|e| (e - mean).powi(2)).sum();
        let error = (square / (STRETCHES * (STRETCHES - 1)) as f64).sqrt();
        println!(
            "{:13} {samples:9} samples {mean:.5} +- {error:.5}",
            system.name()
        );
    }
}
