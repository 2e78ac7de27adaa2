//! Measures what an estimation of wear reaches on recordings whose clearances are known.
//!
//! ```text
//! wear own JOINTS FIRST LAST SEED OUT.csv     machines drawn here, and their recordings. Of JOINTS joints, 2 or 4,
//!                                             one or more are worn: big end, small end, guide, main bearing
//! wear bundle BUNDLE MACHINE RUN OUT.csv      a run of a bundle that states the true clearances
//! wear labelled FOLDER MACHINE FIRST LAST OUT.csv
//!                                             a set of labelled recordings of another program: FOLDER has labels.csv and
//!                                             labelled/recordings.parquet, MACHINE is its healthy machine
//! ```
//!
//! Each case is a row of OUT.csv, which is added to. Counts over all its rows are printed.

#![allow(clippy::print_stdout, clippy::print_stderr)]

#[path = "bench/recording.rs"]
mod recording;
mod wear_bench;

use std::error::Error;
use std::path::Path;
use wear_bench::{Table, other, own};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let command = format!("wear {}", words.join(" "));
    match words[..] {
        ["own", joints, first, last, seed, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            for case in first.parse()?..=last.parse()? {
                table.add(&own::case_of(
                    seed.parse()?,
                    case,
                    joints.parse::<usize>()?.clamp(2, 4),
                )?)?;
            }
            table.summary();
        }
        ["bundle", folder, machine, run, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            table.add(&other::run(Path::new(folder), Path::new(machine), run)?)?;
            table.summary();
        }
        ["labelled", folder, machine, first, last, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            let set = other::Set::open(Path::new(folder), Path::new(machine))?;
            for row in first.parse()?..=last.parse()? {
                table.add(&set.case(row)?)?;
            }
            table.summary();
        }
        _ => {
            return Err("usage: wear own JOINTS FIRST LAST SEED OUT.csv | wear bundle BUNDLE MACHINE RUN OUT.csv | \
                 wear labelled FOLDER MACHINE FIRST LAST OUT.csv"
                .into());
        }
    }
    Ok(())
}
