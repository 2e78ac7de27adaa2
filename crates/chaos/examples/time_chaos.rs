//! This crate's side of the comparisons of `tests/peers/`.
//!
//! ```sh
//! time_chaos samples SYSTEM LENGTH SEED NOISE         # one sample per line
//! time_chaos times FILE                               # delay, Theiler window
//! time_chaos curve FILE DIMENSION DELAY THEILER STEPS # divergence curve, memory used (MB)
//! time_chaos exponent FILE                            # exponent per sample, its interval
//! time_chaos measures FILE DIMENSION STEPS            # all measures with their times
//! ```
//!
//! All but the first print lines of a name, the CPU time of one run (s; 0 where it is not
//! measured) and the numbers found.

use chaos::delay::{Times, times};
use chaos::divergence::rosenstein;
use chaos::entropy::sample_entropy;
use chaos::error::checked;
use chaos::exponent::exponent;
use chaos::neighbours::Delays;
use chaos::recurrence::recurrence;
use chaos::test_systems::{System, with_noise};
use std::error::Error;
use std::hint::black_box;
use std::io::Write;

/// CPU time for which a measure is repeated, s: the kernel counts in steps of up to 10 ms.
const MEASURED: f64 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["samples", system, length, seed, noise] => {
            let mut all = System::ALL.into_iter();
            let system = all.find(|s| s.name() == system).ok_or("no such system")?;
            let clean = system.samples(length.parse()?, seed.parse()?);
            let noisy = with_noise(&clean, noise.parse()?, seed.parse()?);
            let lines: String = noisy.iter().map(|x| format!("{x:e}\n")).collect();
            std::io::stdout().write_all(lines.as_bytes())?;
            Ok(())
        }
        ["times", path] => print_times(&times(&read(path)?)?),
        ["curve", path, dimension, delay, theiler, steps] => {
            let delays = Delays {
                signal: &read(path)?,
                dimension: dimension.parse()?,
                delay: delay.parse()?,
            };
            let curve = rosenstein(&delays, theiler.parse()?, steps.parse()?)?;
            print("curve", 0.0, &curve)?;
            print("memory", 0.0, &[most_memory()?])
        }
        ["exponent", path] => {
            let signal = read(path)?;
            let found = exponent(&signal, &times(&signal)?)?;
            print("exponent", 0.0, &[found.value, found.low, found.high])
        }
        ["measures", path, dimension, steps] => {
            measures(&read(path)?, dimension.parse()?, steps.parse()?)
        }
        _ => Err("see the head of this example for its arguments".into()),
    }
}

fn measures(signal: &[f64], dimension: usize, steps: usize) -> Result<(), Box<dyn Error>> {
    let times = times(signal)?;
    let delays = Delays {
        signal,
        dimension,
        delay: times.delay,
    };
    let spread = 0.2 * checked(signal)?.1;
    print_times(&times)?;

    let curve = || rosenstein(&delays, times.theiler, steps);
    print("divergence", cpu_time(curve)?, &curve()?)?;
    let entropy = || sample_entropy(signal, 2, spread);
    let found = entropy()?.ok_or("no two stretches agree")?;
    print("sample_entropy", cpu_time(entropy)?, &[found])?;
    let plot = || recurrence(&delays, times.theiler, spread);
    let found = plot()?;
    let found = [found.rate, found.determinism, found.mean_diagonal];
    print("recurrence", cpu_time(plot)?, &found)?;
    let automatic = || exponent(signal, &chaos::delay::times(signal)?);
    let found = automatic()?;
    let found = [found.value, found.low, found.high];
    print("exponent", cpu_time(automatic)?, &found)
}

/// The samples of a file, one per line.
fn read(path: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    let samples = std::fs::read_to_string(path)?;
    Ok(samples.lines().map(str::parse).collect::<Result<_, _>>()?)
}

fn print_times(times: &Times) -> Result<(), Box<dyn Error>> {
    print("times", 0.0, &[times.delay as f64, times.theiler as f64])
}

fn print(name: &str, seconds: f64, found: &[f64]) -> Result<(), Box<dyn Error>> {
    Ok(writeln!(std::io::stdout(), "{name} {seconds:e} {found:?}")?)
}

/// CPU time of one run of `work`, s.
fn cpu_time<T>(work: impl Fn() -> T) -> Result<f64, Box<dyn Error>> {
    let start = thread_time()?;
    for runs in 1.. {
        black_box(work());
        let passed = thread_time()? - start;
        if passed > MEASURED {
            return Ok(passed / f64::from(runs));
        }
    }
    unreachable!("time passes")
}

/// CPU time of this thread so far, s, as Linux counts it.
fn thread_time() -> Result<f64, Box<dyn Error>> {
    let counts = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds = counts.split(' ').next().ok_or("an empty schedstat")?;
    Ok(nanoseconds.parse::<f64>()? * 1e-9)
}

/// The most memory that this process had, MB, as Linux counts it.
fn most_memory() -> Result<f64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|l| l.trim().strip_suffix(" kB"));
    Ok(kilobytes.ok_or("no VmHWM")?.parse::<f64>()? / 1024.0)
}
