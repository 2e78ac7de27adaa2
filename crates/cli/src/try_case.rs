//! A case in a process of its own, so that its parent sees how it ends: the program itself, called as
//! `PROGRAM try-case DATASET CASE`. People do not call it, so that no help names it.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{self, Command};
use std::thread;
use sweep::dataset::try_here;
use sweep::{program, simulate_cases};

const VERB: &str = "try-case";

/// The command that tries case `case` of the dataset at `root`.
pub fn command(root: &Path, case: u64) -> Option<Command> {
    let mut command = Command::new(program::path().ok()?);
    command.arg(VERB).arg(root).arg(case.to_string());
    Some(command)
}

#[allow(clippy::exit)] // The simulation cannot be stopped otherwise.
fn end_with_parent() -> ! {
    let _ = io::copy(&mut io::stdin(), &mut io::sink());
    process::exit(0)
}

/// Tries a case if `arguments` ask for it, and gives the exit status; a program does this before anything else.
pub(crate) fn if_asked(arguments: &[OsString]) -> Option<u8> {
    let [_, verb, root, case] = arguments else {
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
