//! How a verb fails, and what the shell sees of it.

use std::path::Path;

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

/// Errors that are always of the input, always of the work, or of which they say themselves.
macro_rules! failures {
    ($($of:ident: $($error:ty),*;)*) => {$($(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                failures!($of error)
            }
        }
    )*)*};
    (input $error:ident) => { Self::input($error) };
    (work $error:ident) => { Self::work($error) };
    (either $error:ident) => {
        match $error.is_input() {
            true => Self::input($error),
            false => Self::work($error),
        }
    };
}

failures! {
    input: input::Error, features::recorded::Error;
    work: recordings::Error, serde_json::Error, rayon::ThreadPoolBuildError;
    either: report::Error;
}

#[cfg(feature = "serve")]
failures! { either: serve::Error; }

impl From<gap::Error> for Failure {
    fn from(error: gap::Error) -> Self {
        match error {
            gap::Error::Input(error) => Self::input(error),
            gap::Error::Stopped => Self::interrupted(error),
            error => Self::work(error),
        }
    }
}

impl From<bench::Error> for Failure {
    fn from(error: bench::Error) -> Self {
        match error {
            bench::Error::Stopped { .. } => Self::interrupted(error),
            error if error.is_input() => Self::input(error),
            error => Self::work(error),
        }
    }
}

impl From<sweep::recorded_table::Error> for Failure {
    fn from(error: sweep::recorded_table::Error) -> Self {
        match error {
            sweep::recorded_table::Error::Stopped => {
                Self::interrupted("interrupted; nothing was written")
            }
            error if error.is_input() => Self::input(error),
            error => Self::work(error),
        }
    }
}

impl From<sweep::Error> for Failure {
    fn from(error: sweep::Error) -> Self {
        match error {
            sweep::Error::Cancelled { .. } | sweep::Error::DiagramsCancelled { .. } => {
                Self::interrupted(error)
            }
            sweep::Error::Input(error) => error.into(),
            error if error.is_input() => Self::input(error),
            error => Self::work(error),
        }
    }
}

impl From<sweep::engines::Error> for Failure {
    fn from(error: sweep::engines::Error) -> Self {
        match error {
            sweep::engines::Error::Missing(_) => Self::Incomplete(error.to_string()),
            error if error.is_input() => Self::input(error),
            error => Self::work(error),
        }
    }
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
