//! Prints the exponent found from the signal of each test system beside the true one:
//! `table [LENGTH] [SEEDS] [SYSTEM,...] [NOISE,...] [FIRST SEED]`; each run too with `VERBOSE=1`.
#![allow(clippy::print_stdout, reason = "an example prints")]
use chaos::test_systems::{System, with_noise};
use chaos::{Error, delay, exponent::exponent};
use std::time::Instant;

fn main() -> Result<(), Error> {
    let argument = |i, other: &str| std::env::args().nth(i).unwrap_or(other.to_string());
    let length = argument(1, "10000").parse().unwrap_or(10_000);
    let seeds = argument(2, "5").parse().unwrap_or(5);
    let names = argument(3, "").to_lowercase();
    let shares: Vec<f64> = argument(4, "0,0.01,0.05")
        .split(',')
        .filter_map(|share| share.parse().ok())
        .collect();
    let first = argument(5, "1").parse().unwrap_or(1);
    let verbose = std::env::var("VERBOSE").is_ok();
    println!(
        "system         noise  median |error|  values / truth, closest first, covered, s each"
    );
    let (mut runs, mut all_covered, mut all_refused) = (0, 0, 0);
    for system in System::ALL {
        let name = system.name().to_lowercase();
        if !names.split(',').any(|wanted| name.contains(wanted)) {
            continue;
        }
        let truth = system.exponent() * system.sample_interval();
        for share in &shares {
            let (mut values, mut covered, mut refused, mut seconds) = (Vec::new(), 0, 0, 0.0);
            for seed in first..first + seeds {
                let signal = with_noise(&system.samples(length, seed), *share, seed);
                let start = Instant::now();
                let found = exponent(&signal, &delay::times(&signal)?);
                seconds += start.elapsed().as_secs_f64();
                let Ok(e) = found else {
                    refused += 1;
                    continue;
                };
                values.push(e.value / truth);
                covered += u32::from(e.low <= truth && truth <= e.high);
                if verbose {
                    println!(
                        "  seed {seed}: {:.3} [{:.3} {:.3}] dimension {} delay {} noise {:.4} over time {:.3} of map {:.3} second {:.3}",
                        e.value / truth,
                        e.low / truth,
                        e.high / truth,
                        e.dimension,
                        e.delay,
                        e.noise,
                        e.over_time / truth,
                        e.of_map / truth,
                        e.second / truth
                    );
                }
            }
            values.sort_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
            let median = values
                .get(values.len() / 2)
                .map_or(f64::NAN, |v| (v - 1.0).abs());
            let list: Vec<String> = values.iter().map(|v| format!("{v:.3}")).collect();
            println!(
                "{:13} {:4.0} % {:12.1} %  {}  {covered}/{} refused {refused}  {:.2}",
                system.name(),
                share * 100.0,
                median * 100.0,
                list.join(" "),
                values.len(),
                seconds / seeds as f64
            );
            runs += values.len();
            all_covered += covered;
            all_refused += refused;
        }
    }
    println!("intervals cover in {all_covered} of {runs} runs, refused {all_refused}");
    Ok(())
}
