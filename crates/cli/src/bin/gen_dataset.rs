//! `gen-dataset`: the main job.

use cli::program::{GenDataset, Program, parse};
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(tried) = cli::try_case::if_asked() {
        return tried;
    }
    cli::finish(parse::<GenDataset>().run())
}
