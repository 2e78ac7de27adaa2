//! What a page shows that asks for its content again: texts by name, and rows of a table. The page is filled with it
//! when it is made, and by `templates/script/refresh.js` from the same as JSON.

use crate::Error;
use serde::Serialize;
use std::collections::BTreeMap;

/// What the page shows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Shown {
    /// Texts by the `data-key` of their elements.
    pub(crate) texts: BTreeMap<&'static str, String>,
    /// The rows of its table.
    pub(crate) rows: Vec<Row>,
}

/// A row of the table.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Row {
    /// What tells it from the others.
    pub(crate) id: String,
    /// Where its link leads; empty for none.
    pub(crate) href: String,
    /// Texts by the `data-key` of their cells.
    pub(crate) texts: BTreeMap<&'static str, String>,
}

impl Row {
    /// The text of a cell; empty where it has none.
    pub(crate) fn text(&self, key: &str) -> &str {
        self.texts.get(key).map_or("", String::as_str)
    }
}

/// The content of the page, and what it shows.
#[derive(Serialize)]
struct Document<'a, P> {
    #[serde(flatten)]
    content: &'a P,
    shown: Shown,
}

/// Both as JSON.
///
/// # Errors
/// None in practice: every content has a form in JSON.
pub(crate) fn json(content: &impl Serialize, shown: Shown) -> Result<String, Error> {
    let document = Document { content, shown };
    serde_json::to_string(&document).map_err(|error| Error::Template(askama::Error::custom(error)))
}
