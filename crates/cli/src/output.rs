//! What the programs print.
//!
//! The standard library's `println!` panics where standard output cannot be written: a full disk, a
//! closed descriptor. Here it ends the program with one message and exit status 1; `eprintln!` goes on, as
//! a message that nobody can read is no reason to lose the work.

use std::fmt::Arguments;
use std::io::Write;

/// Writes to standard output, and ends the program where that fails.
#[allow(clippy::exit)] // A summary that cannot be written: what follows it could not be either.
pub(crate) fn print(text: Arguments) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_fmt(text).and_then(|()| out.flush()) {
        message(format_args!("error: standard output: {error}\n"));
        std::process::exit(1);
    }
}

/// Writes to standard error, if that can be written.
pub(crate) fn message(text: Arguments) {
    let _ = std::io::stderr().lock().write_fmt(text);
}

macro_rules! println {
    () => { $crate::output::print(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::print(format_args!("{}\n", format_args!($($text)*))) };
}

macro_rules! print {
    ($($text:tt)*) => { $crate::output::print(format_args!($($text)*)) };
}

macro_rules! eprintln {
    () => { $crate::output::message(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::message(format_args!("{}\n", format_args!($($text)*))) };
}
