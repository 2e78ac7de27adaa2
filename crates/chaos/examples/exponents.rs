//! Prints the exponents of the test systems by the tangent method.
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::test_systems::System;

fn main() {
    for system in System::ALL {
        for length in [500_000, 4_000_000] {
            let exponent = system.tangent_exponent(length);
            println!("{:13} {length:8} samples {exponent:.5}", system.name());
        }
    }
}
