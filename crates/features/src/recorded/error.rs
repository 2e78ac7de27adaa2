//! Why recordings have no table of features.

use recordings::Kind;
use std::path::Path;

/// Why recordings have no table of features. The files or what is said of them are wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A mistake in a bundle.
    #[error(transparent)]
    Bundle(#[from] input::Error),
    /// A file that cannot be read.
    #[error(transparent)]
    File(recordings::Error),
    /// A file that cannot be used.
    #[error("{file}: {reason}")]
    Wrong {
        /// The file.
        file: String,
        /// Why not.
        reason: String,
    },
    /// A column that is not the same in two files.
    #[error(
        "column `{name}` is {kind} here and {other} in another file: give them in separate calls"
    )]
    Kinds {
        /// The column.
        name: String,
        /// What it holds in this file.
        kind: Kind,
        /// What it holds in another.
        other: Kind,
    },
}

impl Error {
    /// That the file at `path` cannot be used.
    pub(super) fn in_file(path: &Path, reason: impl ToString) -> Self {
        Self::Wrong {
            file: path.display().to_string(),
            reason: reason.to_string(),
        }
    }

    /// That the file at `path` cannot be read.
    pub(super) fn of_file(path: &Path, error: recordings::Error) -> Self {
        match error {
            recordings::Error::NoColumn { name, among } => {
                // Without its unit in brackets a name is one, too.
                let bare =
                    |column: &String| column.split(['[', '(']).next().map(|n| n.trim().to_owned());
                let names: Vec<String> = among.iter().filter_map(bare).collect();
                let nearest = input::nearest(&name, names.iter().map(String::as_str));
                let hint = nearest.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                let among = among.join(", ");
                Self::in_file(
                    path,
                    format!("no column `{name}`; there are: {among}{hint}"),
                )
            }
            error @ (recordings::Error::SampleRate(_) | recordings::Error::ValueKind { .. }) => {
                Self::in_file(path, error)
            }
            error => Self::File(error),
        }
    }
}
