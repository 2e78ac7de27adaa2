//! Prints the exponent found from the signal of each test system beside the true one.
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::test_systems::{System, with_noise};
use chaos::{delay, jacobian};
use std::time::Instant;

const SEEDS: u64 = 5;

fn main() -> Result<(), chaos::Error> {
    let length = std::env::args()
        .nth(1)
        .and_then(|a| a.parse().ok())
        .unwrap_or(10_000);
    println!("system         noise  median |error|  median  true (per sample)  covered  s each");
    for system in System::ALL {
        let truth = system.exponent() * system.sample_interval();
        for share in [0.0, 0.01, 0.05] {
            let start = Instant::now();
            let (mut errors, mut values, mut covered) = (Vec::new(), Vec::new(), 0);
            let mut model = None;
            for seed in 1..=SEEDS {
                let signal = with_noise(&system.samples(length, seed), share, seed);
                let found = jacobian::exponent(&signal, &delay::times(&signal)?)?;
                errors.push((found.value / truth - 1.0).abs());
                values.push(found.value);
                covered += u32::from(found.low <= truth && truth <= found.high);
                model = Some((found.model, found.prediction_error));
            }
            errors.sort_by(f64::total_cmp);
            values.sort_by(f64::total_cmp);
            println!(
                "{:13} {:4.0} % {:12.1} % {:10.5} {truth:8.5} {covered:12}/{SEEDS} {:10.2}  {model:?}",
                system.name(),
                share * 100.0,
                errors[errors.len() / 2] * 100.0,
                values[values.len() / 2],
                start.elapsed().as_secs_f64() / SEEDS as f64,
            );
        }
    }
    Ok(())
}
