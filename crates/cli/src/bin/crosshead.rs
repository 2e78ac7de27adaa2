//! `crosshead`: everything beside the main job, which it has as a subcommand too.

use cli::program::{Crosshead, main as program};
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(program::<Crosshead>(std::env::args_os().collect()))
}
