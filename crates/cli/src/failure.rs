//! How a verb fails, and what the shell sees of it.

use std::path::Path;
use sweep::{engines, recorded_table};

/// Why a verb stopped; the text is the one message that is printed.
#[derive(Debug)]
pub enum Failure {
    /// The input or the arguments are wrong; nothing was written. Exit status 2.
    Input(String),
    /// The work failed. Exit status 1.
    Work(String),
    /// A dataset is not complete yet. Exit status 3.
    Incomplete(String),
    /// The user has stopped the work. Exit status 130, as shells report one that Ctrl-C has ended.
    Interrupted(String),
}

impl Failure {
    /// Wrong input.
    pub fn input(message: impl ToString) -> Self {
        Self::Input(message.to_string())
    }

    /// Failed work.
    pub fn work(message: impl ToString) -> Self {
        Self::Work(message.to_string())
    }

    /// Work that the user has stopped.
    pub fn interrupted(message: impl ToString) -> Self {
        Self::Interrupted(message.to_string())
    }

    /// What it says.
    pub fn message(&self) -> &str {
        match self {
            Self::Input(message)
            | Self::Work(message)
            | Self::Incomplete(message)
            | Self::Interrupted(message) => message,
        }
    }

    /// The exit status.
    pub fn status(&self) -> u8 {
        match self {
            Self::Work(_) => 1,
            Self::Input(_) => 2,
            Self::Incomplete(_) => 3,
            Self::Interrupted(_) => 130,
        }
    }

    /// A file of the output that could not be written.
    pub fn unwritten(path: &Path, error: impl ToString) -> Self {
        Self::Work(format!("{}: {}", path.display(), error.to_string()))
    }
}

/// Which failure each error is.
macro_rules! failures {
    ($($error:ty { $($which:pat $(if $guard:expr)? => $failure:ident),* })*) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                let message = error.to_string();
                match error {
                    $($which $(if $guard)? => Self::$failure(message)),*
                }
            }
        }
    )*};
}

failures! {
    input::Error { _ => Input }
    features::recorded::Error { _ => Input }
    recordings::Error { _ => Work }
    serde_json::Error { _ => Work }
    rayon::ThreadPoolBuildError { _ => Work }
    report::Error { e if e.is_input() => Input, _ => Work }
    gap::Error { gap::Error::Stopped => Interrupted, gap::Error::Input(_) => Input, _ => Work }
    bench::Error { bench::Error::Stopped { .. } => Interrupted, e if e.is_input() => Input, _ => Work }
    recorded_table::Error {
        recorded_table::Error::Stopped => Interrupted,
        e if e.is_input() => Input,
        _ => Work
    }
    sweep::Error {
        sweep::Error::Cancelled { .. } | sweep::Error::DiagramsCancelled { .. } => Interrupted,
        e if e.is_input() => Input,
        _ => Work
    }
    engines::Error { engines::Error::Missing(_) => Incomplete, e if e.is_input() => Input, _ => Work }
}

#[cfg(feature = "serve")]
failures! {
    serve::Error { e if e.is_input() => Input, _ => Work }
}

/// Prints the message of a failure and returns the exit status.
pub fn finish(outcome: Result<(), Failure>) -> u8 {
    let failure = match outcome {
        Ok(()) => return 0,
        Err(failure) => failure,
    };
    // Several mistakes are a line each; what is indented belongs to the line above.
    for line in failure.message().lines() {
        let start = if line.starts_with(' ') { "" } else { "error: " };
        eprintln!("{start}{}", without_code(line));
    }
    failure.status()
}

/// A line without the number that the operating system gives an error, which its words have said already.
fn without_code(line: &str) -> String {
    let (before, after) = line.split_once(" (os error ").unwrap_or((line, ""));
    match after.split_once(')') {
        Some((code, rest)) if code.parse::<u32>().is_ok() => format!("{before}{rest}"),
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_operating_system_is_said_in_words_alone() {
        let error = std::io::Error::from_raw_os_error(2);
        let line = without_code(&format!("none: {error}"));
        assert_eq!(line, "none: No such file or directory");
        let kept = "sweep.yaml (os error here)";
        assert_eq!(without_code(kept), kept);
    }
}
