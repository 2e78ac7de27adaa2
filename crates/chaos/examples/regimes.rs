//! Counts the verdicts on chaotic, regular and stochastic signals of 10 000 samples.
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::regime::{Regime, verdict};
use chaos::test_systems::{Noise, Regular, System, with_noise};
use chaos::{Error, delay};

const SEEDS: u64 = 5;

fn main() -> Result<(), Error> {
    let length = std::env::args()
        .nth(1)
        .and_then(|a| a.parse().ok())
        .unwrap_or(10_000);
    println!("signal, noise, verdicts of {SEEDS} seeds");
    for share in [0.0, 0.01, 0.05] {
        for system in System::ALL {
            count(system.name(), share, |seed| system.samples(length, seed))?;
        }
        for regular in Regular::ALL {
            count(&format!("{regular:?}"), share, |seed| {
                regular.samples(length, seed)
            })?;
        }
    }
    for noise in Noise::ALL {
        count(&format!("{noise:?}"), 0.0, |seed| {
            noise.samples(length, seed)
        })?;
    }
    Ok(())
}

fn count(name: &str, share: f64, signal: impl Fn(u64) -> Vec<f64>) -> Result<(), Error> {
    let regimes = (1..=SEEDS)
        .map(|seed| {
            let signal = with_noise(&signal(seed), share, seed);
            Ok(verdict(&signal, &delay::times(&signal)?)?.regime)
        })
        .collect::<Result<Vec<Regime>, Error>>()?;
    let names: Vec<&str> = regimes.iter().map(|r| r.name()).collect();
    println!("{name:16} {share:4} {}", names.join(" "));
    Ok(())
}
