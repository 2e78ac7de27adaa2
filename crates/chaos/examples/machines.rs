//! Counts how many machines with a load, timing or amplitude that chance gives to each cycle are called
//! chaotic: 14 kinds, three memories of chance, two spreads, with and without a crank angle.
//!
//! ```sh
//! cargo run --release -p crosshead-chaos --example machines -- 1     # seed
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::regime::{Phase, Regime, Verdict, chance_at_a_phase, driven_verdict, verdict};
use chaos::test_systems::{Machine, Memory};
use chaos::{Error, delay};

/// Cycles, and samples of each.
const CYCLES: usize = 80;
const PER_CYCLE: usize = 100;

fn main() -> Result<(), Error> {
    let seed = std::env::args().nth(1).and_then(|a| a.parse().ok());
    let seed = seed.unwrap_or(1);
    let (mut all, mut with_angle, mut without) = (0, 0, 0);
    for machine in Machine::ALL {
        for memory in Memory::ALL {
            for spread in [0.01, 0.1] {
                let signal = machine.samples(CYCLES, PER_CYCLE, spread, memory, seed);
                let blind = verdict(&signal, &delay::times(&signal)?)?.regime;
                let driven = with_drive(&signal, blind)?;
                println!(
                    "{:16} {:7} {spread:4} with crank angle: {:14} without: {}",
                    format!("{machine:?}"),
                    format!("{memory:?}"),
                    driven.name(),
                    blind.name()
                );
                all += 1;
                with_angle += u32::from(driven == Regime::Chaotic);
                without += u32::from(blind == Regime::Chaotic);
            }
        }
    }
    println!("called chaotic of {all}: {with_angle} with a crank angle, {without} without");
    Ok(())
}

/// The verdict with a crank angle, as crate features comes to it.
fn with_drive(signal: &[f64], blind: Regime) -> Result<Regime, Error> {
    let driven: Option<Verdict> = driven_verdict(signal, PER_CYCLE, Phase::Recorded)?;
    Ok(match driven {
        Some(verdict) => verdict.regime,
        None if blind == Regime::Chaotic && chance_at_a_phase(signal, PER_CYCLE) => {
            Regime::Undecided
        }
        None => blind,
    })
}
