#![allow(missing_docs, clippy::print_stdout)]
use chaos::test_systems::{System, with_noise};
use chaos::{delay, exponent::exponent};
use std::time::Instant;
fn arg<T: std::str::FromStr>(i: usize, d: T) -> T { std::env::args().nth(i).and_then(|a| a.parse().ok()).unwrap_or(d) }
fn main() {
    let length: usize = arg(1, 10_000);
    let which: String = arg(2, String::new());
    let seeds: u64 = arg(3, 3);
    let noises: String = arg(4, "0,0.01,0.05".into());
    let first: u64 = arg(5, 1);
    let verbose = std::env::var("V").is_ok();
    for system in System::ALL {
        if !which.split(',').any(|w| system.name().to_lowercase().contains(w)) { continue; }
        let truth = system.exponent() * system.sample_interval();
        for share in noises.split(',').map(|s| s.parse::<f64>().unwrap()) {
            let mut errors = vec![]; let mut covered = 0; let mut time = 0.0;
            for seed in first..first + seeds {
                let y = with_noise(&system.samples(length, seed), share, seed);
                let start = Instant::now();
                let times = delay::times(&y).unwrap();
                let Ok(e) = exponent(&y, &times) else { println!("  refused"); continue };
                time += start.elapsed().as_secs_f64();
                errors.push(((e.value / truth - 1.0).abs(), e.value / truth));
                covered += u32::from(e.low <= truth && truth <= e.high);
                if verbose { println!("   {seed}: {:.3} [{:.3} {:.3}] m {} d {} noise {:.4} time {:.3} map {:.3} second {:.3}", e.value/truth, e.low/truth, e.high/truth, e.dimension, e.delay, e.noise, e.over_time/truth, e.of_map/truth, e.second/truth); }
            }
            errors.sort_by(|a, b| a.0.total_cmp(&b.0));
            if errors.is_empty() { continue; }
            println!("{:13} {share:5} median {:.1} % covered {covered}/{seeds} values {} time {:.2}", system.name(), errors[errors.len()/2].0 * 100.0, errors.iter().map(|e| format!("{:.3}", e.1)).collect::<Vec<_>>().join(" "), time / seeds as f64);
        }
    }
}
