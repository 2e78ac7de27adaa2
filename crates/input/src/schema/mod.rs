//! JSON Schema of the files that people write, for editors; and walking it, for messages and sweeps.

mod bundle;
mod closest;
mod generate;
mod machine;
mod node;
mod synonyms;

pub(crate) use bundle::BUNDLE_FORMAT;
pub use bundle::bundle_schema;
pub use closest::closest;
pub(crate) use generate::default_variant;
pub use generate::generate;
pub use machine::machine_schema;
pub(crate) use machine::{MACHINE, machine};
pub(crate) use node::Node;

/// What belongs at `key` of a file whose form is that of `schema`, in words.
pub(crate) fn expected(schema: &serde_json::Value, key: &str) -> Option<String> {
    Node::top(schema).walk(key)?.expected()
}
