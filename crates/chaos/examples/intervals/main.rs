//! Counts how often the interval of the exponent covers the truth.
//!
//! ```sh
//! cargo run --release -p crosshead-chaos --example intervals              # systems to develop on
//! cargo run --release -p crosshead-chaos --example intervals -- held-out  # systems to be judged by
//! cargo run --release -p crosshead-chaos --example intervals -- second    # others, likewise
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]
mod second;
mod systems;

use chaos::test_systems::with_noise;
use chaos::{delay, exponent::exponent};
use std::time::Instant;

/// Samples over which the true exponent is taken.
const TRUTH: usize = 200_000;

fn main() {
    let argument = std::env::args().nth(1).unwrap_or_default();
    let cases = match argument.as_str() {
        "held-out" | "truths" => systems::held_out(),
        "second" => second::second(),
        _ => systems::development(),
    };
    let (mut given, mut covered, mut all, mut seconds) = (0, 0, 0, 0.0);
    for case in &cases {
        let truth = case.truth(TRUTH);
        if argument == "truths" {
            println!("{:30} {truth:.4}", case.name);
            continue;
        }
        for (length, share) in [(2000, 0.0), (2000, 0.01), (10_000, 0.0), (10_000, 0.01)] {
            let signal = with_noise(&case.samples(length, 1), share, 1);
            let start = Instant::now();
            let found = delay::times(&signal).and_then(|times| exponent(&signal, &times));
            seconds += start.elapsed().as_secs_f64();
            all += 1;
            print!(
                "{:30} {length:6} {:2.0} % {truth:.4}",
                case.name,
                100.0 * share
            );
            match found {
                Ok(e) if e.low <= 0.0 => println!(
                    "  none given: {:.3} [{:.3} {:.3}]",
                    e.value / truth,
                    e.low / truth,
                    e.high / truth
                ),
                Ok(e) => {
                    let inside = e.low <= truth && truth <= e.high;
                    given += 1;
                    covered += u32::from(inside);
                    println!(
                        "  {:6.3} [{:6.3} {:6.3}]{} dimension {}, delay {}, noise {:.3}",
                        e.value / truth,
                        e.low / truth,
                        e.high / truth,
                        if inside { "" } else { " missed" },
                        e.dimension,
                        e.delay,
                        e.noise
                    );
                }
                Err(error) => println!("  {error}"),
            }
        }
    }
    println!("{covered} of {given} intervals cover; {all} signals, {seconds:.1} s");
}
