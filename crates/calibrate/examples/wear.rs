//! Measures what an estimation of wear reaches on recordings whose clearances are known.
//!
//! ```text
//! wear own SEED FIRST LAST OUT.csv            machines of one throw and two that are drawn here, and their recordings. None to
//!                                             four joints are worn
//! wear drawn SEED FIRST LAST                  what these machines are, a line each; nothing is estimated
//! wear bundle BUNDLE MACHINE RUN OUT.csv      a run of a bundle that states the true clearances
//! wear labelled FOLDER MACHINE FIRST LAST OUT.csv
//!                                             a set of labelled recordings of another program: FOLDER has labels.csv and
//!                                             labelled/recordings.parquet, MACHINE is its healthy machine
//! wear summary OUT.csv                        counts over the rows that are there
//! ```
//!
//! Each joint of a case is a row of OUT.csv, which is added to. Cases that have rows there are passed over, so that a call that was
//! stopped goes on. Counts over all rows are printed.

#![allow(clippy::print_stdout, clippy::print_stderr)]

#[path = "bench/recording.rs"]
mod recording;
mod wear_bench;

use std::error::Error;
use std::path::Path;
use wear_bench::{Table, other, own};

const USAGE: &str = "usage: wear own SEED FIRST LAST OUT.csv | wear drawn SEED FIRST LAST | wear bundle BUNDLE MACHINE RUN OUT.csv | \
                     wear labelled FOLDER MACHINE FIRST LAST OUT.csv | wear summary OUT.csv";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let command = format!("wear {}", words.join(" "));
    match words[..] {
        ["own", seed, first, last, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            let seed = seed.parse()?;
            for number in first.parse()?..=last.parse()? {
                if !table.has(&own::name(seed, number)) {
                    table.add(&own::case_of(seed, number)?)?;
                }
            }
            table.summary();
        }
        ["drawn", seed, first, last] => {
            for number in first.parse()?..=last.parse()? {
                println!("{}", own::described(seed.parse()?, number)?);
            }
        }
        ["bundle", folder, machine, run, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            let folder = Path::new(folder);
            if !table.has(&other::name(folder, run)) {
                table.add(&other::run(folder, Path::new(machine), run)?)?;
            }
            table.summary();
        }
        ["labelled", folder, machine, first, last, out] => {
            let mut table = Table::open(Path::new(out), command)?;
            let set = other::Set::open(Path::new(folder), Path::new(machine))?;
            for row in first.parse()?..=last.parse()? {
                if !table.has(&other::Set::name(row)) {
                    table.add(&set.case(row)?)?;
                }
            }
            table.summary();
        }
        ["summary", out] => Table::open(Path::new(out), command)?.summary(),
        _ => return Err(USAGE.into()),
    }
    Ok(())
}
