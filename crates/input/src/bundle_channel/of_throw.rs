//! Channels of throws, told by their words where the throws of the machine are not known.

use super::channel::Channel;
use super::known::{Kind, known_of_throw, parts, words};
use super::si::{ToSi, to_si};
use crate::error::{Error, quoted};
use mechanism::declaration::Quantity;

/// A channel of a throw with the words for the throw before it: `T1 cylinder pressure`. A channel of one word is left
/// out: `oil pressure` is another one.
pub(super) struct OfThrow<'a> {
    /// The key of the channel that says so, and its text.
    key: &'static str,
    text: &'a str,
    /// The words for the throw, as they are written; empty where there are none.
    throw: String,
    /// The channel in words.
    name: String,
    /// Its column in a machine of one throw.
    column: String,
    quantity: Quantity,
}

impl<'a> OfThrow<'a> {
    /// What the name of `channel`, or else its column, says; none where it is no channel of a throw.
    pub(super) fn of(channel: &'a Channel) -> Option<Self> {
        let texts = [("name", &channel.name), ("column", &channel.column)];
        texts
            .into_iter()
            .find_map(|(key, text)| Self::said(key, text))
    }

    fn said(key: &'static str, text: &'a str) -> Option<Self> {
        let spoken = words(text);
        let ends = |name: &String| {
            let before = spoken.strip_suffix(name.as_str());
            name.contains(' ') && before.is_some_and(|b| b.is_empty() || b.ends_with(' '))
        };
        let fitting = known_of_throw("").flat_map(|(column, names, kind)| {
            let names = names.into_iter().filter(ends);
            names.map(move |name| (column.clone(), name, kind))
        });
        let (column, name, kind) = fitting.max_by_key(|(_, name, _)| name.len())?;
        let Kind::Measured(quantity) = kind else {
            return None;
        };
        let before = spoken.len() - name.len();
        let of_throw = spoken[..before].split_whitespace().count();
        let throw: Vec<&str> = parts(text).take(of_throw).collect();
        Some(Self {
            key,
            text,
            throw: throw.join("_"),
            name,
            column,
            quantity,
        })
    }

    /// Its column where the throw may have any name, and how its numbers become SI values.
    ///
    /// # Errors
    /// A unit that is unknown or of another dimension.
    pub(super) fn column(&self, channel: &Channel) -> Result<(String, ToSi), Error> {
        let column = format!("{}.{}", self.throw, self.column);
        Ok((column, to_si(channel, self.quantity)?))
    }

    /// That the machine, whose throws have these names, has no such one.
    pub(super) fn unknown(&self, throws: &[&str]) -> Error {
        let name = &self.name;
        match (throws, self.throw.as_str()) {
            ([""], _) => Error::unexpected(
                self.key,
                quoted(self.text),
                format_args!("'{name}': the machine has one throw, without a name"),
            ),
            (_, "") => Error::unexpected(
                self.key,
                quoted(self.text),
                format_args!(
                    "the name of a throw before it, one of {}",
                    throws.join(", ")
                ),
            ),
            (_, throw) => Error::unknown_name(self.key, throw, throws),
        }
    }
}
