//! Analyses the measured recordings in `data/recordings`: a chaotic laser, and a circuit driven by
//! noise.
//!
//! ```sh
//! cargo run --release -p crosshead-chaos --example recordings
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::correlation_dimension::correlation_dimension;
use chaos::neighbours::Delays;
use chaos::{delay, dimension, regime, zero_one};
use std::error::Error;

/// Most samples that are analysed.
const SAMPLES: usize = 10_000;

fn main() -> Result<(), Box<dyn Error>> {
    for (file, column) in [
        ("santafe-laser/santafe_laser.csv", 0),
        ("silverbox-duffing/odd_multisine.csv", 1),
        ("silverbox-duffing/growing_amplitude_tail.csv", 1),
    ] {
        println!("{file}");
        analyse(&read(file, column)?)?;
    }
    Ok(())
}

fn read(file: &str, column: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/recordings/");
    let text = std::fs::read_to_string(format!("{folder}{file}"))?;
    let fields = text
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(column));
    Ok(fields
        .take(SAMPLES)
        .map(str::parse)
        .collect::<Result<_, _>>()?)
}

fn analyse(signal: &[f64]) -> Result<(), chaos::Error> {
    let times = delay::times(signal)?;
    println!(
        "  mean period {:.2} samples, delay {}",
        times.mean_period, times.delay
    );
    let unfolding = dimension::unfolding(signal, &times, 8)?;
    println!(
        "  coordinates: {:?} by false neighbours, {:?} by Cao",
        unfolding.by_false_neighbours(),
        unfolding.by_cao()
    );
    let delays = Delays {
        signal,
        dimension: unfolding.dimension(),
        delay: times.delay,
    };
    let correlation = correlation_dimension(&delays, times.theiler)?;
    println!(
        "  correlation dimension {:.2}, scatter of its slope {:.2}",
        correlation.value, correlation.scatter
    );
    println!("  0-1 test {:.2}", zero_one::zero_one(signal, times.delay)?);
    let verdict = regime::verdict(signal, &times)?;
    if let Some(test) = verdict.predictability {
        println!(
            "  predicted better than its surrogates by {:.0} standard deviations ({})",
            test.deviations,
            if test.significant {
                "significant"
            } else {
                "chance"
            }
        );
    }
    if let Some(exponent) = verdict.exponent {
        println!(
            "  largest exponent {:.4} nats per sample, 95 %: {:.4} to {:.4}",
            exponent.value, exponent.low, exponent.high
        );
    }
    println!("  {}", verdict.regime.name());
    Ok(())
}
