//! A case in a process of its own, so that its parent sees how it ends: the program itself, called as
//! `PROGRAM try-case DATASET CASE`. People do not call it, so that no help names it.

use std::env;
use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{self, Command, ExitCode};
use std::thread;
use sweep::dataset::try_here;
use sweep::simulate_cases;

const VERB: &str = "try-case";

/// The command that tries case `case` of the dataset at `root`.
pub(crate) fn command(root: &Path, case: u64) -> Option<Command> {
    let mut command = Command::new(env::current_exe().ok()?);
    command.arg(VERB).arg(root).arg(case.to_string());
    Some(command)
}

#[allow(clippy::exit)] // The simulation cannot be stopped otherwise.
fn end_with_parent() -> ! {
    let _ = io::copy(&mut io::stdin(), &mut io::sink());
    process::exit(0)
}

/// Tries a case if this process was called to; a program does this before anything else.
pub fn if_asked() -> Option<ExitCode> {
    let arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let [verb, root, case] = arguments.as_slice() else {
        return None;
    };
    if verb != VERB {
        return None;
    }
    let case = case.to_str()?.parse().ok()?;
    // Whoever asked holds the other end: when that closes, nobody waits for the outcome.
    thread::spawn(|| end_with_parent());
    let tried = try_here(Path::new(root), case, &simulate_cases);
    Some(crate::finish(tried.map_err(crate::Failure::from)))
}
