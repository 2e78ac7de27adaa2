//! The program whose processes do parts of the work: single cases, and the jobs of a cluster.

use std::io;
use std::path::PathBuf;
use std::sync::OnceLock;

static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Names the program where it is not the one of this process, an interpreter for example. The first name stays.
pub fn set(path: PathBuf) {
    let _ = PROGRAM.set(path);
}

/// Whether a program has been named.
pub fn is_named() -> bool {
    PROGRAM.get().is_some()
}

/// Where the program is.
///
/// # Errors
/// A system that does not say which program this process is.
pub fn path() -> io::Result<PathBuf> {
    match PROGRAM.get() {
        Some(path) => Ok(path.clone()),
        None => std::env::current_exe(),
    }
}
