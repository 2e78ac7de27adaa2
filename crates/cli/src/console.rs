//! What every verb understands: how much is said, in which colours, on how many threads.

use crate::Failure;
use clap::{Args, ColorChoice, ValueEnum};
use std::ffi::OsString;
use std::io::{self, IsTerminal};
use std::sync::OnceLock;

const HEADING: &str = "Options of every verb";

/// The options of every verb.
#[derive(Args, Clone, Debug)]
pub struct Console {
    /// No progress and no hints; results, warnings and errors stay
    #[arg(long, global = true, help_heading = HEADING)]
    quiet: bool,
    /// When messages are coloured; auto is on a terminal, unless NO_COLOR is set
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t = When::Auto, help_heading = HEADING)]
    color: When,
    /// Threads that compute [default: one per core]
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..), help_heading = HEADING)]
    threads: Option<u16>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum When {
    Auto,
    Always,
    Never,
}

/// What the options come to.
struct Settings {
    quiet: bool,
    coloured: bool,
    threads: Option<usize>,
}

static SETTINGS: OnceLock<Settings> = OnceLock::new();

impl Console {
    /// Sets them for the whole program; a program does this once, before its verb.
    ///
    /// # Errors
    /// A system that gives no threads.
    pub fn set(&self) -> Result<(), Failure> {
        let coloured = match self.color {
            When::Always => true,
            When::Never => false,
            When::Auto => {
                let says = |name| std::env::var_os(name).filter(|value| !value.is_empty());
                let dumb = says("TERM").is_some_and(|term| term == "dumb");
                io::stderr().is_terminal() && says("NO_COLOR").is_none() && !dumb
            }
        };
        let threads = self.threads.map(usize::from);
        if let Some(threads) = threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build_global().map_err(Failure::work)?;
        }
        // A second call in one process changes nothing.
        let _ = SETTINGS.set(Settings {
            quiet: self.quiet,
            coloured,
            threads,
        });
        Ok(())
    }
}

/// Whether progress and hints are left out.
pub(crate) fn is_quiet() -> bool {
    SETTINGS.get().is_some_and(|settings| settings.quiet)
}

/// Whether messages on standard error are coloured.
pub(crate) fn is_coloured() -> bool {
    SETTINGS.get().is_some_and(|settings| settings.coloured)
}

/// Threads asked for, or one per core.
pub(crate) fn threads() -> usize {
    let asked = SETTINGS.get().and_then(|settings| settings.threads);
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, Into::into))
}

/// The threads asked for.
///
/// # Errors
/// A system that gives none.
pub(crate) fn pool() -> Result<rayon::ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads());
    pool.build().map_err(Failure::work)
}

/// When clap colours its own messages, which it may have before any argument is parsed.
pub(crate) fn colour_of_clap(arguments: impl IntoIterator<Item = OsString>) -> ColorChoice {
    let mut choice = ColorChoice::Auto;
    let mut is_next = false;
    for argument in arguments {
        let text = argument.to_string_lossy();
        let value = match text.strip_prefix("--color=") {
            Some(value) => Some(value),
            None => is_next.then_some(text.as_ref()),
        };
        choice = match value {
            Some("always") => ColorChoice::Always,
            Some("never") => ColorChoice::Never,
            _ => choice,
        };
        is_next = text == "--color";
    }
    choice
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colour_is_known_before_the_arguments_are_parsed() {
        let of = |line: &str| colour_of_clap(line.split(' ').map(OsString::from));
        assert_eq!(of("crosshead simulate x.yaml"), ColorChoice::Auto);
        assert_eq!(of("crosshead --color never x"), ColorChoice::Never);
        assert_eq!(of("crosshead x --color=always"), ColorChoice::Always);
        assert_eq!(of("crosshead x --color sometimes"), ColorChoice::Auto);
        assert_eq!(of("crosshead x always"), ColorChoice::Auto);
    }
}
