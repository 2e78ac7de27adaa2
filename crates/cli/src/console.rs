//! What every verb understands: how much is said, in which colours, on how many threads.

use crate::Failure;
use clap::{Args, ColorChoice};
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
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t = ColorChoice::Auto, help_heading = HEADING)]
    color: ColorChoice,
    /// Threads that compute [default: one per core]
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..), help_heading = HEADING)]
    threads: Option<u16>,
}

/// That of this program.
static CONSOLE: OnceLock<Console> = OnceLock::new();

impl Console {
    /// Sets them for the whole program; a program does this once, before its verb.
    ///
    /// # Errors
    /// A system that gives no threads.
    pub(crate) fn set(&self) -> Result<(), Failure> {
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
            pool.build_global()?;
        }
        // A second call in one process changes nothing.
        let _ = CONSOLE.set(self.clone());
        Ok(())
    }

    fn is_coloured(&self) -> bool {
        let says = |name| std::env::var_os(name).filter(|value| !value.is_empty());
        let is_dumb = || says("TERM").is_some_and(|term| term == "dumb");
        match self.color {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => {
                io::stderr().is_terminal() && says("NO_COLOR").is_none() && !is_dumb()
            }
        }
    }
}

/// Whether progress and hints are left out.
pub(crate) fn is_quiet() -> bool {
    CONSOLE.get().is_some_and(|console| console.quiet)
}

/// Whether messages on standard error are coloured.
pub(crate) fn is_coloured() -> bool {
    CONSOLE.get().is_some_and(Console::is_coloured)
}

/// Threads asked for, or one per core.
pub(crate) fn threads() -> usize {
    let asked = CONSOLE.get().and_then(|console| console.threads);
    let all = || std::thread::available_parallelism().map_or(1, Into::into);
    asked.map_or_else(all, usize::from)
}

/// The threads asked for.
///
/// # Errors
/// A system that gives none.
pub(crate) fn pool() -> Result<rayon::ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads());
    Ok(pool.build()?)
}

/// When clap colours its own messages, which it may have before any argument is parsed.
pub(crate) fn colour_of_clap(arguments: impl IntoIterator<Item = OsString>) -> ColorChoice {
    let (mut choice, mut is_next) = (ColorChoice::Auto, false);
    for argument in arguments {
        let text = argument.to_string_lossy();
        let next = is_next.then_some(text.as_ref());
        let value = text.strip_prefix("--color=").or(next);
        choice = value.and_then(|text| text.parse().ok()).unwrap_or(choice);
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
