//! A machine file's content with the keys of machine files alone, and where each key came from.

use crate::error::Error;
use crate::tree::moved;
use serde_json::Value;

/// The content, and how its keys are written in the file.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// The content.
    pub tree: Value,
    /// Keys that the file has under another name: (the name, the key).
    moves: Vec<(String, String)>,
}

impl Written {
    pub fn new(tree: Value) -> Self {
        let moves = Vec::new();
        Self { tree, moves }
    }

    /// What stood at `from` stands at `to` now.
    pub fn moved(&mut self, from: String, to: String) {
        self.moves.push((from, to));
    }

    /// The name that the file has for `key`.
    pub fn original(&self, key: &str) -> String {
        let moves = self.moves.iter().rev();
        moves.fold(key.to_owned(), |key, (from, to)| {
            moved(&key, to, from).unwrap_or(key)
        })
    }
}

/// Mistakes that are found on the way.
#[derive(Debug, Default)]
pub(super) struct Mistakes(Vec<Error>);

impl Mistakes {
    /// Notes a mistake at a key of `written`.
    pub fn note(&mut self, written: &Written, error: Error) {
        self.0.push(error.renamed(&|key| written.original(key)));
    }

    /// The mistakes, if there are any.
    pub fn into_error(self) -> Result<(), Error> {
        Error::all(self.0).map_or(Ok(()), Err)
    }
}
