//! The signals that ask a program to end: Ctrl-C (`SIGINT`), `SIGTERM`, as `kill`, a container or a
//! cluster's scheduler sends it, and `SIGHUP`, as a closed terminal does.

use crate::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that each of these signals sets. The work looks at it between two steps, and keeps what it
/// has; a second signal while the first is being obeyed changes nothing.
///
/// # Errors
/// A system that lets no handler be set.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let asked = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&asked);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(Failure::work)?;
    Ok(asked)
}
