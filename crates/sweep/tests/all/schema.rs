//! The JSON Schema of sweep.yaml that is committed for editors.

use serde_json::Value;
use std::path::PathBuf;

#[test]
fn the_committed_schema_is_current() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let committed = std::fs::read_to_string(root.join("data/schema/sweep.schema.json"));
    let committed: Value = serde_json::from_str(&committed.unwrap_or_default()).unwrap_or_default();
    assert!(
        committed == sweep::sweep_file::schema(),
        "data/schema/sweep.schema.json is stale; refresh it with\n    \
         cargo run --bin crosshead -- schema sweep > data/schema/sweep.schema.json"
    );
}
