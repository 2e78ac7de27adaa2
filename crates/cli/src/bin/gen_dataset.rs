//! `gen-dataset`: the main job.

use cli::program::{GenDataset, main as program};
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(program::<GenDataset>(std::env::args_os().collect()))
}
