//! JSON Schema of the files that people write, for editors; and walking it, for messages and sweeps.

mod bundle;
mod generate;
mod machine;
mod node;

pub use bundle::bundle_schema;
pub(crate) use generate::default_variant;
pub use generate::generate;
pub use machine::machine_schema;
pub(crate) use node::Node;
