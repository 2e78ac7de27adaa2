//! A machine file's content with the keys of machine files alone, and where each key came from.

use crate::error::{Error, shown};
use crate::tree::{find, moved};
use serde_json::Value;

/// The content, and how its keys are written in the file.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// The content.
    pub tree: Value,
    /// Keys that the file has under another name: (the name, the key).
    moves: Vec<(String, String)>,
    /// Values that the file has in another form: (the key, the value as messages show it).
    own: Vec<(String, String)>,
    /// Keys that the file states with a wrong value.
    wrong: Vec<String>,
}

impl Written {
    pub fn new(tree: Value) -> Self {
        Self {
            tree,
            moves: Vec::new(),
            own: Vec::new(),
            wrong: Vec::new(),
        }
    }

    /// What stood at `from` stands at `to` now.
    pub fn moved(&mut self, from: String, to: String) {
        self.moves.push((from, to));
    }

    /// What stands at `key` has another form in the file: `own`.
    pub fn changed(&mut self, key: &str, own: &Value) {
        self.changed_from(key, shown(own));
    }

    /// What stands at `key` has another form in the file, which messages show as `own`.
    pub fn changed_from(&mut self, key: &str, own: String) {
        self.own.push((key.to_owned(), own));
    }

    /// The value that messages show for the one at `key`, where the file has it in another form, and what they show of the
    /// one that is there.
    pub fn own_value(&self, key: &str) -> Option<(String, String)> {
        let (_, own) = self.own.iter().find(|(changed, _)| changed == key)?;
        Some((shown(find(&self.tree, key)?), own.clone()))
    }

    /// The file states `key` with a wrong value, which is gone from the tree.
    pub fn wrong(&mut self, key: String) {
        self.wrong.push(key);
    }

    /// Whether the file states `key` with a wrong value.
    pub fn is_wrong(&self, key: &str) -> bool {
        self.wrong.iter().any(|wrong| wrong == key)
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
