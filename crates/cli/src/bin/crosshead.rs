//! `crosshead`: everything beside the main job, which it has as a subcommand too.

use cli::program::{Crosshead, Program, parse};
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(tried) = cli::try_case::if_asked() {
        return tried;
    }
    cli::finish(parse::<Crosshead>().run())
}
