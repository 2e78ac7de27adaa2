//! Counts the verdicts on chaotic, regular and stochastic signals.
//!
//! ```sh
//! cargo run --release -p crosshead-chaos --example regimes -- 2000 50     # samples, seeds
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::regime::{Regime, verdict};
use chaos::test_systems::{Noise, Regular, System, with_noise};
use chaos::{Error, delay};
use std::time::Instant;

fn main() -> Result<(), Error> {
    let argument = |place: usize, default: usize| {
        let text = std::env::args().nth(place);
        text.and_then(|a| a.parse().ok()).unwrap_or(default)
    };
    let (length, seeds) = (argument(1, 10_000), argument(2, 5) as u64);
    println!("verdicts on {seeds} seeds of {length} samples");
    println!("signal           noise  periodic quasi-p. chaotic stochast. undecided   ms each");
    for noise in Noise::ALL {
        let signal = |seed| noise.samples(length, seed);
        count(&format!("{noise:?}"), 0.0, seeds, signal)?;
    }
    for share in [0.0, 0.01, 0.05] {
        for regular in Regular::ALL {
            let signal = |seed| regular.samples(length, seed);
            count(&format!("{regular:?}"), share, seeds, signal)?;
        }
        for system in System::ALL {
            let signal = |seed| system.samples(length, seed);
            count(system.name(), share, seeds, signal)?;
        }
    }
    Ok(())
}

fn count(
    name: &str,
    share: f64,
    seeds: u64,
    signal: impl Fn(u64) -> Vec<f64>,
) -> Result<(), Error> {
    let mut counts = [0; 5];
    let mut seconds = 0.0;
    for seed in 1..=seeds {
        let signal = with_noise(&signal(seed), share, seed);
        let start = Instant::now();
        let regime = verdict(&signal, &delay::times(&signal)?)?.regime;
        seconds += start.elapsed().as_secs_f64();
        counts[Regime::ALL.iter().position(|r| *r == regime).unwrap_or(0)] += 1;
    }
    let [periodic, quasi, chaotic, stochastic, undecided] = counts;
    println!(
        "{name:16} {:4.0} % {periodic:9} {quasi:8} {chaotic:7} {stochastic:9} {undecided:9} {:9.0}",
        share * 100.0,
        seconds / seeds as f64 * 1e3
    );
    Ok(())
}
