//! Prints how long a revolution of the single-stage machine takes, both joints 0.3 mm clear;
//! `tests/peers/run` compares it with other programs.
//!
//! ```sh
//! cargo run --release -p simulate --example time_revolutions -- \
//!     --tolerance 1e-6 --revolutions 20 --out acceleration.f64
//! ```
//!
//! The line printed is the CPU time of one revolution (ms) without reading the machine. The file
//! holds the crosshead's acceleration at 10 kHz from the centred start, as plain samples without a
//! measuring chain: little-endian f64, m/s². `--width 0`, or none, runs one machine by itself;
//! other widths are those of the ensemble.

use input::{MachineFile, Resolved};
use integrate::Integrator;
use mechanism::Machine;
use simulate::Flow;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Samples per second.
const RATE: f64 = 10_000.0;
/// Radial clearance of both joints.
const CLEARANCE: &str = "0.3 mm";
/// Longest step, as a share of a revolution: that of `simulate`.
const LONGEST_STEP: f64 = 0.05;
/// CPU time for which the run is repeated, s.
const MEASURED: f64 = 0.2;

/// What the command line asks for.
struct Task {
    tolerance: f64,
    revolutions: u32,
    width: usize,
    out: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let task = Task::read(std::env::args().skip(1))?;
    let machine = machine()?.machine;
    let run = match task.width {
        0 => alone,
        width => return Err(format!("width {width} is not built yet").into()),
    };
    let (milliseconds, samples) = measure(|| run(&machine, &task))?;
    if let Some(path) = &task.out {
        let bytes: Vec<u8> = samples.iter().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(path, bytes)?;
    }
    let each = milliseconds / f64::from(task.revolutions);
    writeln!(std::io::stdout(), "{each:.6}")?;
    Ok(())
}

impl Task {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut task = Self {
            tolerance: 1e-6,
            revolutions: 20,
            width: 0,
            out: None,
        };
        while let Some(flag) = words.next() {
            let value = words.next().ok_or(format!("{flag} needs a value"))?;
            match flag.as_str() {
                "--tolerance" => task.tolerance = value.parse()?,
                "--revolutions" => task.revolutions = value.parse()?,
                "--width" => task.width = value.parse()?,
                "--out" => task.out = Some(value.into()),
                _ => return Err(format!("{flag} is not known").into()),
            }
        }
        Ok(task)
    }
}

/// The shipped machine with both ends of the rod clear.
fn machine() -> Result<Resolved, Box<dyn Error>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let mut tree = input::machine_file::read(Path::new(path))?
        .to_tree()
        .clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, CLEARANCE.into())?;
    }
    Ok(MachineFile::from_tree(&tree)?.resolve()?)
}

/// One machine by itself, step by step.
fn alone(machine: &Machine, task: &Task) -> Result<Vec<f64>, Box<dyn Error>> {
    let (mut dynamics, mut state) = machine.start::<f64>();
    let revolution = machine.cycle().length();
    let longest = LONGEST_STEP * revolution;
    let mut integrator = Integrator::new(&mut dynamics, 0.0, &state, task.tolerance, longest);
    let length = f64::from(task.revolutions) * revolution;
    let count = (length * RATE).round() as usize;
    let mut samples = Vec::with_capacity(count);
    integrator.advance(&mut dynamics, length, |dynamics, step| {
        let stop = step.start + step.length;
        while samples.len() < count && samples.len() as f64 / RATE <= stop {
            let time = samples.len() as f64 / RATE;
            step.interpolate((time - step.start) / step.length, &mut state);
            let throw = &dynamics.evaluate(time, &state).throws[0];
            samples.push(throw.accelerations.crosshead);
        }
    })?;
    Ok(samples)
}

/// CPU time of one run of `work`, ms, and what it found. The first run warms the caches up.
fn measure<T>(work: impl Fn() -> Result<T, Box<dyn Error>>) -> Result<(f64, T), Box<dyn Error>> {
    work()?;
    let start = thread_time()?;
    for runs in 1.. {
        let found = work()?;
        let passed = thread_time()? - start;
        if passed > MEASURED {
            return Ok((1e3 * passed / f64::from(runs), found));
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
