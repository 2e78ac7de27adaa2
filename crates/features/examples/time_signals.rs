//! Prints how long the signal processing takes on a signal in a file; `tests/peers/` compares it
//! with that of Python packages.
//!
//! ```sh
//! cargo run --release -p crosshead-features --example time_signals -- SIGNAL.txt
//! ```
//!
//! The file holds one sample per line, the first line its rate (Hz). Each line printed is a
//! measure, the CPU time of one run (s), and the numbers found.

use features::{Window, features};
use signal::amplitude_spectrum::amplitude_spectrum;
use signal::channel::Channel;
use signal::envelope::{Band, envelope_spectrum};
use signal::kurtogram::kurtogram;
use signal::welch::welch;
use signal::windows;
use std::hint::black_box;
use std::io::Write;

/// CPU time for which a measure is repeated, s: the kernel counts in steps of up to 10 ms.
const MEASURED: f64 = 1.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args()
        .nth(1)
        .ok_or("the path of a signal is missing")?;
    let numbers: Vec<f64> = std::fs::read_to_string(path)?
        .lines()
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    let (rate, x) = numbers.split_first().ok_or("the file is empty")?;
    let band = Band {
        centre: 0.15 * rate,
        width: 0.1 * rate,
    };
    // A channel without a known unit has the statistics alone.
    let channels = [Channel {
        name: "x".to_owned(),
        unit: "V".to_owned(),
        samples: x.iter().map(|x| *x as f32).collect(),
    }];
    let window = Window {
        sample_rate: *rate,
        speed_rpm: Some(600.0),
        crank_angle: None,
        channels: &channels,
        chambers: &[],
    };
    let mut out = std::io::stdout();
    let mut line =
        |name: &str, seconds: f64, found: &[f64]| writeln!(out, "{name} {seconds:e} {found:?}");

    let statistics = || features(&window);
    let spectrum = || amplitude_spectrum(x, *rate, windows::Window::Hann);
    let density = || welch(x, *rate, windows::Window::Hann, 1024);
    let envelope = || envelope_spectrum(x, *rate, band);
    let values: Vec<f64> = statistics().into_iter().collect::<Result<_, _>>()?;
    line("statistics", cpu_time(statistics)?, &values)?;
    line("fft", cpu_time(spectrum)?, &spectrum()?.amplitude[..8])?;
    line("welch", cpu_time(density)?, &density()?.density[..8])?;
    line("envelope", cpu_time(envelope)?, &envelope()?.amplitude[..8])?;
    let classic = || (statistics(), spectrum(), density(), envelope());
    line("classic", cpu_time(classic)?, &[])?;

    let bands = || kurtogram(x, *rate, rate / 256.0);
    let (band, kurtosis) = bands()?.most_impulsive()?;
    let found = [
        kurtosis,
        band.centre,
        band.width,
        bands()?.cells.len() as f64,
    ];
    line("kurtogram", cpu_time(bands)?, &found)?;
    Ok(())
}

/// CPU time of one run of `work`, s.
fn cpu_time<T>(work: impl Fn() -> T) -> Result<f64, Box<dyn std::error::Error>> {
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
fn thread_time() -> Result<f64, Box<dyn std::error::Error>> {
    let counts = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds = counts.split(' ').next().ok_or("an empty schedstat")?;
    Ok(nanoseconds.parse::<f64>()? * 1e-9)
}
